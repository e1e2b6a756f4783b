//! A surface cell by cell, as passes over contacts see it: cells in the order of the contacts, and the polynomial on each.
//!
//! ```text
//! S on cell Q = sum_ab C_Q[a][b] N_a(x) M_b(y),   C_Q = (p + 1)(q + 1) numbers
//! ```
//!
//! It may be a part of a surface: whoever holds a part of the contacts needs no more of it.

use std::ops::Range;

use super::polynomials::{AxisPolynomials, CellPolynomial};
use crate::field::HierarchicalField;
use crate::mesh::{CellId, Mesh};

/// Cells one behind the other with what a surface is on each.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceCells<'a> {
    /// Knots of all levels that the cells are of.
    pub mesh: &'a Mesh,
    /// Unsplit cells, base cell by base cell, children in the order of the tree.
    pub cells: &'a [CellId],
    /// (p + 1)(q + 1) numbers for each.
    pub tables: &'a [f64],
}

impl<'a> SurfaceCells<'a> {
    /// All cells of a surface.
    pub fn of(field: &'a HierarchicalField) -> SurfaceCells<'a> {
        let space = field.space();
        SurfaceCells { mesh: space.mesh(), cells: space.leaves(), tables: field.tables() }
    }

    /// The same of a run of the cells.
    pub fn part(&self, cells: Range<usize>) -> SurfaceCells<'a> {
        let count = self.local_count();
        let tables = &self.tables[cells.start * count..cells.end * count];
        SurfaceCells { mesh: self.mesh, cells: &self.cells[cells], tables }
    }

    /// Functions on a cell.
    pub fn local_count(&self) -> usize {
        self.mesh.levels().degree().iter().map(|p| p + 1).product()
    }

    /// The polynomial on a cell.
    pub(crate) fn polynomial(&self, number: usize) -> CellPolynomial {
        let cell = self.cells[number];
        let knots = self.mesh.levels().at(cell.level.into());
        let axes = [0, 1].map(|k| AxisPolynomials::new(knots[k].knots(), cell.place[k] as usize));
        let count = self.local_count();
        let table = &self.tables[number * count..(number + 1) * count];
        CellPolynomial::new(&axes, self.mesh.centre_and_half(cell), table)
    }
}
