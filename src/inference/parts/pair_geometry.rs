//! What lies between two parts wherever the body stands: the angle between directions, the distance of what lies side by side.

use super::result::Part;
use crate::primitives::placed::PartKind;
use palpate_numeric::vector::{cross, dot, minus, norm};

/// What of a part has a place: a face across its normal, a line along its axis, a centre.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Locus {
    Face,
    Line,
    Centre,
}

fn locus(part: &Part) -> Locus {
    match part.kind {
        PartKind::Plane => Locus::Face,
        PartKind::Sphere | PartKind::Torus => Locus::Centre,
        _ => Locus::Line,
    }
}

/// |cos| of the angle between two directions, and the angle's uncertainty, radians.
pub(super) fn cosine([a, b]: [&Part; 2]) -> Option<(f64, f64)> {
    let (n, m) = a.geometry.axis.zip(b.geometry.axis)?;
    let u = a.u.axis_deg.unwrap_or(0.0).hypot(b.u.axis_deg.unwrap_or(0.0));
    Some((dot(n, m).abs().min(1.0), u.to_radians()))
}

/// Distance between two faces, lines or centres, with its uncertainty; `None` of those that meet somewhere. Directions whose angle has a
/// sine below `beside` are side by side.
pub(super) fn distance([a, b]: [&Part; 2], beside: f64) -> Option<(f64, f64)> {
    let [a, b] = if locus(a) <= locus(b) { [a, b] } else { [b, a] };
    let apart = minus(b.geometry.point, a.geometry.point);
    let of_points = a.u.point.unwrap_or(0.0).hypot(b.u.point.unwrap_or(0.0));
    let lever = |part: &Part, over: f64| over * part.u.axis_deg.unwrap_or(0.0).to_radians();
    let both = |over: f64| of_points.hypot(lever(a, over)).hypot(lever(b, over));
    if locus(a) == Locus::Centre {
        return Some((norm(apart), of_points));
    }
    let n = a.geometry.axis?;
    let (along, across) = (dot(apart, n).abs(), norm(cross(apart, n)));
    match (locus(a), locus(b)) {
        (Locus::Face, Locus::Centre) => Some((along, of_points.hypot(lever(a, across)))),
        (_, Locus::Centre) => Some((across, of_points.hypot(lever(a, along)))),
        (Locus::Face, of_other) => {
            let m = b.geometry.axis?;
            let turned = if of_other == Locus::Face { norm(cross(n, m)) } else { dot(n, m).abs() };
            (turned < beside).then(|| (along, both(across)))
        }
        _ => {
            let normal = cross(n, b.geometry.axis?);
            let sine = norm(normal);
            if sine < beside {
                return Some((across, both(along)));
            }
            Some((dot(apart, normal).abs() / sine, both(norm(apart))))
        }
    }
}
