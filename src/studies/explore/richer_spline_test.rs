//! Does a richer spline explain the contacts better than the surface that was recognised?
//!
//! ```text
//! F = ((RSS - RSS_rich) / (k_rich - k)) / (RSS_rich / (rows - k_rich)),   RSS = sum (dz / s_z)^2 + |dn|^2 / s_n^2
//! ```
//!
//! The noise sds are those that the recognition found; their common factor cancels. A recognition reads a small departure as a
//! sensor's error, because contacts cannot tell it from shape. Whoever is about to stop touching does better to doubt it.

use palpate_fitting::fit::Fit;
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::f_upper_tail;
use palpate_inference::recognition::Recognition;

use super::model::fit_of;

/// Degree of the richer spline: an even bump differs from a ball in the fourth degree first.
const DEGREE: usize = 4;

/// Rows that must be left over after the unknowns: with fewer the test overlooks what it is there for. (15 contacts with
/// normals have 45 rows, and the spline 25 unknowns.)
const LEFT_OVER: usize = 20;

/// Probability of so large an F, or a larger one, if the recognised surface were all there is; `None` where the contacts
/// are too few to ask.
pub(super) fn richer_p(contacts: &Contacts, found: &Recognition) -> Option<f64> {
    let rich = fit_of(contacts, Some(found), DEGREE)?;
    let left = left(&rich)? as f64;
    let unknowns = rich.equations().unknowns();
    let [heights, slopes] = rich.equations().residual_squares(&rich.solution().coefficients);
    let of_rich = heights + slopes;
    let more = unknowns.checked_sub(found.hypothesis.unknowns()).filter(|more| *more > 0)? as f64;
    let ratio = ((squares(contacts, found, &rich)? - of_rich).max(0.0) / more) / (of_rich / left);
    Some(f_upper_tail(ratio, more, left))
}

/// Rows left over after the unknowns, if enough.
fn left(fit: &Fit) -> Option<usize> {
    let equations = fit.equations();
    equations.count().checked_sub(equations.unknowns()).filter(|left| *left >= LEFT_OVER)
}

/// The weighted sum of squares that the recognised surface leaves, with the sds of the rich fit.
fn squares(contacts: &Contacts, found: &Recognition, rich: &Fit) -> Option<f64> {
    let noise = rich.noise();
    let (z, normal) = (noise.sigma_z?, noise.sigma_normal_deg?.to_radians());
    let mut sum = 0.0;
    for r in 0..contacts.len() {
        let place = [contacts.x[r], contacts.y[r], contacts.z[r]];
        let [u, v] = found.surface.chart_of(place);
        let (_, up) = found.surface.at(u, v);
        // the fit's residuals are heights, these are distances along the normal
        sum += (found.surface.distance(place) / up[2].abs().max(0.1) / z).powi(2);
        let felt = contacts.unit_normal(r)?;
        sum += (0..3).map(|k| (felt[k] - up[k]).powi(2)).sum::<f64>() / (normal * normal);
    }
    sum.is_finite().then_some(sum)
}
