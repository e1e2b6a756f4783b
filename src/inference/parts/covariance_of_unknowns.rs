//! The covariance of a primitive's unknowns, with what neighbours share.
//!
//! ```text
//! V = max of  C under independent errors,  C by the kernel of `shared_errors.rs`,  C by sums over cells of the cloud (`evidence.rs`)
//! L L' = C,  L^-1 V_kernel L^-T = Q D Q'          V = L Q max(D, 1) Q' L'
//! ```
//!
//! The kernel follows errors whose covariance falls with the distance; cells find those that do not, as the waves of a lack of fit. The
//! kernel's products are sums over some of all pairs of contacts, which may leave less than no variance of a direction in which the unknowns
//! move.

use super::cloud::Cloud;
use super::evidence::Cells;
use super::neighbour_products::Weighted;
use super::shared_errors::with_shared_errors;
use crate::primitives::normal_equations::rows;
use crate::primitives::placed::MOST_UNKNOWNS;
use palpate_numeric::linalg::small::{Square, cholesky, eigen, forward};

/// Covariance of the unknowns with errors that neighbours share, by their kernel and by cells of the cloud: the larger variance counts, and
/// none is less than that of independent errors.
pub(super) fn covariance_of_unknowns(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    independent: &Square<MOST_UNKNOWNS>,
    cells: &Cells,
) -> Square<MOST_UNKNOWNS> {
    let by_kernel = not_below(independent, &with_shared_errors(cloud, inner, fit, independent));
    let by_cells = widened_by_cells(cloud, inner, fit, independent, cells);
    let wider = |k: usize| {
        let (least, found) = (independent[k][k] * by_cells[k], by_kernel[k][k]);
        // nothing is found of an unknown that is not free
        if least > found { (least / found).sqrt() } else { 1.0 }
    };
    let times: [f64; MOST_UNKNOWNS] = std::array::from_fn(wider);
    std::array::from_fn(|i| std::array::from_fn(|j| by_kernel[i][j] * times[i] * times[j]))
}

/// The larger of two covariances in every direction; `least` is positive but in unknowns that are not free, of which both have nothing.
fn not_below(least: &Square<MOST_UNKNOWNS>, found: &Square<MOST_UNKNOWNS>) -> Square<MOST_UNKNOWNS> {
    let sd: [f64; MOST_UNKNOWNS] = std::array::from_fn(|k| least[k][k].sqrt());
    let scaled = |of: &Square<MOST_UNKNOWNS>, open: f64| -> Square<MOST_UNKNOWNS> {
        let entry = |i: usize, j: usize| of[i][j] / (sd[i] * sd[j]);
        let of_open = |i: usize, j: usize| if i == j { open } else { 0.0 };
        let both = |i: usize, j: usize| if sd[i] * sd[j] > 0.0 { entry(i, j) } else { of_open(i, j) };
        std::array::from_fn(|i| std::array::from_fn(|j| both(i, j)))
    };
    let Some(lower) = cholesky(&scaled(least, 1.0)) else { return *least };
    // L^-1 V, and the same of its transpose
    let whitened = |of: &Square<MOST_UNKNOWNS>| transposed(&transposed(of).map(|column| forward(&lower, column)));
    let (values, axes) = eigen(&whitened(&transposed(&whitened(&scaled(found, 0.0)))));
    let directions = axes.map(|axis| lower.map(|row| row.iter().zip(axis).map(|(l, a)| l * a).sum::<f64>()));
    let sum = |i: usize, j: usize| {
        let each = values.iter().zip(&directions).map(|(value, along)| value.max(1.0) * along[i] * along[j]);
        sd[i] * sd[j] * each.sum::<f64>()
    };
    std::array::from_fn(|i| std::array::from_fn(|j| sum(i, j)))
}

fn transposed(of: &Square<MOST_UNKNOWNS>) -> Square<MOST_UNKNOWNS> {
    std::array::from_fn(|i| std::array::from_fn(|j| of[j][i]))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unknowns that are free: along (1, 1) the kernel leaves four times the variance, along (1, -1) less than none.
    #[test]
    fn no_direction_is_better_known_than_under_independent_errors() {
        let of = |one: f64, both: f64| {
            let mut matrix = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
            (matrix[1][1], matrix[1][4], matrix[4][1], matrix[4][4]) = (one, 10.0 * both, 10.0 * both, 100.0 * one);
            matrix
        };
        let found = not_below(&of(1.0, 0.0), &of(1.5, 2.5));
        for (i, j, expected) in [(1, 1, 2.5), (1, 4, 15.0), (4, 4, 250.0), (0, 0, 0.0), (0, 1, 0.0)] {
            assert!((found[i][j] - expected).abs() < 1e-9 * 250.0, "{i} {j} {}", found[i][j]);
        }
        let less = not_below(&of(1.0, 0.5), &of(0.25, 0.1));
        assert!((less[1][1] - 1.0).abs() < 1e-12 && (less[1][4] - 5.0).abs() < 1e-10, "{less:?}");
    }
}
