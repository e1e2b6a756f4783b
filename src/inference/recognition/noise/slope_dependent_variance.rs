//! Known or shown errors in x and y: contacts on slopes err more along the normal than contacts on level ground.
//!
//! ```text
//! var_i = s_z^2 n_z^2 + s_xy^2 (1 - n_z^2)         n_z of the surface's normal in the input's axes
//! mean var_i = s^2 of the robust surface's distances, which leaves s_z;     D_i -> D_i max(var_i / mean var, `Tuning::least_variance`)
//! ```
//!
//! Only the ratios enter: how large the errors are is told by the contacts, as always.

use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::start::Patch;
use palpate_numeric::statistics::{MAD_TO_SD, median};

use super::position_covariance::PlaceErrors;
use palpate_numeric::vector::cross;

/// Parameters of the robust surface.
const UNKNOWNS: f64 = 6.0;

/// The cells with variances and weights that count these errors, input units.
pub(crate) fn weighed(mut cells: Cells, patch: &Patch, errors: &PlaceErrors, tuning: &Tuning) -> Cells {
    if !errors.weigh {
        return cells;
    }
    let upright = |i: usize| {
        let normal = cross(cells.tangents[0][i], cells.tangents[1][i]);
        patch.frame.rotate_back(normal)[2].powi(2).min(1.0)
    };
    let squares: Vec<f64> = (0..cells.points.len()).map(upright).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let count = patch.distances.len() as f64;
    let spent = (count / (count - UNKNOWNS).max(1.0)).sqrt();
    let scatter =
        MAD_TO_SD * spent * median(patch.distances.iter().map(|d| d.abs()).collect::<Vec<f64>>()).unwrap_or(0.0);
    let across = errors.across;
    let upright = mean(&squares);
    let along_z = (scatter * scatter - across * (1.0 - upright)).max(0.0) / upright.max(tuning.least_variance);
    let variances: Vec<f64> = squares.iter().map(|n| along_z * n + across * (1.0 - n)).collect();
    let all = mean(&variances);
    if all <= 0.0 {
        return cells;
    }
    for (i, variance) in variances.iter().enumerate() {
        let ratio = (variance / all).max(tuning.least_variance);
        cells.variance[i] *= ratio;
        cells.weights[i] /= ratio;
    }
    cells
}
