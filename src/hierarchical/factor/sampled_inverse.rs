//! Variances without the factor of the whole: exact within blocks, by random draws for what reaches a block from outside.
//!
//! ```text
//! x ~ N(0, Q^-1):  Q x = b, b ~ N(0, Q)           (G. Papandreou, A. Yuille, *NIPS* (2010) 1858)
//! g'Q^-1 g = g_U' Q_UU^-1 g_U + var(g_U' m),      m = E(x_U given the others) = x_U - Q_UU^-1 b_U
//! ```
//!
//! U is a block with all unknowns that meet its middle, g a functional on one cell of the middle. The first term is exact, and the second,
//! the mean of K squares, is free of bias and off by the share sqrt(2/K) of itself (P. Siden, F. Lindgren, D. Bolin, M. Villani, *J. Comput.
//! Graph. Stat.* 27 (2018) 898). Where contacts are, little of a variance comes from beyond the block.

use super::schwarz::{SchwarzBlock, SchwarzSolver};
use super::selected_inverse::SelectedInverse;
use palpate_numeric::threads;

/// Entries of the inverse among unknowns that meet, block by block.
#[derive(Clone, Debug)]
pub struct SampledInverse {
    blocks: Vec<SampledBlock>,
    block_of: Vec<u32>,
    draws: usize,
}

/// A block: the inverse of its own matrix, and what its unknowns are expected to be given those outside, draw by draw.
#[derive(Clone, Debug)]
struct SampledBlock {
    unknowns: Vec<u32>,
    own: SelectedInverse,
    means: Vec<f64>,
}

impl SampledInverse {
    /// From loads that are random with the matrix as their covariance, one for each draw; they become solutions. `None` where there are none.
    pub(super) fn of(solver: &SchwarzSolver, loads: Vec<Vec<f64>>) -> Option<SampledInverse> {
        let draws = loads.len();
        if draws == 0 {
            return None;
        }
        let mut solutions = loads.clone();
        threads::each(&mut solutions, |_, solution| {
            solver.solve(solution);
        });
        let blocks =
            threads::map(solver.blocks().len(), 1, |k| SampledBlock::of(&solver.blocks()[k], &loads, &solutions));
        let blocks = blocks.into_iter().collect::<Option<Vec<_>>>()?;
        Some(SampledInverse { blocks, block_of: solver.block_of().to_vec(), draws })
    }

    /// `g'Q^-1 g` of a functional whose unknowns all meet each other: `(unknown, derivative)`.
    pub fn quadratic(&self, gradient: &[(u32, f64)]) -> Option<f64> {
        let [own, beyond] = self.parts(gradient)?;
        Some(own + beyond)
    }

    /// The exact part and the drawn one.
    fn parts(&self, gradient: &[(u32, f64)]) -> Option<[f64; 2]> {
        let Some((first, _)) = gradient.first() else { return Some([0.0; 2]) };
        let block = &self.blocks[self.block_of[*first as usize] as usize];
        let places =
            gradient.iter().map(|(unknown, g)| Some((block.place(*unknown)?, *g))).collect::<Option<Vec<_>>>()?;
        let own = block.own.quadratic(places.iter().copied())?;
        let squares = block.means.chunks_exact(block.unknowns.len()).map(|means| {
            let value: f64 = places.iter().map(|(place, g)| g * means[*place]).sum();
            value * value
        });
        Some([own, squares.sum::<f64>() / self.draws as f64])
    }

    /// `tr Q^-1 B` for a matrix B within the pattern, by the values of its upper triangle in compressed columns.
    pub fn trace_with(&self, starts: &[usize], rows: &[usize], values: &[f64]) -> f64 {
        let entry = |row: usize, column: usize| {
            let block = &self.blocks[self.block_of[column] as usize];
            let [i, j] = [block.place(row as u32)?, block.place(column as u32)?];
            let products = block.means.chunks_exact(block.unknowns.len()).map(|means| means[i] * means[j]);
            Some(block.own.entry(i, j)? + products.sum::<f64>() / self.draws as f64)
        };
        let columns = threads::map(starts.len().saturating_sub(1), 256, |column| {
            let places = starts[column]..starts[column + 1];
            let term = |at: usize| {
                let twice = if rows[at] == column { 1.0 } else { 2.0 };
                twice * values[at] * entry(rows[at], column).unwrap_or(0.0)
            };
            places.map(term).sum::<f64>()
        });
        columns.iter().sum()
    }

    /// Share by which draws put a standard deviation off, root mean square over all unknowns.
    pub fn error(&self) -> f64 {
        let shares = threads::map(self.block_of.len(), 256, |unknown| {
            self.parts(&[(unknown as u32, 1.0)]).map_or(0.0, |[own, beyond]| (beyond / (own + beyond)).powi(2))
        });
        // half of that of a variance
        (0.5 * shares.iter().sum::<f64>() / shares.len().max(1) as f64 / self.draws as f64).sqrt()
    }
}

impl SampledBlock {
    fn of(block: &SchwarzBlock, loads: &[Vec<f64>], solutions: &[Vec<f64>]) -> Option<SampledBlock> {
        let own = SelectedInverse::of(&block.factor)?;
        let unknowns = block.unknowns.clone();
        let mut means = Vec::with_capacity(unknowns.len() * loads.len());
        for (load, solution) in loads.iter().zip(solutions) {
            let mut given: Vec<f64> = unknowns.iter().map(|unknown| load[*unknown as usize]).collect();
            block.factor.solve(&mut given);
            means.extend(unknowns.iter().zip(given).map(|(unknown, own)| solution[*unknown as usize] - own));
        }
        Some(SampledBlock { unknowns, own, means })
    }

    fn place(&self, unknown: u32) -> Option<usize> {
        self.unknowns.binary_search(&unknown).ok()
    }
}
