//! Linear algebra of a handful of unknowns: Cholesky's factorisation and Jacobi's rotations on arrays of a fixed order.
//!
//! ```text
//! A = L L'        A = V diag(w) V', w ascending, columns of V orthonormal        A of order N
//! ```
//!
//! G. H. Golub and C. F. Van Loan, *Matrix Computations*, sections 4.2 and 8.5. A segmentation factors a hundred thousand of
//! them, most of order 7: with nalgebra's `SMatrix` factor and solution take 195 ns in place of 128 and the inverse 332 in
//! place of 274, and every bit of an answer would move.

/// A square matrix of order N.
pub type Square<const N: usize> = [[f64; N]; N];

/// A symmetric matrix has no Cholesky factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is not positive definite")]
pub struct NotPositiveDefinite;

/// Largest number of sweeps over all pairs; six suffice for order 7.
const SWEEPS: usize = 30;

/// The lower factor of a positive definite matrix; `None` where it is not.
pub fn cholesky<const N: usize>(matrix: &Square<N>) -> Option<Square<N>> {
    let mut lower = [[0.0; N]; N];
    for j in 0..N {
        let diagonal = matrix[j][j] - (0..j).map(|k| lower[j][k] * lower[j][k]).sum::<f64>();
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return None;
        }
        lower[j][j] = diagonal.sqrt();
        for i in j + 1..N {
            let sum: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            lower[i][j] = (matrix[i][j] - sum) / lower[j][j];
        }
    }
    Some(lower)
}

/// `x` of `L x = b`.
pub fn forward<const N: usize>(lower: &Square<N>, mut b: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let sum: f64 = (0..i).map(|k| lower[i][k] * b[k]).sum();
        b[i] = (b[i] - sum) / lower[i][i];
    }
    b
}

/// `x` of `L L' x = b`.
pub fn solve<const N: usize>(lower: &Square<N>, b: [f64; N]) -> [f64; N] {
    let mut b = forward(lower, b);
    for i in (0..N).rev() {
        let sum: f64 = (i + 1..N).map(|k| lower[k][i] * b[k]).sum();
        b[i] = (b[i] - sum) / lower[i][i];
    }
    b
}

/// The inverse of `L L'`: that of L first, then `(L^-1)' L^-1`.
pub fn inverse<const N: usize>(lower: &Square<N>) -> Square<N> {
    // row i of L^-1 holds its columns 0 to i
    let mut upper = [[0.0; N]; N];
    for i in 0..N {
        let over = 1.0 / lower[i][i];
        let mut row = [0.0; N];
        for k in 0..i {
            let factor = lower[i][k];
            (0..=k).for_each(|j| row[j] -= factor * upper[k][j]);
        }
        (0..i).for_each(|j| row[j] *= over);
        row[i] = over;
        upper[i] = row;
    }
    let mut inverse = [[0.0; N]; N];
    for row in &upper {
        for i in 0..N {
            let factor = row[i];
            (0..=i).for_each(|j| inverse[i][j] += factor * row[j]);
        }
    }
    for i in 0..N {
        (0..i).for_each(|j| inverse[j][i] = inverse[i][j]);
    }
    inverse
}

/// Solves the leading `p` equations of a symmetric system given by its lower triangle; `None` unless positive definite.
pub fn solve_leading<const N: usize>(mut a: Square<N>, mut b: [f64; N], p: usize) -> Option<[f64; N]> {
    for i in 0..p {
        for j in 0..=i {
            let mut value = a[i][j];
            (0..j).for_each(|k| value -= a[i][k] * a[j][k]);
            if i == j {
                if value.is_nan() || value <= 0.0 {
                    return None;
                }
                a[i][i] = value.sqrt();
            } else {
                a[i][j] = value / a[j][j];
            }
        }
    }
    for i in 0..p {
        (0..i).for_each(|j| b[i] -= a[i][j] * b[j]);
        b[i] /= a[i][i];
    }
    for i in (0..p).rev() {
        (i + 1..p).for_each(|j| b[i] -= a[j][i] * b[j]);
        b[i] /= a[i][i];
    }
    Some(b)
}

/// Eigenvalues, ascending, and the eigenvector of each of them.
pub fn eigen<const N: usize>(matrix: &Square<N>) -> ([f64; N], [[f64; N]; N]) {
    let mut a = *matrix;
    let mut v = [[0.0; N]; N];
    (0..N).for_each(|i| v[i][i] = 1.0);
    for _ in 0..SWEEPS {
        let off: f64 = (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j] * a[i][j]).sum();
        let whole: f64 = a.iter().flatten().map(|x| x * x).sum();
        if off <= 1e-32 * whole {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut v, p, q);
            }
        }
    }
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    order.sort_by(|i, j| a[*i][*i].total_cmp(&a[*j][*j]));
    (order.map(|i| a[i][i]), order.map(|i| std::array::from_fn(|row| v[row][i])))
}

/// Makes `a[p][q]` zero by a rotation in the plane of p and q.
fn rotate<const N: usize>(a: &mut Square<N>, v: &mut Square<N>, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let t = if theta == 0.0 { 1.0 } else { t };
    let cos = 1.0 / t.hypot(1.0);
    let sin = t * cos;
    for k in 0..N {
        let (x, y) = (a[k][p], a[k][q]);
        (a[k][p], a[k][q]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for k in 0..N {
        let (x, y) = (a[p][k], a[q][k]);
        (a[p][k], a[q][k]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for row in v.iter_mut() {
        let (x, y) = (row[p], row[q]);
        (row[p], row[q]) = (cos * x - sin * y, sin * x + cos * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: Square<3> = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 5.0]];

    #[test]
    fn the_factor_solves_and_inverts() {
        let lower = cholesky(&MATRIX).unwrap();
        let x = solve(&lower, [1.0, 2.0, 3.0]);
        let inverse = inverse(&lower);
        for i in 0..3 {
            let back: f64 = (0..3).map(|k| MATRIX[i][k] * x[k]).sum();
            assert!((back - (i + 1) as f64).abs() < 1e-14);
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| MATRIX[i][k] * inverse[k][j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!(cholesky(&[[1.0, 2.0], [2.0, 1.0]]).is_none());
    }

    #[test]
    fn eigenvectors_are_orthonormal_and_make_the_matrix_again() {
        let (w, v) = eigen(&MATRIX);
        assert!(w[0] <= w[1] && w[1] <= w[2]);
        for i in 0..3 {
            for j in 0..3 {
                let back: f64 = (0..3).map(|k| w[k] * v[k][i] * v[k][j]).sum();
                assert!((back - MATRIX[i][j]).abs() < 1e-13);
                let product: f64 = (0..3).map(|k| v[i][k] * v[j][k]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
    }
}
