//! Fast diagonalisation of a complete grid's normal matrix, and conjugate gradients preconditioned with it.
//!
//! ```text
//! A = wz^2 Ax (x) Ay + wx^2 Dx (x) Ay + wy^2 Ax (x) Dy          Ax = N'N, Dx = N''N', and the same in y
//! U'Ax U = 1, U'Dx U = diag(s);  V'Ay V = 1, V'Dy V = diag(t)
//! A^-1 = (U (x) V) diag(1/(wz^2 + wx^2 s_i + wy^2 t_j)) (U (x) V)'
//! ```
//!
//! Direct and exact for one weight per block and no roughness (R. Lynch, J. Rice, D. Thomas, Numer. Math. 6, 1964).
//! Missing pixels, weight maps and roughness change A a little: then it preconditions.

use faer::{Mat, Side};

use super::SolveError;
use crate::linalg::{StencilMatrix, inverse_norm1_estimate};

/// Conjugate gradients stop when the preconditioned residual is this share of the first: past it, rounding wanders.
const CG_TOLERANCE: f64 = 1e-15;
/// With a preconditioner of the right structure tens of steps are usual; a thousand means it has the wrong one.
const CG_STEPS: usize = 1000;

/// Lower bands of a symmetric matrix: `bands[i][d] = A(i, i - d)`.
pub type Bands = Vec<Vec<f64>>;

/// The two Gram matrices of one axis.
#[derive(Clone, Debug)]
pub struct AxisGrams {
    /// Of the values.
    pub values: Bands,
    /// Of the slopes.
    pub slopes: Bands,
}

/// Eigenvectors of both axes and the reciprocal eigenvalues of their Kronecker sum.
#[derive(Clone, Debug)]
pub struct FastDiagonalisation {
    vectors: [Mat<f64>; 2],
    inverse: Mat<f64>,
}

impl FastDiagonalisation {
    /// From the axes' Grams and the squared block weights `[wz^2, wx^2, wy^2]`.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`] when an axis leaves a basis function without data.
    pub fn new(axes: [&AxisGrams; 2], squared: [f64; 3]) -> Result<FastDiagonalisation, SolveError> {
        let (u, s) = generalised_eigen(axes[0])?;
        let (v, t) = generalised_eigen(axes[1])?;
        let inverse = Mat::from_fn(s.len(), t.len(), |i, j| 1.0 / (squared[0] + squared[1] * s[i] + squared[2] * t[j]));
        for j in 0..t.len() {
            if let Some(i) = (0..s.len()).find(|&i| !inverse[(i, j)].is_finite() || inverse[(i, j)] <= 0.0) {
                return Err(SolveError::NotPositiveDefinite { unknown: i * t.len() + j });
            }
        }
        Ok(FastDiagonalisation { vectors: [u, v], inverse })
    }

    /// `v <- A^-1 v`, unknown `(i, j)` at `i m + j`.
    pub fn solve(&self, v: &mut [f64]) {
        let [ux, uy] = &self.vectors;
        let columns = uy.nrows();
        let rhs = Mat::from_fn(ux.nrows(), columns, |i, j| v[i * columns + j]);
        let mut spectral = ux.transpose() * &rhs * uy;
        for j in 0..columns {
            for i in 0..ux.nrows() {
                spectral[(i, j)] *= self.inverse[(i, j)];
            }
        }
        let solution = ux * &spectral * uy.transpose();
        for i in 0..ux.nrows() {
            for j in 0..columns {
                v[i * columns + j] = solution[(i, j)];
            }
        }
    }
}

/// `U, s` with `U'AU = 1`, `U'DU = diag(s)`: Cholesky of A, reduce, symmetric eigenproblem.
fn generalised_eigen(axis: &AxisGrams) -> Result<(Mat<f64>, Vec<f64>), SolveError> {
    let order = axis.values.len();
    let dense =
        |bands: &Bands| Mat::from_fn(order, order, |i, j| bands[i.max(j)].get(i.abs_diff(j)).copied().unwrap_or(0.0));
    let lower = cholesky(dense(&axis.values))?;
    let mut reduced = dense(&axis.slopes);
    solve_lower(&lower, &mut reduced);
    reduced = reduced.transpose().to_owned();
    solve_lower(&lower, &mut reduced);
    let eigen = reduced.self_adjoint_eigen(Side::Lower).map_err(|_| SolveError::NotPositiveDefinite { unknown: 0 })?;
    let mut vectors = eigen.U().to_owned();
    solve_lower_transposed(&lower, &mut vectors);
    // the Gram of slopes is semidefinite: a negative eigenvalue is rounding
    Ok((vectors, (0..order).map(|k| eigen.S()[k].max(0.0)).collect()))
}

