//! The primitives of a body, each as far as its contacts reach: what CAD takes over.
//!
//! ```text
//! plane                    the convex hull of its contacts
//! sphere                   a cap about the mean direction of its contacts, or all of it
//! cylinder, cone, torus    from the first angle and height of its contacts to the last; all round where no gap is wider than 60 degrees
//! ```
//!
//! Faces are not cut at each other: where two parts meet, either ends at its own last contact, a spacing or less from the edge. A patch, which
//! is of no primitive, has no face.

use std::f64::consts::{PI, TAU};

use palpate_geometry::contact::Contacts;
use palpate_geometry::convex_hull::convex_hull;
use palpate_inference::parts::{Part, PartKind, Parts};
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, minus, norm, unit};

/// Widest gap between the angles of contacts that are all round: a thing seen from one side has one of 180 degrees or more.
const SEAM_GAP: f64 = PI / 3.0;

/// Length of the mean direction below which a ball was touched on all sides: that of an even cap is `(1 + cos a) / 2`, 0.2 at 127 degrees from
/// its middle.
const ALL_SIDES: f64 = 0.2;

/// Height of a cap below the centre, as a share of the radius, from which on it is the whole ball: 162 degrees from its middle, where what is
/// left is the stand or the grip that nobody touched.
const NEARLY_WHOLE: f64 = 0.95;

/// Least radius at an end of a cone, as a share of the largest: its tip has no direction.
const BLUNT: f64 = 1e-3;

/// Origin with two of three axes at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedAxes {
    pub(super) origin: Vector,
    pub(super) x: Vector,
    pub(super) z: Vector,
}

impl PlacedAxes {
    /// With any first axis across z.
    fn about(origin: Vector, z: Vector) -> PlacedAxes {
        let [x, _, z] = axes_along(unit(z));
        PlacedAxes { origin, x, z }
    }

    /// A place in these axes.
    fn local(&self, place: Vector) -> Vector {
        let away = minus(place, self.origin);
        [dot(away, self.x), dot(away, cross(self.z, self.x)), dot(away, self.z)]
    }

    /// The unit vector at an angle about z.
    pub(super) fn radial(&self, angle: f64) -> Vector {
        along(self.x.map(|x| x * angle.cos()), angle.sin(), cross(self.z, self.x))
    }

    /// The place at an angle, a distance from the axis and a height.
    pub(super) fn place(&self, angle: f64, distance: f64, height: f64) -> Vector {
        along(along(self.origin, distance, self.radial(angle)), height, self.z)
    }
}

/// A surface that is turned about its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TurnedSurface {
    Cylinder {
        radius: f64,
    },
    /// The radius at the origin, and the half angle.
    Cone {
        radius: f64,
        half_angle: f64,
    },
    Torus {
        ring: f64,
        tube: f64,
    },
}

impl TurnedSurface {
    /// Distance from the axis and height of a profile's number: a height, or of a torus an angle round the tube.
    pub(super) fn profile(&self, v: f64) -> [f64; 2] {
        match self {
            TurnedSurface::Cylinder { radius } => [*radius, v],
            TurnedSurface::Cone { radius, half_angle } => [radius + v * half_angle.tan(), v],
            TurnedSurface::Torus { ring, tube } => [ring + tube * v.cos(), tube * v.sin()],
        }
    }
}

/// What is left of a primitive.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TrimmedFace {
    /// Corners, anticlockwise about z.
    Polygon(Vec<Vector>),
    /// From a height along z to the pole; `None` is the whole ball.
    Cap { radius: f64, from: Option<f64> },
    /// Angles about z, and the profile's numbers; `None` goes all round.
    Band { surface: TurnedSurface, around: Option<[f64; 2]>, profile: Option<[f64; 2]> },
}

/// A primitive as far as its contacts reach.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TrimmedPrimitive {
    pub(super) axes: PlacedAxes,
    pub(super) face: TrimmedFace,
    /// Seen from inside.
    pub(super) hollow: bool,
    pub(super) name: String,
}

/// Those of all parts that are primitives.
pub(crate) fn trimmed_primitives(found: &Parts, contacts: &Contacts) -> Vec<TrimmedPrimitive> {
    let own = |part: &Part| -> Vec<Vector> {
        let belongs = |r: &usize| found.labels[*r] == u32::try_from(part.id).ok();
        (0..contacts.len()).filter(belongs).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect()
    };
    let one = |part: &Part| {
        let (axes, face) = trimmed(part, &own(part))?;
        Some(TrimmedPrimitive { axes, face, hollow: part.hollow, name: format!("{} {}", part.id, part.kind.name()) })
    };
    found.parts.iter().filter_map(one).collect()
}

