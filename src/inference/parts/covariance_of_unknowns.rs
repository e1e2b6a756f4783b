//! The covariance of a primitive's unknowns, with what neighbours share.
//!
//! ```text
//! V = max of  C under independent errors,  C by the kernel of `shared_errors.rs`,  C by sums over cells of the cloud (`evidence.rs`)
//! ```
//!
//! The kernel follows errors whose covariance falls with the distance; cells find those that do not, as the waves of a lack of fit.

use super::cloud::Cloud;
use super::evidence::Cells;
use super::neighbour_products::Weighted;
use super::shared_errors::with_shared_errors;
use crate::primitives::normal_equations::rows;
use crate::primitives::placed::MOST_UNKNOWNS;
use palpate_numeric::linalg::small::Square;

/// Covariance of the unknowns with errors that neighbours share, by their kernel and by cells of the cloud: the larger variance counts, and
/// none is less than that of independent errors.
pub(super) fn covariance_of_unknowns(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    independent: &Square<MOST_UNKNOWNS>,
    cells: &Cells,
) -> Square<MOST_UNKNOWNS> {
    let by_kernel = with_shared_errors(cloud, inner, fit, independent);
    let by_cells = widened_by_cells(cloud, inner, fit, independent, cells);
    let wider = |k: usize| {
        let (least, found) = (independent[k][k] * by_cells[k], by_kernel[k][k]);
        // nothing is found of an unknown that is not free
        if found > 0.0 && least > found { (least / found).sqrt() } else { 1.0 }
    };
    let times: [f64; MOST_UNKNOWNS] = std::array::from_fn(wider);
    std::array::from_fn(|i| std::array::from_fn(|j| by_kernel[i][j] * times[i] * times[j]))
}

/// By how much errors that a cell's contacts share widen the variance of every unknown: through what each contact moves it by.
fn widened_by_cells(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    covariance: &Square<MOST_UNKNOWNS>,
    cells: &Cells,
) -> [f64; MOST_UNKNOWNS] {
    let free = fit.primitive.kind.free();
    let weights = [fit.noise.distance.powi(-2), fit.noise.normal.powi(-2)];
    let mut moves: [Vec<(u32, f64)>; MOST_UNKNOWNS] = Default::default();
    for &i in inner {
        let mut pull = [0.0; MOST_UNKNOWNS];
        let rows = rows(fit.primitive, cloud.points[i as usize], cloud.normals[i as usize]);
        for (number, (residual, row)) in rows.into_iter().enumerate() {
            let heavy = weights[usize::from(number > 0)] * residual;
            free.iter().for_each(|&k| pull[k] += heavy * row[k]);
        }
        for &k in free {
            moves[k].push((i, free.iter().map(|&j| covariance[k][j] * pull[j]).sum()));
        }
    }
    std::array::from_fn(|k| cells.shared(&moves[k], free.len()))
}
