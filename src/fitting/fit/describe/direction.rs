//! Directions of the principal curvatures at the patch centre.
//!
//! ```text
//! direction of k1        the larger curvature, counted with its sign
//! axis                   of the smaller |k|: along a ridge, a rut, or a body's longer way
//! ```

use crate::fit::describe::uncertainty::standard_uncertainty;
use crate::fit::solved::Solved;
use palpate_geometry::shape::gap_gradient;

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Angles at the centre, projected to the input's x and y, degrees in [0, 180).
pub(super) struct Directions {
    /// Of k1.
    pub(super) k1: Option<f64>,
    /// Of the curvature that is smaller by magnitude.
    pub(super) axis: Option<f64>,
}

impl Directions {
    pub(super) const NONE: Directions = Directions { k1: None, axis: None };
}

/// The directions; none where k1 - k2 is within twice its uncertainty, or within rounding, of zero.
pub(super) fn directions(solved: &Solved) -> Directions {
    found(solved).unwrap_or(Directions::NONE)
}

fn found(solved: &Solved) -> Option<Directions> {
    let [dx, dy] = [0, 1].map(|k| {
        let [lo, hi] = solved.patch.knots[k].domain();
        0.5 * (lo + hi)
    });
    let point = solved.surface.at(dx, dy);
    let principal = point.derivatives().principal()?;
    let rounding = 1e3 * UNIT * (1.0 + principal.k1.abs().max(principal.k2.abs()));
    let noise = standard_uncertainty(solved, &gap_gradient(&solved.surface, dx, dy));
    if principal.difference <= (2.0 * noise).max(rounding) {
        return None;
    }
    let projected = |direction| projected(solved.patch.frame.rotate_back(direction));
    let along = if principal.k1.abs() <= principal.k2.abs() { principal.direction1 } else { principal.direction2 };
    Some(Directions { k1: projected(principal.direction1), axis: projected(along) })
}

/// Angle from x towards y; `None` for what stands upright.
fn projected(d: [f64; 3]) -> Option<f64> {
    if d[0] == 0.0 && d[1] == 0.0 {
        return None;
    }
    let angle = d[1].atan2(d[0]).to_degrees().rem_euclid(180.0);
    // an angle just below 0 is rounded to 180
    Some(if angle >= 180.0 { 0.0 } else { angle })
}
