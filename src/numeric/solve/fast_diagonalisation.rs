//! Direct solution for a complete grid with one weight for each block, by two small eigenproblems.
//!
//! ```text
//! A = wz^2 X (x) Y + wx^2 X' (x) Y + wy^2 X (x) Y'      X = N'N, X' = D'D, Y = M'M, Y' = F'F  (Grams of values, slopes)
//! X' u = lambda X u,  U'X U = 1       Y' v = mu Y v,  V'Y V = 1
//! C = U [ (U' R V) / (wz^2 + wx^2 lambda_i + wy^2 mu_j) ] V'
//! ```
//!
//! R. E. Lynch, J. R. Rice, D. H. Thomas, *Direct solution of partial difference equations by tensor product methods*,
//! Numer. Math. 6 (1964). It does not apply with roughness, weight maps or missing pixels, whose matrices
//! have other eigenvectors.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::linalg::{Eigen, cholesky, eigen};
use crate::work;

use super::SolveError;

/// Eigenvectors and divisors for one pair of axes and one set of weights; reusable buffers.
#[derive(Clone, Debug)]
pub struct FastDiagonalisation {
    u: Mat<f64>,
    v: Mat<f64>,
    /// `1 / (wz^2 + wx^2 lambda_i + wy^2 mu_j)`, row-major.
    inverse: Vec<f64>,
    half: Mat<f64>,
    middle: Mat<f64>,
}

/// Lower bands to a full symmetric matrix.
fn full(bands: &[Vec<f64>]) -> Mat<f64> {
    let n = bands.len();
    let mut out = Mat::zeros(n, n);
    for (i, row) in bands.iter().enumerate() {
        for (d, value) in row.iter().enumerate().take(i + 1) {
            out[(i, i - d)] = *value;
            out[(i - d, i)] = *value;
        }
    }
    out
}

/// `slopes u = lambda values u` with `U' values U = 1`; numbers, vectors, and the log determinant of `values`.
fn generalised(values: &[Vec<f64>], slopes: &[Vec<f64>]) -> Result<(Vec<f64>, Mat<f64>, f64), SolveError> {
    let broken = SolveError::NotPositiveDefinite { unknown: 0 };
    let gram = full(values);
    let lower = cholesky(gram.as_ref()).ok_or(broken.clone())?;
    let log_det = 2.0 * (0..gram.nrows()).map(|i| lower[(i, i)].ln()).sum::<f64>();
    // three triangular solutions; factor and eigenproblem count themselves
    work::add(3 * gram.nrows().pow(3) / 2);
    let mut reduced = full(slopes);
    solve_lower_triangular_in_place(lower.as_ref(), reduced.as_mut(), Par::Seq);
    let mut reduced = reduced.transpose().to_owned();
    solve_lower_triangular_in_place(lower.as_ref(), reduced.as_mut(), Par::Seq);
    let Eigen { values, mut vectors } = eigen(reduced.as_ref()).ok_or(broken)?;
    solve_upper_triangular_in_place(lower.transpose(), vectors.as_mut(), Par::Seq);
    // the matrix is positive semidefinite, but rounding may make an eigenvalue -1e-17
    let values = values.into_iter().map(|l| l.max(0.0)).collect();
    Ok((values, vectors, log_det))
}

/// Two symmetric matrices A and B in one basis: `V'(A + B)V = 1`, `V'A V = diag(lambda)`.
#[derive(Debug)]
pub struct Simultaneous {
    /// How much of each direction belongs to A, 0 to 1.
    pub lambda: Vec<f64>,
    /// The columns of V.
    pub columns: Vec<Vec<f64>>,
    /// `log det (A + B)`, which the factor of A + B gives for nothing.
    pub log_det: f64,
}

/// The common basis of A and B, from the lower bands of A + B and of A.
///
/// # Errors
/// [`SolveError::NotPositiveDefinite`] where A + B is not.
pub fn simultaneous(both: &[Vec<f64>], one: &[Vec<f64>]) -> Result<Simultaneous, SolveError> {
    let (lambda, vectors, log_det) = generalised(both, one)?;
    let columns = (0..vectors.ncols()).map(|k| vectors.col(k).iter().copied().collect()).collect();
    Ok(Simultaneous { lambda, columns, log_det })
}

impl FastDiagonalisation {
    /// From the lower bands of the Grams of values and slopes along x and along y, and the block weights.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`] where an axis has too few points for its knots.
    pub fn new(x: [&[Vec<f64>]; 2], y: [&[Vec<f64>]; 2], weights: [f64; 3]) -> Result<FastDiagonalisation, SolveError> {
        let (lambda, u, _) = generalised(x[0], x[1])?;
        let (mu, v, _) = generalised(y[0], y[1])?;
        let [z, a, b] = weights.map(|w| w * w);
        let mut inverse = Vec::with_capacity(lambda.len() * mu.len());
        for l in &lambda {
            inverse.extend(mu.iter().map(|m| 1.0 / (z + a * l + b * m)));
        }
        if let Some(unknown) = inverse.iter().position(|w| !w.is_finite()) {
            return Err(SolveError::NotPositiveDefinite { unknown });
        }
        let (n, m) = (lambda.len(), mu.len());
        Ok(FastDiagonalisation { u, v, inverse, half: Mat::zeros(n, m), middle: Mat::zeros(n, m) })
    }

    /// `R -> C` in place, row-major n x m.
    pub fn solve(&mut self, right: &mut [f64]) {
        let (n, m) = (self.u.nrows(), self.v.nrows());
        work::add(2 * n * m * (n + m));
        let r = MatRef::from_row_major_slice(&*right, n, m);
        matmul(self.half.as_mut(), Accum::Replace, self.u.transpose(), r, 1.0, Par::Seq);
        matmul(self.middle.as_mut(), Accum::Replace, self.half.as_ref(), self.v.as_ref(), 1.0, Par::Seq);
        for j in 0..m {
            for i in 0..n {
                self.middle[(i, j)] *= self.inverse[i * m + j];
            }
        }
        matmul(self.half.as_mut(), Accum::Replace, self.u.as_ref(), self.middle.as_ref(), 1.0, Par::Seq);
        let out = MatMut::from_row_major_slice_mut(right, n, m);
        matmul(out, Accum::Replace, self.half.as_ref(), self.v.transpose(), 1.0, Par::Seq);
    }
}
