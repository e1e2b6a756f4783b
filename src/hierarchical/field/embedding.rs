//! A surface in a finer space: knots are inserted, and nothing of it changes.
//!
//! ```text
//! c_ij of level l = coefficient of N^l_ij in S on any cell of level l that lies in its support
//! ```
//!
//! The truncation preserves coefficients: an active function's is that of the tensor spline of its level.

use std::sync::Arc;

use super::HierarchicalField;
use crate::error::HierarchyError;
use crate::mesh::{CellId, Mesh};
use crate::space::{HierarchicalSpace, LocalFunction};

impl HierarchicalField {
    /// The same surface over a space whose cells are these or parts of these.
    ///
    /// # Errors
    /// [`HierarchyError::Coefficients`] where the other space is not finer everywhere.
    pub fn embedded(&self, finer: Arc<HierarchicalSpace>) -> Result<HierarchicalField, HierarchyError> {
        let wrong = || HierarchyError::Coefficients { found: self.coefficients.len(), expected: finer.unknowns() };
        let mut coefficients = vec![0.0; finer.unknowns()];
        let old = &self.space;
        for (leaf, cell) in finer.leaves().iter().enumerate() {
            // the old leaf that holds the cell
            let level = (0..=cell.level).rev().find(|level| old.leaf_of(cell.ancestor(*level)).is_some());
            let from = level.map(|level| cell.ancestor(level)).ok_or_else(wrong)?;
            let mut table = self.table(old.leaf_of(from).ok_or_else(wrong)?).to_vec();
            for level in from.level + 1..=cell.level {
                table = child_table(finer.mesh(), cell.ancestor(level), &table);
            }
            for (function, value) in finer.local_functions(leaf).zip(table) {
                if let LocalFunction::Active(number) = function {
                    coefficients[number as usize] = value;
                }
            }
        }
        HierarchicalField::new(finer, coefficients)
    }
}

/// Coefficients on a child from those on its parent.
fn child_table(mesh: &Mesh, child: CellId, parent: &[f64]) -> Vec<f64> {
    let level = usize::from(child.level);
    let [wide, high] = mesh.levels().degree().map(|p| p + 1);
    let [coarse, fine] = [level - 1, level].map(|l| mesh.levels().at(l));
    let share = |axis: usize, fine_function: usize, local: usize| {
        let row = mesh.levels().insertion_row(axis, level - 1, fine_function);
        let first = coarse[axis].knots().first_basis((child.place[axis] / 2) as usize);
        (first + local).checked_sub(row.first).and_then(|at| row.shares.get(at)).copied().unwrap_or(0.0)
    };
    let matrix = |axis: usize, width: usize| -> Vec<f64> {
        let first = fine[axis].knots().first_basis(child.place[axis] as usize);
        (0..width * width).map(|k| share(axis, first + k / width, k % width)).collect()
    };
    let (x, y) = (matrix(0, wide), matrix(1, high));
    let mut table = vec![0.0; wide * high];
    for a in 0..wide {
        for b in 0..high {
            for (c, row) in parent.chunks_exact(high).enumerate() {
                let along: f64 = row.iter().zip(&y[b * high..]).map(|(v, s)| v * s).sum();
                table[a * high + b] += x[a * wide + c] * along;
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::Knots;
    use palpate_numeric::draws::Lcg;

    #[test]
    fn finer_knots_leave_the_surface_as_it_was() {
        let mut draw = Lcg::new(5);
        for degree in 2..=5 {
            let knots = |n| Knots::uniform(degree, n, 0.0, 1.0).unwrap();
            let mut mesh = Mesh::new([knots(4), knots(3)]).unwrap();
            mesh.refine(CellId { level: 1, place: [3, 2] }).unwrap();
            let coarse = Arc::new(HierarchicalSpace::new(mesh.clone()));
            let c = (0..coarse.unknowns()).map(|_| draw.uniform()).collect();
            let field = HierarchicalField::new(coarse, c).unwrap();
            mesh.refine(CellId { level: 3, place: [13, 9] }).unwrap();
            mesh.refine(CellId { level: 0, place: [0, 2] }).unwrap();
            let finer = Arc::new(HierarchicalSpace::new(mesh));
            let same = field.embedded(finer).unwrap();
            for _ in 0..300 {
                let at = [draw.uniform(), draw.uniform()];
                let (a, b) = (field.at(at[0], at[1]), same.at(at[0], at[1]));
                assert!((a.z - b.z).abs() < 1e-14 && (a.zx - b.zx).abs() < 1e-11 && (a.zyy - b.zyy).abs() < 1e-8);
            }
            assert!(same.embedded(field.space().clone()).is_err());
        }
    }
}
