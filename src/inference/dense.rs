//! Small dense algebra: Cholesky factors, triangular solves, log determinants, on one thread.
//!
//! ```text
//! A = L L'        log det A = 2 sum log l_ii        whitened columns L^-1 B
//! ```

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use palpate_numeric::{linalg, work};

/// One triangular solution for so many right-hand sides.
fn count_solution(lower: &Mat<f64>, columns: usize) {
    work::add(lower.nrows().pow(2) / 2 * columns);
}

/// Lower Cholesky factor; `None` where the matrix is not positive definite.
pub(crate) fn cholesky(a: &Mat<f64>) -> Option<Mat<f64>> {
    linalg::cholesky(a.as_ref())
}

/// `log det (L L')`.
pub(crate) fn log_det(lower: &Mat<f64>) -> f64 {
    2.0 * (0..lower.nrows()).map(|i| lower[(i, i)].ln()).sum::<f64>()
}

/// `B <- L^-1 B`.
pub(crate) fn whiten(lower: &Mat<f64>, b: MatMut<'_, f64>) {
    count_solution(lower, b.ncols());
    solve_lower_triangular_in_place(lower.as_ref(), b, Par::Seq);
}

/// `A' A`.
pub(crate) fn gram(a: MatRef<'_, f64>) -> Mat<f64> {
    linalg::product(a.transpose(), a)
}

/// Those entries of `A'A` that some equations read: of the first columns with all, and of every group, first column and number, with
/// itself. The others are zero.
pub(crate) fn gram_of_groups(a: MatRef<'_, f64>, first: usize, groups: &[(usize, usize)]) -> Mat<f64> {
    let n = a.ncols();
    let mut out = Mat::<f64>::zeros(n, n);
    let mut add = |(row, rows): (usize, usize), (column, columns): (usize, usize)| {
        let part = out.as_mut().submatrix_mut(row, column, rows, columns);
        let (left, right) = (a.subcols(row, rows), a.subcols(column, columns));
        work::add(a.nrows() * rows * columns);
        matmul(part, Accum::Replace, left.transpose(), right, 1.0, Par::Seq);
    };
    add((0, n), (0, first));
    groups.iter().for_each(|&group| add(group, group));
    for j in first..n {
        (0..first).for_each(|i| out[(i, j)] = out[(j, i)]);
    }
    out
}

/// `(L L')^-1 b`.
pub(crate) fn solve(lower: &Mat<f64>, b: &mut [f64]) {
    forward(lower, b);
    backward(lower, b);
}

/// `L^-1 b`.
pub(crate) fn forward(lower: &Mat<f64>, b: &mut [f64]) {
    count_solution(lower, 1);
    for i in 0..b.len() {
        let dot: f64 = (0..i).map(|j| lower[(i, j)] * b[j]).sum();
        b[i] = (b[i] - dot) / lower[(i, i)];
    }
}

/// `L'^-1 b`.
pub(crate) fn backward(lower: &Mat<f64>, b: &mut [f64]) {
    count_solution(lower, 1);
    for i in (0..b.len()).rev() {
        let dot: f64 = lower.col_as_slice(i)[i + 1..].iter().zip(&b[i + 1..]).map(|(l, b)| l * b).sum();
        b[i] = (b[i] - dot) / lower[(i, i)];
    }
}

/// `B <- L'^-1 B`: columns of gaussians of unit variance made gaussians of covariance `(L L')^-1`.
pub(crate) fn coloured(lower: &Mat<f64>, b: MatMut<'_, f64>) {
    count_solution(lower, b.ncols());
    solve_upper_triangular_in_place(lower.transpose(), b, Par::Seq);
}

/// `L^-1 b` by columns, which stand together in memory.
pub(crate) fn forward_in_columns(lower: &Mat<f64>, b: &mut [f64]) {
    count_solution(lower, 1);
    for j in 0..b.len() {
        let (done, rest) = b.split_at_mut(j + 1);
        done[j] /= lower[(j, j)];
        let by = done[j];
        rest.iter_mut().zip(&lower.col_as_slice(j)[j + 1..]).for_each(|(b, l)| *b -= by * l);
    }
}
