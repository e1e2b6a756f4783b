//! Solutions without the factor of the whole: conjugate gradients, preconditioned by overlapping blocks and one coarse grid.
//!
//! ```text
//! M^-1 = P (P'A P)^-1 P' + sum_b R_b' (R_b A R_b')^-1 R_b         R_b: the unknowns of a block and all that meet them
//! ```
//!
//! Blocks are near unknowns by their places, their factors small. Columns of P are bilinear hats over a coarse grid, taken at the places: what is
//! smooth over many blocks, nearly all of it (M. Dryja, O. Widlund, *SIAM J. Sci. Comput.* 15 (1994) 604; the additive method with a coarse
//! space).

use super::nested_dissection::Meetings;
use super::sparse_cholesky::{EliminationOrder, SparseCholesky};
use crate::error::HierarchyError;
use palpate_numeric::linalg::{GradientLimits, conjugate_gradients};
use palpate_numeric::threads;

/// Unknowns of a block before others are added that meet them: of twice as many the factors take a third more memory for each unknown.
const BLOCK: usize = 512;
/// Nodes of the coarse grid along a side at most: its matrix is factored as a full one.
const MOST_NODES: usize = 24;
/// Iterations end where the residual has fallen by this: what is left is the rounding of a factorisation of condition 1e4.
const REDUCTION: f64 = 1e-13;
/// Iterations at most; what is reached then is told by the certificate.
const MOST_ITERATIONS: usize = 2000;

/// A preconditioned matrix of one pattern.
#[derive(Clone, Debug)]
pub(super) struct SchwarzSolver {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    blocks: Vec<SchwarzBlock>,
    /// The block that every unknown is in the middle of.
    block_of: Vec<u32>,
    /// Nodes of the coarse grid that an unknown has a share of.
    shares: Vec<[(u32, f64); 4]>,
    coarse: SparseCholesky,
}

/// A block with its own factor.
#[derive(Clone, Debug)]
pub(super) struct SchwarzBlock {
    /// Ascending.
    pub unknowns: Vec<u32>,
    /// Places of its matrix's entries among those of the whole.
    entries: Vec<usize>,
    /// Of the matrix among its unknowns.
    pub factor: SparseCholesky,
}

impl SchwarzSolver {
    /// Plans for a pattern as [`SparseCholesky::plan`] does.
    pub(super) fn plan(starts: &[usize], rows: &[usize], places: &[[f64; 2]]) -> Result<SchwarzSolver, HierarchyError> {
        let order = places.len();
        let mut sets = vec![(0..order as u32).collect::<Vec<u32>>()];
        let mut cores = Vec::new();
        while let Some(set) = sets.pop() {
            if set.len() <= BLOCK {
                cores.push(set);
            } else {
                sets.extend(halves(set, places));
            }
        }
        let meetings = Meetings::of(starts, rows);
        let blocks = threads::map(cores.len(), 1, |k| SchwarzBlock::plan(&cores[k], &meetings, [starts, rows], places));
        let (shares, nodes) = coarse_shares(places);
        // a full upper triangle
        let full: Vec<usize> = (0..nodes).flat_map(|column| 0..=column).collect();
        let ends: Vec<usize> = (0..=nodes).map(|column| column * (column + 1) / 2).collect();
        let coarse = SparseCholesky::plan(&ends, &full, EliminationOrder::MinimumDegree)?;
        let blocks = blocks.into_iter().collect::<Result<_, _>>()?;
        let mut block_of = vec![0; order];
        for (block, core) in cores.iter().enumerate() {
            core.iter().for_each(|unknown| block_of[*unknown as usize] = block as u32);
        }
        let (starts, rows) = (starts.into(), rows.into());
        Ok(SchwarzSolver { starts, rows, values: Vec::new(), blocks, block_of, shares, coarse })
    }

    /// The blocks.
    pub(super) fn blocks(&self) -> &[SchwarzBlock] {
        &self.blocks
    }

    /// Number of the block that holds an unknown and all that meet it.
    pub(super) fn block_of(&self) -> &[u32] {
        &self.block_of
    }

    /// Takes a matrix by the values of its upper triangle.
    pub(super) fn factor(&mut self, values: &[f64]) -> Result<(), HierarchyError> {
        self.values = values.to_vec();
        let mut outcomes = vec![Ok(()); self.blocks.len()];
        let mut work: Vec<(&mut SchwarzBlock, &mut Result<(), HierarchyError>)> =
            self.blocks.iter_mut().zip(&mut outcomes).collect();
        threads::each(&mut work, |_, (block, outcome)| {
            let own: Vec<f64> = block.entries.iter().map(|at| values[*at]).collect();
            **outcome = block.factor.factor(&own);
        });
        outcomes.into_iter().collect::<Result<(), _>>()?;
        let nodes = self.coarse.order().len();
        let mut coarse = vec![0.0; nodes * (nodes + 1) / 2];
        for column in 0..self.shares.len() {
            for at in self.starts[column]..self.starts[column + 1] {
                self.add_coarse([self.rows[at], column], values[at], &mut coarse);
            }
        }
        for diagonal in (0..nodes).map(|k| k * (k + 3) / 2) {
            // a node without a share of any place
            if coarse[diagonal] <= 0.0 {
                coarse[diagonal] = 1.0;
            }
        }
        self.coarse.factor(&coarse)
    }

