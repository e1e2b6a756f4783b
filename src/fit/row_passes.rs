//! Visits of the rows behind a certificate, eight sites at a time.
//!
//! ```text
//! computed = b - E c      r = computed - E v      |E||c| + |b| + |r|, |E|'|r|, E'r, squares of E's columns
//! ```
//!
//! What belongs to rows is kept block by block in the order of the visit; what belongs to columns is summed in the cell
//! first and added to the unknowns when the visit leaves it.

use super::Equations;
use crate::linalg::{SiteBlock, SiteBlocks, Sites};
use crate::simd::{ColumnSums, Level, RowSums, SITES, SiteLanes, add_lanes, first_pass, last_sums, second_pass};

/// Three rows of eight sites.
type Rows = [SiteLanes; 3];

/// What is kept of eight sites.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockRows {
    /// `b - E c`.
    pub computed: Rows,
    /// `|E||c| + |b|`, and `|r|` after the last visit.
    pub sizes: Rows,
    /// The residual as it stands.
    pub residual: Rows,
}

/// Sums over all rows for one unknown: `E'r`, `|E|'|r|`, squared norm of the column.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColumnTotals {
    /// `E'r`.
    pub product: f64,
    /// `|E|'|r|`.
    pub size: f64,
    /// Squared norm.
    pub norm: f64,
}

/// The rows of one fit under visit.
pub struct RowPasses<'a> {
    equations: &'a Equations,
    level: Level,
    /// In the order of the visit.
    pub blocks: Vec<BlockRows>,
    /// Sums of the latest visit.
    pub sums: Vec<ColumnTotals>,
    lanes: SiteBlocks,
    cell: Cell,
}

/// The cell that a visit is in.
struct Cell {
    first: Option<[usize; 2]>,
    width: [usize; 2],
    columns: usize,
    /// The cell's part of the vector that the rows are applied to.
    part: Vec<f64>,
    sums: Vec<ColumnSums>,
}

impl Cell {
    fn new(equations: &Equations) -> Cell {
        let shape = equations.sites.shape();
        let width = shape.degree.map(|d| d + 1);
        let local = width[0] * width[1];
        let (part, sums) = (vec![0.0; local], vec![ColumnSums::default(); local]);
        Cell { first: None, width, columns: shape.basis[1], part, sums }
    }

    /// Goes to the cell of these first basis functions, the sums of the one before brought home.
    fn enter(&mut self, first: [usize; 2], v: &[f64], home: &mut [ColumnTotals]) {
        if self.first == Some(first) {
            return;
        }
        self.leave(home);
        self.first = Some(first);
        for (a, part) in self.part.chunks_exact_mut(self.width[1]).enumerate() {
            part.copy_from_slice(&v[(first[0] + a) * self.columns + first[1]..][..part.len()]);
        }
    }

    fn leave(&mut self, home: &mut [ColumnTotals]) {
        let Some(first) = self.first.take() else { return };
        for (a, sums) in self.sums.chunks_exact_mut(self.width[1]).enumerate() {
            let home = &mut home[(first[0] + a) * self.columns + first[1]..][..sums.len()];
            for (home, lanes) in home.iter_mut().zip(sums) {
                home.product += add_lanes(&lanes[0]);
                home.size += add_lanes(&lanes[1]);
                home.norm += add_lanes(&lanes[2]);
                *lanes = ColumnSums::default();
            }
        }
    }
}

impl<'a> RowPasses<'a> {
    /// The first visit: computed residuals, sizes, and `E'computed` as products.
    pub fn new(equations: &'a Equations, c: &[f64]) -> RowPasses<'a> {
        let mut passes = RowPasses {
            equations,
            level: Level::active(),
            blocks: Vec::with_capacity(equations.sites.len().div_ceil(SITES)),
            sums: vec![ColumnTotals::default(); c.len()],
            lanes: SiteBlocks::new(&equations.sites),
            cell: Cell::new(equations),
        };
        let RowPasses { blocks, sums, lanes, cell, level, .. } = &mut passes;
        lanes.visit(&equations.sites, &equations.metric, |block| {
            cell.enter(block.first, c, sums);
            // the targets stand where the residual will
            blocks.push(BlockRows { residual: targets(equations, block), ..BlockRows::default() });
            let Some(rows) = blocks.last_mut() else { return };
            let out = [&mut rows.computed, &mut rows.sizes];
            first_pass(*level, &block.lanes, &cell.part, &rows.residual, out, &mut cell.sums);
            rows.residual = rows.computed;
        });
        cell.leave(sums);
        passes
    }

    /// A later visit: `r -= E v`, and `E'r` as products; with `totals` the last one, which sums up everything.
    pub fn again(&mut self, v: &[f64], mut totals: Option<&mut RowSums>) {
        let RowPasses { equations, level, blocks, sums, lanes, cell } = self;
        sums.iter_mut().for_each(|sum| sum.product = 0.0);
        let mut places = blocks.iter_mut();
        lanes.visit(&equations.sites, &equations.metric, |block| {
            let Some(rows) = places.next() else { return };
            cell.enter(block.first, v, sums);
            second_pass(*level, &block.lanes, &cell.part, &mut rows.residual, &mut cell.sums);
            if let Some(totals) = totals.as_deref_mut() {
                last_sums(
                    *level,
                    &block.lanes,
                    [&rows.residual, &rows.computed],
                    &mut rows.sizes,
                    &mut cell.sums,
                    totals,
                );
            }
        });
        cell.leave(sums);
    }

    /// `|E| |v|`, block by block. The products are those of another vector then.
    pub fn magnitudes(&mut self, v: &[f64]) -> Vec<Rows> {
        let RowPasses { equations, level, lanes, cell, sums, blocks } = self;
        let mut found = Vec::with_capacity(blocks.len());
        lanes.visit(&equations.sites, &equations.metric, |block| {
            cell.enter(block.first, v, sums);
            let [mut unused, mut sizes] = [[[0.0; SITES]; 3]; 2];
            let (targets, out) = ([[0.0; SITES]; 3], [&mut unused, &mut sizes]);
            first_pass(*level, &block.lanes, &cell.part, &targets, out, &mut cell.sums);
            found.push(sizes);
        });
        cell.leave(sums);
        found
    }
}

fn targets(equations: &Equations, block: &SiteBlock) -> Rows {
    let mut targets = [[0.0; SITES]; 3];
    for (lane, &index) in block.indices.iter().enumerate() {
        (0..3).for_each(|k| targets[k][lane] = equations.targets[index][k]);
    }
    targets
}
