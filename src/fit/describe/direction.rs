//! Direction of the larger principal curvature at the patch centre.

use crate::curvature::principal_curvatures;
use crate::fit::describe::uncertainty::standard_uncertainty;
use crate::fit::solved::Solved;
use crate::shape::gap_gradient;

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Angle of k1's direction at the centre, projected to the input's x and y, degrees in [0, 180); `None` where k1 - k2 is
/// within twice its uncertainty, or within rounding, of zero.
pub(super) fn direction(solved: &Solved) -> Option<f64> {
    let [dx, dy] = [0, 1].map(|k| {
        let [lo, hi] = solved.patch.knots[k].domain();
        0.5 * (lo + hi)
    });
    let point = solved.surface.at(dx, dy);
    let principal = principal_curvatures(&point.derivatives())?;
    let rounding = 1e3 * UNIT * (1.0 + principal.k1.abs().max(principal.k2.abs()));
    let noise = standard_uncertainty(solved, &gap_gradient(&solved.surface, dx, dy));
    if principal.difference <= (2.0 * noise).max(rounding) {
        return None;
    }
    let d = solved.patch.frame.rotate_back(principal.direction1);
    if d[0] == 0.0 && d[1] == 0.0 {
        return None;
    }
    let angle = d[1].atan2(d[0]).to_degrees().rem_euclid(180.0);
    // an angle just below 0 is rounded to 180
    Some(if angle >= 180.0 { 0.0 } else { angle })
}
