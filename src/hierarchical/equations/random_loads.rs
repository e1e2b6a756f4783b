//! Random loads whose covariance is the matrix of the equations: what draws of the surface given the contacts are solutions of.
//!
//! ```text
//! b = sum_Q E_Q' L_Q e_Q,    L_Q L_Q' = A_Q + lambda_l P_Q,    e_Q ~ N(0, I)           cov b = A + sum_l lambda_l P_l
//! ```
//!
//! Every cell's part is a small matrix whose root is found by itself: neither contacts nor a factor of the whole are needed.

use super::local::{BlockWeights, LocalEquations};
use super::polynomials::SegmentTables;
use super::scrambled::scrambled;
use super::sums::CellSums;
use crate::space::{HierarchicalSpace, LocalFunction};
use palpate_fitting::observation::RoughnessOrder;
use palpate_numeric::draws::Lcg;
use palpate_numeric::threads;

/// Leaves whose parts are made on all threads before they are added.
const PIECE: usize = 1024;
/// Leaves that a thread takes at a time at least.
const LEAVES_OF_THREAD: usize = 64;
/// Pivots below this share of the largest diagonal entry are rounding.
const ROUNDING: f64 = 1e-14;

/// The matrix that loads are to have as covariance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoadLaw<'a> {
    pub space: &'a HierarchicalSpace,
    pub sums: &'a CellSums,
    pub weights: BlockWeights,
    pub order: RoughnessOrder,
    /// Weights of the roughness over the cells of every level.
    pub lambdas: &'a [f64],
}

impl LoadLaw<'_> {
    /// So many loads; the same for any number of threads.
    pub(crate) fn draw(&self, draws: usize) -> Vec<Vec<f64>> {
        let mut loads = vec![vec![0.0; self.space.unknowns()]; draws];
        let widths = self.space.mesh().levels().degree().map(|p| p + 1);
        let width = widths[0] * widths[1];
        let leaves = self.space.leaves().len();
        for first in (0..leaves).step_by(PIECE) {
            let start = || (LocalEquations::zeros(widths), SegmentTables::default());
            let count = PIECE.min(leaves - first);
            let parts = threads::map_with(count, LEAVES_OF_THREAD, start, |(local, tables), k| {
                self.of_leaf(first + k, local, tables, draws)
            });
            for (k, part) in parts.iter().enumerate() {
                for (load, values) in loads.iter_mut().zip(part.chunks_exact(width)) {
                    self.add(first + k, values, load);
                }
            }
        }
        loads
    }

    /// `L_Q e_Q` of every draw, one behind the other.
    fn of_leaf(&self, leaf: usize, local: &mut LocalEquations, tables: &mut SegmentTables, draws: usize) -> Vec<f64> {
        let cell = self.space.leaves()[leaf];
        let [x, y] = tables.of(cell, self.space.knots_of(leaf));
        let half = self.space.mesh().centre_and_half(cell)[1];
        let lambda = self.lambdas.get(usize::from(cell.level)).copied().unwrap_or(0.0);
        local.clear();
        local.add_roughness([&x, &y], half, self.order);
        local.matrix.iter_mut().for_each(|value| *value *= lambda);
        let slopes = if self.sums.layout().oriented { self.weights.slopes } else { 0.0 };
        local.add_contacts([&x, &y], &self.sums.cell(leaf), BlockWeights { slopes, ..self.weights });
        let width = local.load.len();
        let root = root_of(&local.matrix, width);
        let mut draw = Lcg::new(scrambled(leaf as u64));
        let mut values = vec![0.0; draws * width];
        for part in values.chunks_exact_mut(width) {
            for column in root.chunks_exact(width) {
                let e = draw.normal();
                part.iter_mut().zip(column).for_each(|(sum, l)| *sum += e * l);
            }
        }
        values
    }

    /// Adds `E_Q' v`.
    fn add(&self, leaf: usize, values: &[f64], load: &mut [f64]) {
        for (function, value) in self.space.local_functions(leaf).zip(values) {
            match function {
                LocalFunction::Active(number) => load[number as usize] += value,
                LocalFunction::Truncated(shares) => {
                    shares.iter().for_each(|(number, share)| load[*number as usize] += share * value);
                }
            }
        }
    }
}

/// Columns L of a semidefinite matrix `L L'`, one behind the other: Cholesky's with the largest pivot first.
fn root_of(matrix: &[f64], width: usize) -> Vec<f64> {
    let mut left: Vec<f64> = (0..width).map(|k| matrix[k * width + k]).collect();
    let least = ROUNDING * left.iter().copied().fold(0.0, f64::max);
    let mut columns: Vec<f64> = Vec::with_capacity(width * width);
    for _ in 0..width {
        let Some((pivot, value)) = left.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if value <= least {
            break;
        }
        let scale = value.sqrt();
        let mut column: Vec<f64> = matrix[pivot * width..(pivot + 1) * width].to_vec();
        for earlier in columns.chunks_exact(width) {
            let share = earlier[pivot];
            column.iter_mut().zip(earlier).for_each(|(v, l)| *v -= share * l);
        }
        column.iter_mut().for_each(|v| *v /= scale);
        left.iter_mut().zip(&column).for_each(|(d, l)| *d -= l * l);
        // spent, whatever rounding says
        left[pivot] = f64::NEG_INFINITY;
        columns.extend(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_give_their_matrix_back() {
        let mut draw = Lcg::new(3);
        for rank in [0, 1, 3, 6] {
            let width = 6;
            let l: Vec<f64> = (0..rank * width).map(|_| draw.normal()).collect();
            let product = |columns: &[f64], i: usize, k: usize| -> f64 {
                columns.chunks_exact(width).map(|column| column[i] * column[k]).sum()
            };
            let matrix: Vec<f64> = (0..width * width).map(|at| product(&l, at / width, at % width)).collect();
            let root = root_of(&matrix, width);
            assert_eq!(root.len(), rank * width);
            assert!((0..width * width).all(|at| (product(&root, at / width, at % width) - matrix[at]).abs() < 1e-12));
        }
    }
}
