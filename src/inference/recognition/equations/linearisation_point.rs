//! Where the second look places its equations: the general surface under its displacement.
//!
//! ```text
//! normals without displacement   y_n + grad f . t    so that only noise is left to scatter
//! measured normals               times |n - grad f|  rows are linear in n - grad f, and a normal has length 1
//! distance of a cell             mean d(theta; P) over its contacts P, for the moved theta
//! ```

use faer::Mat;

use crate::recognition::contacts::{CellNormals, Cells};
use crate::recognition::discrepancy::Forms;
use crate::recognition::kinds::{Kind, Model};

use super::rows::{CURVATURES, Rows, column_of, first_of_displacement};
use palpate_numeric::vector::{Vector, dot};

/// Where the general surface belongs under its displacement.
pub(crate) struct Moved {
    pub(crate) base: Model,
    /// Slopes of the displacement along both tangents of every cell; `None` where no normals are used. They are kept in place of
    /// the weights of its columns, because those belong to one chart and the moved surface has another.
    pub(crate) slopes: Option<[Vec<f64>; 2]>,
    /// Degrees of freedom that the displacement takes from the normals.
    pub(crate) spent: f64,
    /// Kernel of the errors that positions share.
    pub(crate) kernel: usize,
    /// Forms that bodies are linear about.
    pub(crate) forms: Forms,
}

impl Moved {
    /// Takes, in the rows of the general surface, the mean distance of a cell's contacts in place of the distance of their
    /// mean: the moved surface bends otherwise than the one about which the contacts were averaged.
    pub(crate) fn average(&self, rows: &mut Rows, cells: &Cells, contacts: &[Vector]) {
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
    pub(crate) fn lengthen(&self, rows: &mut Rows, cells: &Cells) {
        let (Some(halves), Some(CellNormals { measured, .. })) = (&mut rows.normals, &cells.normals) else { return };
        let Some([a, b]) = &self.slopes else { return };
        let y = column_of(Kind::General);
        for (i, measured) in measured.iter().enumerate() {
            let normal = self.base.distance_and_normal(cells.points[i]).1;
            let gradient = cells.gradient(i, normal, [a[i], b[i]]);
            let longer = (1.0 + dot(gradient, gradient)).sqrt() - 1.0;
            for (half, tangents) in halves.iter_mut().zip(&cells.tangents) {
                half[(i, y)] += longer * dot(*measured, tangents[i]);
            }
        }
    }

    /// Rows in which the normals are free of the displacement.
    pub(crate) fn without_displacement(&self, rows: &Rows) -> Rows {
        let mut out = rows.clone();
        let y = column_of(Kind::General);
        for (half, slopes) in out.normals.iter_mut().flatten().zip(self.slopes.iter().flatten()) {
            slopes.iter().enumerate().for_each(|(i, slope)| half[(i, y)] += slope);
        }
        out
    }
}

/// Slopes along both tangents of every cell of the displacement whose columns have these weights, about a general surface that has
/// moved by x. Over a plane its curvatures are displacements, too.
pub(crate) fn slopes(rows: &Rows, weights: &[f64], base: &Model, x: &[f64]) -> Option<[Vec<f64>; 2]> {
    let (z, own) = (first_of_displacement(), column_of(Kind::General) + 1);
    let bends = if base.is_flat() { CURVATURES..x.len() } else { 0..0 };
    let of = |half: &Mat<f64>| {
        let at = |i: usize| {
            let of_columns = weights.iter().enumerate().map(|(j, w)| half[(i, z + j)] * w);
            of_columns.chain(bends.clone().map(|j| half[(i, own + j)] * x[j])).sum()
        };
        (0..half.nrows()).map(at).collect::<Vec<f64>>()
    };
    rows.normals.as_ref().map(|halves| halves.each_ref().map(of))
}