fn cholesky(mut a: Mat<f64>) -> Result<Mat<f64>, SolveError> {
    let order = a.nrows();
    for j in 0..order {
        let pivot = a[(j, j)] - (0..j).map(|k| a[(j, k)] * a[(j, k)]).sum::<f64>();
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(SolveError::NotPositiveDefinite { unknown: j });
        }
        a[(j, j)] = pivot.sqrt();
        for i in j + 1..order {
            let dot: f64 = (0..j).map(|k| a[(i, k)] * a[(j, k)]).sum();
            a[(i, j)] = (a[(i, j)] - dot) / a[(j, j)];
            a[(j, i)] = 0.0;
        }
    }
    Ok(a)
}

fn solve_lower(lower: &Mat<f64>, b: &mut Mat<f64>) {
    for c in 0..b.ncols() {
        for i in 0..lower.nrows() {
            let dot: f64 = (0..i).map(|k| lower[(i, k)] * b[(k, c)]).sum();
            b[(i, c)] = (b[(i, c)] - dot) / lower[(i, i)];
        }
    }
}

fn solve_lower_transposed(lower: &Mat<f64>, b: &mut Mat<f64>) {
    for c in 0..b.ncols() {
        for i in (0..lower.nrows()).rev() {
            let dot: f64 = (i + 1..lower.nrows()).map(|k| lower[(k, i)] * b[(k, c)]).sum();
            b[(i, c)] = (b[(i, c)] - dot) / lower[(i, i)];
        }
    }
}

/// A normal matrix solved through fast diagonalisation: directly, or by conjugate gradients where it only resembles it.
#[derive(Clone, Debug)]
pub struct GridSolver {
    matrix: StencilMatrix,
    diagonalisation: FastDiagonalisation,
    iterative: bool,
}

impl GridSolver {
    /// `matrix` is exactly what `diagonalisation` inverts.
    pub fn direct(matrix: StencilMatrix, diagonalisation: FastDiagonalisation) -> GridSolver {
        GridSolver { matrix, diagonalisation, iterative: false }
    }

    /// `matrix` is close to what `diagonalisation` inverts.
    pub fn iterative(matrix: StencilMatrix, diagonalisation: FastDiagonalisation) -> GridSolver {
        GridSolver { matrix, diagonalisation, iterative: true }
    }

    /// `v <- A^-1 v`; the number of iterations (0: direct).
    pub fn solve(&self, v: &mut [f64]) -> usize {
        if !self.iterative {
            self.diagonalisation.solve(v);
            return 0;
        }
        let (solution, iterations) = self.conjugate_gradients(v);
        v.copy_from_slice(&solution);
        iterations
    }

    /// Condition of the equilibrated rows: root of the 1-norm estimate of `D A D`.
    pub fn condition(&self) -> f64 {
        let scale: Vec<f64> = self.matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
        let solve = |v: &mut [f64]| {
            v.iter_mut().zip(&scale).for_each(|(w, d)| *w /= d);
            self.solve(v);
            v.iter_mut().zip(&scale).for_each(|(w, d)| *w /= d);
        };
        (self.matrix.norm1_scaled(&scale) * inverse_norm1_estimate(scale.len(), solve, solve)).sqrt()
    }

    fn conjugate_gradients(&self, rhs: &[f64]) -> (Vec<f64>, usize) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let mut x = vec![0.0; rhs.len()];
        let mut r = rhs.to_vec();
        let mut z = r.clone();
        self.diagonalisation.solve(&mut z);
        let mut direction = z.clone();
        let mut image = vec![0.0; rhs.len()];
        let mut rz = dot(&r, &z);
        let first = rz;
        for step in 1..=CG_STEPS {
            if rz <= CG_TOLERANCE * CG_TOLERANCE * first {
                return (x, step - 1);
            }
            self.matrix.multiply(&direction, &mut image);
            let alpha = rz / dot(&direction, &image);
            for k in 0..x.len() {
                x[k] += alpha * direction[k];
                r[k] -= alpha * image[k];
            }
            z.copy_from_slice(&r);
            self.diagonalisation.solve(&mut z);
            let next = dot(&r, &z);
            let beta = next / rz;
            direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + beta * *d);
            rz = next;
        }
        (x, CG_STEPS)
    }
}
