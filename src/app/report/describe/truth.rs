//! What is true where an answer was found, in the rows of the answer: class, radius, axis, S and R.
//!
//! ```text
//! S, R, class, radius     of the true surface over the same points, by the rules of the answer
//! axis                    from the true normals about the middle of the patch:  dn/ds = -W,  W v = k v
//! ```

use crate::report::truth_part::TruthPart;
use palpate_geometry::curvature::{Derivatives, Principal, ShapeClass};
use palpate_geometry::shape::{ShapeAt, ShapeReport, compare_pairs, radius_of};
use palpate_numeric::vector::{Vector, along, cross, dot, minus, norm, reject, scaled, unit};
use palpate_world::scene::Truth;
use palpate_world::scene::surface::Local;

/// Step along the surface over the radius of its stronger curvature: the quotient of normals errs by its square, and by
/// rounding over it.
const STEP_OF_RADIUS: f64 = 1e-4;

/// Curvatures that differ by less than this part of the larger one have no directions that differences could tell.
const AS_ROUND: f64 = 1e-6;

/// A place of the answer, and what is true there.
pub(super) struct TruePlace {
    /// S and R as they were found.
    pub(super) found: ShapeAt,
    /// The point, input coordinates.
    pub(super) point: Vector,
    /// The true surface there.
    pub(super) local: Local,
}

/// The part on the truth; a plane found has no S to be wrong about.
pub(super) fn truth_part<M>(shape: &ShapeReport<M>, truth: &Truth, places: &[TruePlace]) -> TruthPart {
    let pairs = places.iter().map(|place| [place.found, (place.local.shape_index(), place.local.curvedness())]);
    let compared = compare_pairs(pairs);
    let class = class_of(places);
    let mut part = TruthPart {
        shape_index: compared.shape_index,
        curvedness: compared.curvedness,
        error_shape_index: compared.error_shape_index.filter(|_| shape.shape_index.mean.is_some()),
        error_curvedness: compared.error_curvedness,
        class: class.map(|class| class.name().into()),
        radius: class.zip(compared.curvedness).and_then(|(class, r)| radius_of(class, r)),
        radii: class.and_then(|class| radii(class, places)),
        ..TruthPart::default()
    };
    if let Some(true_axes) = middle(places).and_then(|place| principal_at(truth, place)) {
        directions(shape, &true_axes, &mut part);
    }
    part
}

/// The class that at least half of the places have.
fn class_of(places: &[TruePlace]) -> Option<ShapeClass> {
    let at = |place: &TruePlace| place.local.shape_index().map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    // every class of a place takes an arcus tangent, and a fine grid has millions of places
    let classes: Vec<ShapeClass> = places.iter().map(at).collect();
    let all = ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]);
    let shares = all.map(|class| (class, classes.iter().filter(|at| **at == class).count()));
    let most = shares.max_by_key(|(_, share)| *share);
    most.filter(|(_, share)| *share > 0 && 2 * share >= places.len()).map(|(class, _)| class)
}

/// Radii of the two mean curvatures of a dome or trough, the smaller first.
fn radii(class: ShapeClass, places: &[TruePlace]) -> Option<[f64; 2]> {
    if !matches!(class, ShapeClass::Dome | ShapeClass::Trough) {
        return None;
    }
    let mean = |k: fn(&Local) -> f64| places.iter().map(|place| k(&place.local)).sum::<f64>() / places.len() as f64;
    let [one, other] = [mean(|l| l.k1), mean(|l| l.k2)].map(|k| 1.0 / k.abs());
    Some([one.min(other), one.max(other)])
}

/// The place nearest to the middle of all of them.
fn middle(places: &[TruePlace]) -> Option<&TruePlace> {
    let sum = places.iter().fold([0.0; 3], |sum, place| along(sum, 1.0, place.point));
    let centre = scaled(1.0 / places.len() as f64, sum);
    let off = |place: &TruePlace| norm(minus(place.point, centre));
    places.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Curvatures of the true surface with their directions, by differences of its normals; `None` where it is as round both ways.
fn principal_at(truth: &Truth, place: &TruePlace) -> Option<Principal> {
    let (n, largest) = (place.local.normal, place.local.k1.abs().max(place.local.k2.abs()));
    if place.local.difference <= AS_ROUND * largest {
        return None;
    }
    let least = (0..3).min_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs()))?;
    let e1 = unit(reject(std::array::from_fn(|k| f64::from(u8::from(k == least))), n));
    let e2 = cross(n, e1);
    let step = STEP_OF_RADIUS / largest;
    let normal = |e: Vector, s: f64| truth.near(along(place.point, s, e), n).map(|local| local.normal);
    let turned = |e: Vector| Some(scaled(-0.5 / step, minus(normal(e, step)?, normal(e, -step)?)));
    let [w1, w2] = [turned(e1)?, turned(e2)?];
    let second = |bend: f64| scaled(bend, n);
    Derivatives {
        u: e1,
        v: e2,
        uu: second(dot(w1, e1)),
        uv: second(0.5 * (dot(w1, e2) + dot(w2, e1))),
        vv: second(dot(w2, e2)),
    }
    .principal()
}

/// The true directions in the form that the answer has its own in.
fn directions<M>(shape: &ShapeReport<M>, found: &Principal, part: &mut TruthPart) {
    let axis = if found.k1.abs() <= found.k2.abs() { found.direction1 } else { found.direction2 };
    part.direction_deg = shape.direction_deg.map(|_| from_x_to_y(found.direction1));
    part.direction = shape.direction.map(|own| alike(own, found.direction1));
    part.axis_deg = shape.axis_deg.map(|_| from_x_to_y(axis));
    part.axis = shape.axis.map(|own| alike(own, axis));
}

/// The one of two opposite directions that is nearer to `own`.
fn alike(own: Vector, direction: Vector) -> Vector {
    scaled(1.0_f64.copysign(dot(own, direction)), direction)
}

/// A direction projected to x and y, degrees in [0, 180).
fn from_x_to_y([x, y, _]: Vector) -> f64 {
    let angle = y.atan2(x).to_degrees().rem_euclid(180.0);
    // rounding may leave 180 itself
    if angle < 180.0 { angle } else { 0.0 }
}
