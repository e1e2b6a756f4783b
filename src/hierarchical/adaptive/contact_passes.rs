//! What a fit asks of its contacts, wherever they are: in memory, in files, on other machines.
//!
//! ```text
//! about a surface   shares of the contacts      sums by cell      evidence by cell      who is left out      a plane instead
//! ```
//!
//! Every number is formed within one cell, or one block of 2,000 contacts, in the order of the contacts, and added over cells by whoever
//! asks: so the answers have the same bits however the contacts are kept.

use super::local_scale::ShareRule;
use super::split_test::{CellEvidence, SplitLimits};
use crate::equations::{CellSums, ContactResiduals, SortedContacts, SumLayout, SurfaceCells, scrambled};
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use palpate_numeric::threads;

/// Cells that one thread takes at a time.
const PIECE: usize = 64;

/// How many contacts there are, and what comes with each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PassColumns {
    pub count: usize,
    pub layout: SumLayout,
    /// Rows of normals are linear about a surface only.
    pub normals: bool,
}

/// Contacts that count for nothing: how many, and which, as a sum of scrambled numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LeftOutContacts {
    pub count: usize,
    pub fingerprint: u64,
}

impl LeftOutContacts {
    pub(super) fn of(numbers: impl Iterator<Item = usize>) -> LeftOutContacts {
        numbers.fold(LeftOutContacts::default(), |sum, number| {
            sum.with(LeftOutContacts { count: 1, fingerprint: scrambled(number as u64) })
        })
    }

    pub(super) fn with(self, other: LeftOutContacts) -> LeftOutContacts {
        let fingerprint = self.fingerprint.wrapping_add(other.fingerprint);
        LeftOutContacts { count: self.count + other.count, fingerprint }
    }
}

/// Sums of weights, places and heights: w, wx, wy, wxx, wxy, wyy, wz, wxz, wyz.
pub(crate) type PlaneMoments = [f64; 9];

/// Squares about a plane and about the surface, and how many contacts count.
pub(crate) type PlaneSquares = [f64; 3];

/// Contacts that can be gone through.
pub(crate) trait ContactPasses {
    /// What there is.
    fn columns(&self) -> PassColumns;
    /// Everything that follows is about this surface.
    fn about(&mut self, field: &HierarchicalField) -> Result<(), HierarchyError>;
    /// From now on contacts count by their deviations from this surface, and by the noise near them where it varies.
    fn weigh(&mut self, field: &HierarchicalField, rule: ShareRule, noise_varies: bool) -> Result<(), HierarchyError>;
    /// Sums over the contacts of every cell.
    fn sums(&mut self, field: &HierarchicalField) -> Result<CellSums, HierarchyError>;
    /// What the residuals of every cell say.
    fn evidence(&mut self, field: &HierarchicalField, limits: SplitLimits)
    -> Result<Vec<CellEvidence>, HierarchyError>;
    /// Who counts for nothing.
    fn left_out(&mut self, field: &HierarchicalField) -> Result<LeftOutContacts, HierarchyError>;
    /// Their numbers, ascending.
    fn outliers(&mut self, field: &HierarchicalField) -> Result<Vec<usize>, HierarchyError>;
    /// Of all contacts, by their shares.
    fn plane_moments(&mut self, field: &HierarchicalField) -> Result<PlaneMoments, HierarchyError>;
    /// About the plane `z = p0 + p1 x + p2 y`.
    fn plane_squares(&mut self, field: &HierarchicalField, plane: [f64; 3]) -> Result<PlaneSquares, HierarchyError>;
}

/// Contacts of some cells with their residuals and shares.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellContacts<'a> {
    pub surface: SurfaceCells<'a>,
    pub contacts: &'a SortedContacts,
    pub residuals: &'a ContactResiduals,
    pub shares: Option<&'a [f64]>,
}

impl CellContacts<'_> {
    fn weight(&self, r: usize) -> f64 {
        let w = self.contacts.contacts().weights.z.as_deref().map_or(1.0, |w| w[r]);
        self.shares.map_or(1.0, |shares| shares[r]) * w * w
    }

    fn by_cell<const N: usize>(&self, row: impl Fn(usize) -> [f64; N] + Sync) -> Vec<[f64; N]> {
        threads::map(self.surface.cells.len(), PIECE, |cell| {
            let range = self.contacts.of_cell(self.surface.mesh, self.surface.cells[cell]);
            added(range.map(&row))
        })
    }

    /// Cell by cell.
    pub(super) fn plane_moments(&self) -> Vec<PlaneMoments> {
        let columns = self.contacts.contacts();
        self.by_cell(|r| {
            let (w, x, y, z) = (self.weight(r), columns.x[r], columns.y[r], columns.z[r]);
            [w, w * x, w * y, w * x * x, w * x * y, w * y * y, w * z, w * x * z, w * y * z]
        })
    }

    /// Cell by cell.
    pub(super) fn plane_squares(&self, plane: [f64; 3]) -> Vec<PlaneSquares> {
        let columns = self.contacts.contacts();
        self.by_cell(|r| {
            let w = self.weight(r);
            let off = columns.z[r] - plane[0] - plane[1] * columns.x[r] - plane[2] * columns.y[r];
            [w * off.powi(2), w * self.residuals.heights[r].powi(2), if w > 0.0 { 1.0 } else { 0.0 }]
        })
    }

    /// Numbers of the contacts that count for nothing.
    pub(super) fn left_out(&self) -> impl Iterator<Item = usize> {
        let from = self.surface.cells.first().map_or(0, |cell| self.contacts.of_cell(self.surface.mesh, *cell).start);
        let to = self.surface.cells.last().map_or(0, |cell| self.contacts.of_cell(self.surface.mesh, *cell).end);
        let shares = self.shares.map_or(&[][..], |shares| &shares[from..to]);
        let none = shares.iter().enumerate().filter(|(_, share)| **share == 0.0);
        none.map(move |(k, _)| self.contacts.number(from + k))
    }
}

/// Sums of rows, one after another.
pub(super) fn added<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> [f64; N] {
    let mut sums = [0.0; N];
    for row in rows {
        sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += v);
    }
    sums
}
