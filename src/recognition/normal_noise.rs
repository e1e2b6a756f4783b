//! The covariance of normals' tangential errors, found once under the general surface and kept.
//!
//! ```text
//! Sigma_n = s_n^2 (D_n + rho exp(-r/l)) for either tangential part; rho, l by restricted likelihood over the grid
//! ```

use faer::Mat;

use super::cells::Cells;
use super::dense;
use super::model::Kind;
use super::noise::Kernel;
use super::rows::{Rows, column_of};

/// The covariance found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormalNoise {
    kernel: Kernel,
    /// Variance of an average cell's independent error.
    pub(super) variance: f64,
}

impl NormalNoise {
    /// By restricted likelihood; `None` without normals or where no covariance can be factored.
    pub(super) fn find(rows: &Rows, cells: &Cells, distances: &Mat<f64>) -> Option<NormalNoise> {
        let n = cells.points.len();
        let p = Kind::General.unknowns() - 1;
        let own = (column_of(Kind::General), 1 + Kind::General.unknowns());
        let mut best: Option<(f64, NormalNoise)> = None;
        for kernel in Kernel::all() {
            let Some((gram, log_det)) = whitened(rows, cells, distances, kernel, own) else { continue };
            // the height h does not move normals: its column, the first, is left out
            let Some(jj) = dense::cholesky(&Mat::from_fn(p, p, |i, j| gram[(2 + i, 2 + j)])) else { continue };
            let mut along: Vec<f64> = (0..p).map(|i| gram[(2 + i, 0)]).collect();
            dense::forward(&jj, &mut along);
            let rss = (gram[(0, 0)] - along.iter().map(|v| v * v).sum::<f64>()).max(1e-24);
            let dof = (2 * n).saturating_sub(p).max(1) as f64;
            let likelihood = -0.5 * (log_det + dense::log_det(&jj) + dof * (rss / dof).ln()) + kernel.log_prior;
            if best.is_none_or(|(largest, _)| likelihood > largest) {
                best = Some((likelihood, NormalNoise { kernel, variance: rss / dof }));
            }
        }
        best.map(|(_, found)| found)
    }

    /// Gram matrix of the whitened normal rows.
    pub(super) fn gram(&self, rows: &Rows, cells: &Cells, distances: &Mat<f64>) -> Option<Mat<f64>> {
        let (mut gram, _) = whitened(rows, cells, distances, self.kernel, (0, rows.columns))?;
        for j in 0..gram.ncols() {
            (0..gram.nrows()).for_each(|i| gram[(i, j)] /= self.variance);
        }
        Some(gram)
    }
}

/// Gram matrix of some columns (first, count) under `D + rho exp(-r/l)` and the log determinant of both parts' covariance.
fn whitened(
    rows: &Rows,
    cells: &Cells,
    distances: &Mat<f64>,
    kernel: Kernel,
    columns: (usize, usize),
) -> Option<(Mat<f64>, f64)> {
    let halves = rows.normals.as_ref()?;
    let lower = kernel.factor(&cells.normals.as_ref()?.variance, distances)?;
    let mut sum = Mat::<f64>::zeros(columns.1, columns.1);
    for half in halves {
        let mut whitened = half.as_ref().subcols(columns.0, columns.1).to_owned();
        dense::whiten(&lower, whitened.as_mut());
        sum += dense::gram(whitened.as_ref());
    }
    Some((sum, 2.0 * dense::log_det(&lower)))
}