    fn add_coarse(&self, [row, column]: [usize; 2], value: f64, coarse: &mut [f64]) {
        for (a, s) in self.shares[row] {
            for (b, t) in self.shares[column] {
                let product = s * t * value;
                let (low, high) = (a.min(b) as usize, a.max(b) as usize);
                // an entry off the diagonal of A stands for both, which fall on one place of the coarse diagonal
                if row != column && a == b {
                    coarse[high * (high + 1) / 2 + low] += 2.0 * product;
                } else if row != column || a <= b {
                    coarse[high * (high + 1) / 2 + low] += product;
                }
            }
        }
    }

    fn precondition(&self, v: &mut [f64]) {
        let given: &[f64] = v;
        let parts = threads::map(self.blocks.len(), 1, |k| {
            let block = &self.blocks[k];
            let mut own: Vec<f64> = block.unknowns.iter().map(|unknown| given[*unknown as usize]).collect();
            block.factor.solve(&mut own);
            own
        });
        let mut coarse = vec![0.0; self.coarse.order().len()];
        for (shares, given) in self.shares.iter().zip(given) {
            shares.iter().for_each(|(node, share)| coarse[*node as usize] += share * given);
        }
        self.coarse.solve(&mut coarse);
        v.fill(0.0);
        for (block, part) in self.blocks.iter().zip(parts) {
            block.unknowns.iter().zip(part).for_each(|(unknown, part)| v[*unknown as usize] += part);
        }
        for (shares, v) in self.shares.iter().zip(v) {
            shares.iter().for_each(|(node, share)| *v += share * coarse[*node as usize]);
        }
    }

    fn multiply(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..v.len() {
            for at in self.starts[column]..self.starts[column + 1] {
                let (row, value) = (self.rows[at], self.values[at]);
                out[row] += value * v[column];
                if row != column {
                    out[column] += value * v[row];
                }
            }
        }
    }

    /// `v <- A^-1 v`; how many iterations it took.
    pub(super) fn solve(&self, v: &mut [f64]) -> usize {
        let limits = GradientLimits { tolerance: REDUCTION, steps: MOST_ITERATIONS };
        let multiply = |v: &[f64], out: &mut [f64]| self.multiply(v, out);
        let (solution, iterations) = conjugate_gradients(multiply, |v| self.precondition(v), v, limits);
        v.copy_from_slice(&solution);
        iterations
    }

    /// Numbers in all factors.
    pub(super) fn entries(&self) -> usize {
        self.blocks.iter().map(|block| block.factor.factor_entries()).sum::<usize>() + self.coarse.factor_entries()
    }
}

/// Two sets of near unknowns.
fn halves(mut set: Vec<u32>, places: &[[f64; 2]]) -> [Vec<u32>; 2] {
    let side = |axis: usize| {
        let ends = set
            .iter()
            .map(|u| places[*u as usize][axis])
            .fold([f64::MAX, f64::MIN], |[lo, hi], t| [lo.min(t), hi.max(t)]);
        ends[1] - ends[0]
    };
    let axis = usize::from(side(1) > side(0));
    let middle = set.len() / 2;
    let key = |u: &u32| places[*u as usize][axis];
    set.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let right = set.split_off(middle);
    [set, right]
}

impl SchwarzBlock {
    fn plan(
        core: &[u32],
        meetings: &Meetings,
        [starts, rows]: [&[usize]; 2],
        places: &[[f64; 2]],
    ) -> Result<SchwarzBlock, HierarchyError> {
        let beside = core.iter().flat_map(|unknown| meetings.of_unknown(*unknown));
        let mut unknowns: Vec<u32> = core.iter().chain(beside).copied().collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let (mut own_starts, mut own_rows, mut entries) = (vec![0], Vec::new(), Vec::new());
        for column in unknowns.iter().map(|unknown| *unknown as usize) {
            for at in starts[column]..starts[column + 1] {
                if let Ok(row) = unknowns.binary_search(&(rows[at] as u32)) {
                    own_rows.push(row);
                    entries.push(at);
                }
            }
            own_starts.push(own_rows.len());
        }
        let own_places: Vec<[f64; 2]> = unknowns.iter().map(|unknown| places[*unknown as usize]).collect();
        let factor = SparseCholesky::plan(&own_starts, &own_rows, EliminationOrder::NestedDissection(&own_places))?;
        Ok(SchwarzBlock { unknowns, entries, factor })
    }
}

/// Shares of the bilinear hats at every place, and how many hats there are.
fn coarse_shares(places: &[[f64; 2]]) -> (Vec<[(u32, f64); 4]>, usize) {
    let ends = [0, 1].map(|axis| {
        places.iter().map(|place| place[axis]).fold([f64::MAX, f64::MIN], |[lo, hi], t| [lo.min(t), hi.max(t)])
    });
    let side = (places.len() as f64).sqrt() as usize / 4;
    let nodes = side.clamp(2, MOST_NODES);
    let at = |place: [f64; 2]| {
        let [x, y] = [0, 1].map(|axis| {
            let [lo, hi] = ends[axis];
            let t = if hi > lo { (place[axis] - lo) / (hi - lo) * (nodes - 1) as f64 } else { 0.0 };
            let cell = (t as usize).min(nodes - 2);
            (cell, t - cell as f64)
        });
        let node = |i: usize, j: usize| ((x.0 + i) * nodes + y.0 + j) as u32;
        [
            (node(0, 0), (1.0 - x.1) * (1.0 - y.1)),
            (node(0, 1), (1.0 - x.1) * y.1),
            (node(1, 0), x.1 * (1.0 - y.1)),
            (node(1, 1), x.1 * y.1),
        ]
    };
    (places.iter().map(|place| at(*place)).collect(), nodes * nodes)
}