fn trimmed(part: &Part, places: &[Vector]) -> Option<(PlacedAxes, TrimmedFace)> {
    let geometry = &part.geometry;
    let radius = geometry.radius.unwrap_or_default();
    if part.kind == PartKind::Sphere {
        return Some(cap(geometry.point, radius, places));
    }
    let axes = PlacedAxes::about(geometry.point, geometry.axis?);
    let local: Vec<Vector> = places.iter().map(|place| axes.local(*place)).collect();
    let heights = || local.iter().map(|[.., z]| *z);
    let surface = match part.kind {
        PartKind::Plane => return Some((axes, polygon(&axes, &local)?)),
        PartKind::Cylinder => TurnedSurface::Cylinder { radius },
        PartKind::Cone => TurnedSurface::Cone { radius, half_angle: geometry.half_angle_deg?.to_radians() },
        PartKind::Torus => TurnedSurface::Torus { ring: radius, tube: geometry.minor_radius? },
        _ => return None,
    };
    let around = angles_of(local.iter().map(|[x, y, _]| y.atan2(*x)).collect());
    let profile = match surface {
        TurnedSurface::Torus { ring, .. } => {
            angles_of(local.iter().map(|[x, y, z]| z.atan2(x.hypot(*y) - ring)).collect())
        }
        TurnedSurface::Cylinder { .. } | TurnedSurface::Cone { .. } => Some(ends(heights())?),
    };
    let profile = if let (TurnedSurface::Cone { .. }, Some(ends)) = (surface, profile) {
        Some(blunted(surface, ends)?)
    } else {
        profile
    };
    Some((axes, TrimmedFace::Band { surface, around, profile }))
}

/// The least and the largest; `None` where they are not apart.
fn ends(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [lo, hi] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
    (hi > lo).then_some([lo, hi])
}

/// Ends of a cone that both lie on its own side of the tip.
fn blunted(cone: TurnedSurface, [lo, hi]: [f64; 2]) -> Option<[f64; 2]> {
    let [widest, _] = cone.profile(hi);
    let TurnedSurface::Cone { radius, half_angle } = cone else { return None };
    let least = (BLUNT * widest - radius) / half_angle.tan();
    (widest > 0.0 && hi > lo.max(least)).then_some([lo.max(least), hi])
}

/// From the first angle to the last, the widest gap between; `None` where they are all round.
fn angles_of(mut angles: Vec<f64>) -> Option<[f64; 2]> {
    angles.sort_by(f64::total_cmp);
    let count = angles.len();
    let gap = |k: usize| if k + 1 < count { angles[k + 1] - angles[k] } else { angles[0] + TAU - angles[count - 1] };
    let widest = (0..count).max_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
    let first = angles[(widest + 1) % count];
    (gap(widest) > SEAM_GAP).then(|| [first, first + TAU - gap(widest)])
}

fn polygon(axes: &PlacedAxes, local: &[Vector]) -> Option<TrimmedFace> {
    let hull = convex_hull(&local.iter().map(|[x, y, _]| [*x, *y]).collect::<Vec<[f64; 2]>>());
    let y = cross(axes.z, axes.x);
    let corner = |[a, b]: &[f64; 2]| along(along(axes.origin, *a, axes.x), *b, y);
    (hull.len() >= 3).then(|| TrimmedFace::Polygon(hull.iter().map(corner).collect()))
}

fn cap(centre: Vector, radius: f64, places: &[Vector]) -> (PlacedAxes, TrimmedFace) {
    let directions: Vec<Vector> = places.iter().map(|place| unit(minus(*place, centre))).collect();
    let mean = directions.iter().fold([0.0; 3], |sum, d| along(sum, 1.0 / places.len() as f64, *d));
    if norm(mean) < ALL_SIDES {
        return (PlacedAxes::about(centre, [0.0, 0.0, 1.0]), TrimmedFace::Cap { radius, from: None });
    }
    let axes = PlacedAxes::about(centre, mean);
    let from = directions.iter().map(|d| radius * dot(*d, axes.z)).fold(radius, f64::min);
    (axes, TrimmedFace::Cap { radius, from: (from > -NEARLY_WHOLE * radius).then_some(from) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_leave_out_the_widest_gap() {
        let quarter = angles_of(vec![3.0, -3.0, -2.5, 2.4]).unwrap();
        assert!((quarter[0] - 2.4).abs() < 1e-12 && (quarter[1] - (TAU - 2.5)).abs() < 1e-12, "{quarter:?}");
        assert_eq!(angles_of((0..12).map(|k| 0.5 * f64::from(k)).collect()), None);
    }

    #[test]
    fn a_cone_ends_before_its_tip() {
        let cone = TurnedSurface::Cone { radius: 1.0, half_angle: 0.5 };
        let [lo, hi] = blunted(cone, [-5.0, 3.0]).unwrap();
        let [at_tip, _] = cone.profile(lo);
        assert!(at_tip > 0.0 && at_tip < 0.01 && hi == 3.0, "{at_tip}");
        assert_eq!(blunted(cone, [-5.0, -4.0]), None);
    }

    #[test]
    fn a_ball_touched_from_above_is_a_cap_and_one_touched_all_round_is_whole() {
        let above: Vec<Vector> =
            (0..20).map(|k| unit([(0.3 * f64::from(k)).sin(), (0.3 * f64::from(k)).cos(), 1.0])).collect();
        let (axes, face) = cap([0.0; 3], 1.0, &above);
        assert!(
            axes.z[2] > 0.95 && matches!(face, TrimmedFace::Cap { from: Some(from), .. } if from > 0.4),
            "{face:?}"
        );
        let round: Vec<Vector> = above.iter().flat_map(|p| [*p, p.map(|v| -v)]).collect();
        assert_eq!(cap([0.0; 3], 1.0, &round).1, TrimmedFace::Cap { radius: 1.0, from: None });
    }
}
