//! Contacts that strayed over the edges: where they most likely were, given where they were measured.
//!
//! ```text
//! E(t | t_measured) = t_measured + C grad log f(t_measured)        f: density of the measured places, C: their errors' covariance
//! ```
//!
//! Inside a patch that is touched evenly as many contacts stray one way as the other, and a normal that is measured there belongs
//! there. At the edges more came from inside: normals and heights of places further in are then taken for those of the edge, and
//! the surface seems to bend less, R by about 3 (s/a)^2 of its value on a patch of half side a. Regression calibration: R. J.
//! Carroll, D. Ruppert, L. A. Stefanski, C. M. Crainiceanu, *Measurement Error in Nonlinear Models*, Chapman and Hall 2006, chapter
//! 4; the formula is M. C. K. Tweedie's (B. Efron, *J. Amer. Statist. Assoc.* 106 (2011) 1602).

use crate::recognition::contacts::Cells;
use crate::recognition::start::thinned;
use palpate_geometry::contact::Frame;

use super::position_covariance::PlaceErrors;
use palpate_numeric::vector::{Vector, along, cross, dot, minus, reject, scaled};

/// Variance, in units of the patch's size squared, below which nothing is moved: R would change by 3e-5.
const NEGLIGIBLE: f64 = 1e-5;

/// Contacts from which the density is taken.
const SAMPLE: usize = 1000;

/// Bounds of the factor that makes up for the density's own width.
const FACTOR: [f64; 2] = [0.5, 2.0];

/// Moves cells and contacts along the surface to where they most likely were, and says by which share of R that may be wrong.
///
/// Slopes over places that err with the variance s^2 are too small by s^2 over the variance of the measured places.
pub(crate) fn set_back(
    cells: &mut Cells,
    contacts: &mut [Vector],
    feet: &[Vector],
    (errors, frame): (&PlaceErrors, &Frame),
) -> f64 {
    if errors.across.max(errors.along_z) < NEGLIGIBLE {
        return 0.0;
    }
    let up = frame.rotate([0.0, 0.0, 1.0]);
    let (gradients, spread) = gradients(cells, feet);
    let steps: Vec<Vector> = gradients
        .iter()
        .map(|gradient| {
            // C = s_xy^2 + (s_z^2 - s_xy^2) z z'
            let upright = dot(*gradient, up);
            along(scaled(errors.across, *gradient), (errors.along_z - errors.across) * upright, up)
        })
        .collect();
    cells.points.iter_mut().zip(&steps).for_each(|(p, step)| *p = along(*p, 1.0, *step));
    for (p, &cell) in contacts.iter_mut().zip(&cells.of) {
        *p = along(*p, 1.0, steps[cell]);
    }
    (errors.doubt / spread).min(1.0)
}

/// Gradient of the log density at every cell, along the surface, and the variance of the places along either axis.
///
/// A density of gaussians about the contacts is wider than that of the measured places. The gradients are multiplied by the factor that
/// gives them the property of the true ones, `E (t - E t).grad log f = -2` along a surface.
fn gradients(cells: &Cells, feet: &[Vector]) -> (Vec<Vector>, f64) {
    let sample: Vec<Vector> = thinned(feet, SAMPLE).into_iter().map(|i| feet[i]).collect();
    let n = sample.len() as f64;
    let mean = [0, 1, 2].map(|k| sample.iter().map(|p| p[k]).sum::<f64>() / n);
    let variance = |k: usize| (sample.iter().map(|p| (p[k] - mean[k]).powi(2)).sum::<f64>() / n).max(f64::MIN_POSITIVE);
    let [one, other] = [variance(0), variance(1)];
    // the area of a rectangle with these variances, for each contact
    let width = 12.0 * (one * other).sqrt() / n;
    let counts: Vec<f64> = cells.variance.iter().map(|v| 1.0 / v).collect();
    let mut moment = 0.0;
    let mut found: Vec<Vector> = Vec::with_capacity(cells.feet.len());
    for (i, foot) in cells.feet.iter().enumerate() {
        let (mut sum, mut pull) = (0.0, [0.0; 3]);
        for p in &sample {
            let offset = minus(*p, *foot);
            let weight = (-0.5 * dot(offset, offset) / width).exp();
            sum += weight;
            pull = along(pull, weight / width, offset);
        }
        let normal = cross(cells.tangents[0][i], cells.tangents[1][i]);
        let gradient = reject(scaled(1.0 / sum.max(f64::MIN_POSITIVE), pull), normal);
        moment += counts[i] * dot(gradient, minus(*foot, mean));
        found.push(gradient);
    }
    let moment = moment / counts.iter().sum::<f64>();
    let factor = if moment < 0.0 { (-2.0 / moment).clamp(FACTOR[0], FACTOR[1]) } else { 0.0 };
    found.iter_mut().for_each(|g| *g = scaled(factor, *g));
    (found, 2.0 / (one.recip() + other.recip()))
}
