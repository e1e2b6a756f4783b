//! Dense products and factorisations of faer on one thread, so that no bit of a result depends on how many threads there are.
//!
//! ```text
//! C = A B        A = L L'        A = U diag(values) U', values ascending
//! ```
//!
//! faer's methods (`a * b`, `a.llt(..)`, `a.self_adjoint_eigen(..)`) take as many threads as there are for larger matrices. Of
//! the three only the eigenproblem was seen to move a bit by it; the other two are here because nothing says that they never will.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::simd::{Isa, factor_dense};
use crate::work;

/// Order up to which a factor stays in the cache whole, so that faer's blocks gain nothing over their calls.
const SMALL: usize = 100;

/// Eigenvalues in ascending order, and eigenvectors as columns.
#[derive(Debug)]
pub struct Eigen {
    pub values: Vec<f64>,
    pub vectors: Mat<f64>,
}

/// `A B`.
pub fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    work::add(a.nrows() * a.ncols() * b.ncols());
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(out.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

/// L of the symmetric matrix whose lower triangle is given; `None` where it is not positive definite.
pub fn cholesky(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    work::add(a.nrows().pow(3) / 6);
    if a.nrows() <= SMALL { small_cholesky(a) } else { large_cholesky(a) }
}

/// By the kernel of small dense matrices.
fn small_cholesky(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let stride = n.next_multiple_of(8);
    let mut columns = vec![0.0; n * stride];
    for (j, column) in columns.chunks_exact_mut(stride.max(1)).enumerate() {
        column[j..n].iter_mut().enumerate().for_each(|(i, v)| *v = a[(j + i, j)]);
    }
    factor_dense(Isa::active(), n, stride, &mut columns).ok()?;
    Some(Mat::from_fn(n, n, |i, j| if i < j { 0.0 } else { columns[j * stride + i] }))
}

fn large_cholesky(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let mut lower = a.to_owned();
    let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default()));
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(lower.as_mut(), Default::default(), Par::Seq, stack, Default::default()).ok()?;
    for j in 1..n {
        lower.col_mut(j).subrows_mut(0, j).fill(0.0);
    }
    Some(lower)
}

/// Eigenvalues and eigenvectors of the symmetric matrix whose lower triangle is given; `None` where they are not found.
pub fn eigen(a: MatRef<'_, f64>) -> Option<Eigen> {
    let n = a.nrows();
    work::add(9 * n.pow(3) / 2);
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let scratch = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    self_adjoint_evd(a, values.as_mut(), Some(vectors.as_mut()), Par::Seq, stack, Default::default()).ok()?;
    Some(Eigen { values: values.column_vector().iter().copied().collect(), vectors })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_give_the_matrix_back() {
        let n = 120;
        let any = Mat::from_fn(n, n, |i, j| ((i * 37 + j * 61 + i * j) as f64).sin());
        let a = product(any.as_ref(), any.transpose());
        let near = |b: Mat<f64>| (0..n).all(|i| (0..n).all(|j| (a[(i, j)] - b[(i, j)]).abs() < 1e-10 * n as f64));
        let lower = cholesky(a.as_ref()).unwrap();
        assert!((0..n).all(|j| (0..j).all(|i| lower[(i, j)] == 0.0)));
        assert!(near(product(lower.as_ref(), lower.transpose())));
        let Eigen { values, vectors } = eigen(a.as_ref()).unwrap();
        assert!(values.is_sorted());
        let scaled = Mat::from_fn(n, n, |i, j| vectors[(i, j)] * values[j]);
        assert!(near(product(scaled.as_ref(), vectors.transpose())));
        assert!(cholesky(Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i != j))).as_ref()).is_none());
    }
}
