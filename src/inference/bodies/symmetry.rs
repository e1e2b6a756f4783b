//! About which axis a body may be turned, along which one it may be drawn, and from which base its departures are then counted.
//!
//! ```text
//! axes     of the modes; least spread of normals; the linear complex of normals; principal ones through the middle of a circle
//! bases    the cylinder and the ball of the mean square distances, the plane across the axis; ellipsoids that were found, made round;
//!          a plane along the line
//! ```
//!
//! A base that contacts lie deep within has its focal points near them, where its distance bends sharply: no departure makes up for that, and
//! it is left out.

use super::candidates::{circle, closed_forms, principal, with_normals};
use super::coordinates::DepartureOver;
use super::mode::Mode;
use super::sample::BodySample;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::vector::{Vector, along, axes_along, dot, minus, norm, reject, unit};

/// What a free surface is counted from, and what its departure is a function of.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeBody {
    pub(super) base: Primitive,
    pub(super) over: DepartureOver,
}

/// Forms of bodies that are the same all round an axis, or all along one.
pub(super) fn symmetric_forms(sample: &BodySample, modes: &[Mode], tuning: &Tuning) -> Vec<FreeBody> {
    let oriented = with_normals(sample, tuning);
    let from_normals = |kind: PartKind| oriented.iter().flat_map(move |oriented| closed_forms(kind, oriented));
    let of_modes = modes.iter().flat_map(|mode| axes_of(&mode.primitive));
    let mut turned: Vec<(Vector, Vector)> = of_modes.collect();
    turned.extend(from_normals(PartKind::Torus).map(|p| (p.origin, p.axes[2])));
    let mut extruded: Vec<(Vector, Vector)> = turned.clone();
    extruded.extend(from_normals(PartKind::Cylinder).map(|p| (p.origin, p.axes[2])));
    turned.extend(principal(sample).1.into_iter().filter_map(|axis| Some((circle(sample, axis)?.0, axis))));
    let of_kind = |kind: PartKind| modes.iter().map(|mode| mode.primitive).filter(move |p| p.kind == kind);
    let bases = turned.into_iter().flat_map(|axis| [cylinder(sample, axis), ball(sample, axis), across(sample, axis)]);
    let bases = bases.chain(of_kind(PartKind::Ellipsoid).flat_map(|found| rounded(&found)));
    // a tube wider than its ring has a cusp on the axis
    let rings = of_kind(PartKind::Torus).filter(|torus| torus.sizes[0] > torus.sizes[1]);
    let bases = bases.chain(rings).chain(of_kind(PartKind::Cone));
    let of_turned = bases.map(|base| FreeBody { base, over: DepartureOver::Turned });
    let (middle, [narrowest, ..], _) = principal(sample);
    let bases = extruded.into_iter().flat_map(|(_, direction)| {
        let axis = (middle, direction);
        [Some(cylinder(sample, axis)), sheet(axis, narrowest, tuning.wide_as_plane)].into_iter().flatten()
    });
    let of_extruded = bases.map(|base| FreeBody { base, over: DepartureOver::Extruded });
    let is_sound = |form: &FreeBody| form.base.is_sound(tuning.extent) && !is_focal(&form.base, sample, tuning);
    of_turned.chain(of_extruded).filter(is_sound).collect()
}

/// Whether contacts lie so near to focal points of a base that the shortest departure would have to bend as sharply as its distance does, or
/// so much nearer than most that the surface goes through them.
fn is_focal(base: &Primitive, sample: &BodySample, tuning: &Tuning) -> bool {
    let shortest = tuning.free_lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let from_focal = |p: &Vector| {
        let [x, y, z] = base.own(*p);
        match base.kind {
            PartKind::Cylinder | PartKind::Cone | PartKind::Torus => x.hypot(y),
            PartKind::Sphere => x.hypot(y).hypot(z),
            PartKind::Plane | PartKind::Ellipsoid | PartKind::Patch => f64::INFINITY,
        }
    };
    let square = sample.points.iter().map(|p| from_focal(p).powi(2)).sum::<f64>() / sample.len() as f64;
    let near = shortest.max(tuning.focal * square.sqrt());
    // an infinite distance is never near
    sample.points.iter().map(from_focal).any(|distance| distance.is_finite() && distance < near)
}

/// Axes of a primitive.
fn axes_of(primitive: &Primitive) -> Vec<(Vector, Vector)> {
    let axes = match primitive.kind {
        PartKind::Cylinder | PartKind::Cone | PartKind::Torus => &primitive.axes[2..],
        PartKind::Ellipsoid => &primitive.axes[..],
        PartKind::Plane | PartKind::Sphere | PartKind::Patch => &[],
    };
    axes.iter().map(|axis| (primitive.origin, *axis)).collect()
}

/// Mean square distances of the contacts from the axis, their mean height along it and its variance.
fn moments(sample: &BodySample, (origin, axis): (Vector, Vector)) -> [f64; 3] {
    let count = sample.len() as f64;
    let own = |p: &Vector| {
        let from = minus(*p, origin);
        let h = dot(from, axis);
        [dot(from, from) - h * h, h, h * h]
    };
    let sums = sample.points.iter().map(own).fold([0.0; 3], |sum, m| [0, 1, 2].map(|k| sum[k] + m[k] / count));
    [sums[0].max(0.0), sums[1], (sums[2] - sums[1] * sums[1]).max(0.0)]
}

fn cylinder(sample: &BodySample, (origin, axis): (Vector, Vector)) -> Primitive {
    let [square, height, _] = moments(sample, (origin, axis));
    let origin = along(origin, height, axis);
    Primitive { kind: PartKind::Cylinder, origin, axes: axes_along(axis), sizes: [square.sqrt(), 0.0, 0.0], side: 1.0 }
}

/// A cylinder so wide that it is as good as a plane through the contacts' middle, where they do not go round the axis.
fn sheet((middle, axis): (Vector, Vector), narrowest: Vector, wide: f64) -> Option<Primitive> {
    let outwards = reject(narrowest, axis);
    // within 30 degrees of the line it tells no side of a plane along it
    if norm(outwards) < 0.5 {
        return None;
    }
    let origin = along(middle, -wide, unit(outwards));
    Some(Primitive { kind: PartKind::Cylinder, origin, axes: axes_along(axis), sizes: [wide, 0.0, 0.0], side: 1.0 })
}

fn ball(sample: &BodySample, (origin, axis): (Vector, Vector)) -> Primitive {
    let [square, height, variance] = moments(sample, (origin, axis));
    let origin = along(origin, height, axis);
    let sizes = [(square + variance).sqrt(), 0.0, 0.0];
    Primitive { kind: PartKind::Sphere, origin, axes: axes_along(axis), sizes, side: 1.0 }
}

/// The plane across the axis at the contacts' mean height: a bump on what is flat is smooth on its axis, where the others bend sharply.
fn across(sample: &BodySample, (origin, axis): (Vector, Vector)) -> Primitive {
    let [_, height, _] = moments(sample, (origin, axis));
    let origin = along(origin, height, axis);
    Primitive { kind: PartKind::Plane, origin, axes: axes_along(axis), sizes: [0.0; 3], side: 1.0 }
}

/// An ellipsoid made round about each of its axes.
fn rounded(ellipsoid: &Primitive) -> [Primitive; 3] {
    [[1, 2, 0], [2, 0, 1], [0, 1, 2]].map(|order| {
        let [one, two, third] = order.map(|k| ellipsoid.sizes[k]);
        let across = (one * two).sqrt();
        Primitive { axes: order.map(|k| ellipsoid.axes[k]), sizes: [across, across, third], ..*ellipsoid }
    })
}
