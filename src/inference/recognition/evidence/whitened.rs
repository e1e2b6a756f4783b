//! The rows of positions under one covariance, and what is computed of them once for all surfaces that are tried.
//!
//! ```text
//! W = L^-1 [y_1 J_1 | .. | y_5 J_5 | Z],   Sigma/s^2 = L L'        W'W where many cells see few columns, Z Z' where few see many
//! ```

use std::cell::OnceCell;

use faer::Mat;

use crate::dense;
use crate::recognition::equations::{Columns, Grams, Reduced, Rows, reduced, reduced_in_cells};
use crate::recognition::noise::Factors;
use palpate_numeric::linalg;

/// Positions under one kernel.
pub(super) struct Whitened {
    pub(super) kernel: usize,
    rows: Mat<f64>,
    /// `W'W` where some equations read it ([`dense::gram_of_groups`]).
    pub(crate) gram: Mat<f64>,
    /// Log determinant of the covariance over the variance.
    pub(super) log_det: f64,
    /// `Z Z'` of the columns that stand together, by the number of their first one; each when it is first asked for.
    products: Vec<OnceCell<Mat<f64>>>,
}

impl Whitened {
    /// `None` where the covariance is not positive definite.
    pub(crate) fn new(rows: &Rows, factors: &Factors, kernel: usize, first: usize) -> Option<Whitened> {
        let lower = factors.of(kernel)?;
        let mut whitened = rows.positions.clone();
        dense::whiten(lower, whitened.as_mut());
        let gram = dense::gram_of_groups(whitened.as_ref(), first, &rows.groups);
        let products = (0..rows.columns).map(|_| OnceCell::new()).collect();
        Some(Whitened { kernel, rows: whitened, gram, log_det: dense::log_det(lower), products })
    }

    /// The equations of the positions alone.
    pub(super) fn alone(&self, columns: Columns, variance: f64) -> Option<Reduced> {
        let (first, count) = columns.z;
        if count <= self.rows.nrows() {
            return reduced(columns, Grams { positions: &self.gram, variance, normals: None });
        }
        let rough = columns.rough.min(count);
        let products = [(first, rough), (first + rough, count - rough)].map(|part| self.product(part));
        reduced_in_cells(columns, &self.rows, variance, products)
    }

    /// `Z Z'` of these columns; `None` of none.
    fn product(&self, (first, count): (usize, usize)) -> Option<&Mat<f64>> {
        let of = || {
            let z = self.rows.as_ref().subcols(first, count);
            linalg::product(z, z.transpose())
        };
        (count > 0).then(|| self.products[first].get_or_init(of))
    }
}
