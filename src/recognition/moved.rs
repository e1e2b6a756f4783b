//! Where the second look places its equations: the general surface under its displacement.
//!
//! ```text
//! normals without displacement   y_n + Z_n w        w the displacement's weights, so that only noise is left to scatter
//! ```

use super::model::{Kind, Model};
use super::rows::{Rows, column_of, first_of_displacement};

/// Where the general surface belongs under its displacement.
pub(super) struct Moved {
    pub(super) base: Model,
    /// Weights of the displacement's columns.
    pub(super) weights: Vec<f64>,
    /// Degrees of freedom that the displacement takes from the normals.
    pub(super) spent: f64,
}

impl Moved {
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
