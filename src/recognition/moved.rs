//! Where the second look places its equations: the general surface under its displacement.
//!
//! ```text
//! normals without displacement   y_n + Z_n w        w the displacement's weights, so that only noise is left to scatter
//! measured normals               times |n - grad f|  rows are linear in n - grad f, and a normal has length 1
//! distance of a cell             mean d(theta; P) over its contacts P, for the moved theta
//! ```

use faer::Mat;

use crate::vector::{Vector, dot};

use super::cells::{CellNormals, Cells};
use super::model::{Kind, Model};
use super::rows::{Rows, column_of, first_of_displacement};

/// Where the general surface belongs under its displacement.
pub(super) struct Moved {
    pub(super) base: Model,
    /// Weights of the displacement's columns.
    pub(super) weights: Vec<f64>,
    /// Degrees of freedom that the displacement takes from the normals.
    pub(super) spent: f64,
    /// Kernel of the errors that positions share.
    pub(super) kernel: usize,
}

impl Moved {
    /// Takes, in the rows of the general surface, the mean distance of a cell's contacts in place of the distance of their
    /// mean: the moved surface bends otherwise than the one about which the contacts were averaged.
    pub(super) fn average(&self, rows: &mut Rows, cells: &Cells, contacts: &[Vector]) {
        if contacts.len() == cells.points.len() {
            return;
        }
        let y = column_of(Kind::General);
        let (mut sums, mut counts) = (vec![0.0; cells.points.len()], vec![0.0; cells.points.len()]);
        for (&cell, contact) in cells.of.iter().zip(contacts) {
            sums[cell] += self.base.distance(*contact);
            counts[cell] += 1.0;
        }
        (0..cells.points.len()).for_each(|i| rows.positions[(i, y)] = sums[i] / counts[i]);
    }

    /// Multiplies the measured normals, in the rows of the general surface, by the length of `n - grad f`: the rows then
    /// ask for `n - grad f` itself and not for its direction.
    pub(super) fn lengthen(&self, rows: &mut Rows, cells: &Cells) {
        let (Some(halves), Some(CellNormals { measured, .. })) = (&mut rows.normals, &cells.normals) else { return };
        let (y, z) = (column_of(Kind::General), first_of_displacement());
        for (i, measured) in measured.iter().enumerate() {
            let slope =
                |half: &Mat<f64>| self.weights.iter().enumerate().map(|(j, w)| half[(i, z + j)] * w).sum::<f64>();
            let [a, b] = [slope(&halves[0]), slope(&halves[1])];
            let longer = (1.0 + a * a + b * b).sqrt() - 1.0;
            for (half, tangents) in halves.iter_mut().zip(&cells.tangents) {
                half[(i, y)] += longer * dot(*measured, tangents[i]);
            }
        }
    }

    /// Rows in which the normals are free of the displacement.
    pub(super) fn without_displacement(&self, rows: &Rows) -> Rows {
        let mut out = rows.clone();
        let (y, z) = (column_of(Kind::General), first_of_displacement());
        for half in out.normals.iter_mut().flatten() {
            for i in 0..half.nrows() {
                half[(i, y)] += self.weights.iter().enumerate().map(|(j, w)| half[(i, z + j)] * w).sum::<f64>();
            }
        }
        out
    }
}
