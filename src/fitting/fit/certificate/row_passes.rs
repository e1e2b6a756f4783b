//! Visits of the rows behind a certificate, eight sites at a time.
//!
//! ```text
//! r = (b - E c) - E v      E'r, |E|'|r|, squares of E's columns      | |E||c| + |b| + |r| |^2, |r|^2, the worst ratio
//! ```
//!
//! The contacts of large fits are already packed eight to a group per knot cell; those of small ones are packed at the first
//! visit. Sums that belong to columns are kept per cell and added to the unknowns when the visit leaves the cell.

use crate::fit::linear::equations::Equations;
use palpate_numeric::linalg::{SiteGroups, SiteRows, Sites};
use palpate_numeric::simd::{
    CellSites, CellVectors, ColumnSums, Isa, RowSums, SiteLanes, add_lanes, columns_pass, last_pass, norms_pass,
    products_pass,
};

/// Sums over all rows for one unknown: `E'r`, `|E|'|r|`, squared norm of the column.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ColumnTotals {
    /// `E'r`.
    pub product: f64,
    /// `|E|'|r|`.
    pub size: f64,
    /// Squared norm.
    pub norm: f64,
}

/// Visits of the rows of one fit with `c` and `v`.
pub(super) struct RowPasses<'a> {
    equations: &'a Equations,
    c: &'a [f64],
    isa: Isa,
    groups: SiteGroups,
    cell: Cell,
}

/// The cell that is visited.
struct Cell {
    first: Option<[usize; 2]>,
    width: [usize; 2],
    columns: usize,
    /// The cell's parts of c and of v, one after the other; empty where there is only one cell.
    parts: Vec<f64>,
    sums: Vec<ColumnSums>,
}

impl Cell {
    fn new(equations: &Equations) -> Cell {
        let shape = equations.sites.shape();
        let width = shape.degree.map(|d| d + 1);
        let local = width[0] * width[1];
        let parts = if local == shape.unknowns() { Vec::new() } else { vec![0.0; 2 * local] };
        let sums = vec![ColumnSums::default(); local];
        Cell { first: None, width, columns: shape.basis[1], parts, sums }
    }

    /// Goes to the cell of these first basis functions; the sums of the cell before are added to `home`.
    fn enter(&mut self, first: [usize; 2], vectors: [&[f64]; 2], home: &mut [ColumnTotals]) {
        if self.first == Some(first) {
            return;
        }
        self.leave(home);
        self.first = Some(first);
        let local = self.sums.len();
        let parts = self.parts.chunks_exact_mut(local).zip(vectors);
        for (parts, vector) in parts.filter(|(_, vector)| !vector.is_empty()) {
            for (a, part) in parts.chunks_exact_mut(self.width[1]).enumerate() {
                part.copy_from_slice(&vector[(first[0] + a) * self.columns + first[1]..][..part.len()]);
            }
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
    /// Visits of the rows of `equations` with the coefficients `c`.
    pub(super) fn new(equations: &'a Equations, c: &'a [f64]) -> RowPasses<'a> {
        let (groups, cell) = (SiteGroups::new(&equations.sites), Cell::new(equations));
        RowPasses { equations, c, isa: Isa::for_work(equations.sites.len()), groups, cell }
    }

    /// `E'r`, the other sums left at zero; an empty `v` stands for zeros.
    pub(super) fn products(&mut self, v: &[f64], home: &mut [ColumnTotals]) {
        let isa = self.isa;
        home.fill(ColumnTotals::default());
        self.visit([self.c, v], home, |sites, vectors, columns| products_pass(isa, sites, vectors, columns));
    }

    /// Squared norms of the columns, added to `home`.
    pub(super) fn norms(&mut self, home: &mut [ColumnTotals]) {
        let isa = self.isa;
        self.visit([self.c, &[]], home, |sites, _, columns| columns_pass(isa, sites, columns));
    }

    /// All sums but the columns' norms, which are left at zero.
    pub(super) fn last(&mut self, v: &[f64], home: &mut [ColumnTotals], rows: &mut RowSums) {
        let isa = self.isa;
        home.fill(ColumnTotals::default());
        self.visit([self.c, v], home, |sites, vectors, columns| last_pass(isa, sites, vectors, columns, rows));
    }

    /// The worst ratio, where a size below `tiny` times the row's norm, `|E_i|_1 largest`, is replaced by that norm.
    pub(super) fn against_norms(&mut self, v: &[f64], largest: f64, tiny: f64) -> f64 {
        let (isa, largest) = (self.isa, vec![largest; self.cell.sums.len()]);
        let (mut unused, mut worst) = (vec![ColumnTotals::default(); v.len()], SiteLanes::default());
        self.visit([self.c, v], &mut unused, |sites, vectors, _| {
            norms_pass(isa, sites, vectors, &largest, tiny, &mut worst);
        });
        worst.iter().fold(0.0, |m: f64, v| m.max(*v))
    }

    fn visit(
        &mut self,
        vectors: [&[f64]; 2],
        home: &mut [ColumnTotals],
        mut pass: impl FnMut(&CellSites, &CellVectors, &mut [ColumnSums]),
    ) {
        let RowPasses { equations, groups, cell, .. } = self;
        let mut eight = |first: [usize; 2], sites: &CellSites, targets: [&SiteLanes; 3]| {
            cell.enter(first, vectors, home);
            let [c, v] = match cell.parts.split_at_checked(cell.sums.len()) {
                Some((c, v)) => [c, if vectors[1].is_empty() { &[] } else { v }],
                None => vectors,
            };
            pass(sites, &CellVectors { c, v, targets }, &mut cell.sums);
        };
        match equations.packed() {
            Some((cells, rows)) => cells.visit(rows, eight),
            None => {
                let Equations { sites, row_weights, targets, .. } = equations;
                groups.visit(&SiteRows { sites, row_weights, targets }, |block| {
                    eight(block.first, &block.sites, block.targets)
                });
            }
        }
        cell.leave(home);
    }
}
