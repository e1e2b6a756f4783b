//! Thin-plate roughness as a matrix and as rows:
//!
//! ```text
//! c'Pc = integral (S_xx^2 + 2 S_xy^2 + S_yy^2),  P = G2 (x) H0 + 2 G1 (x) H1 + G0 (x) H2,  Gk = int N^(k) N^(k)'
//! ```

use crate::bspline::{Knots, gram};
use crate::linalg::{StencilMatrix, TensorShape};

/// The penalty matrix P over the whole domain, from one-dimensional Gram matrices.
pub(crate) fn roughness_matrix(knots: &[Knots; 2]) -> StencilMatrix {
    let shape =
        TensorShape { basis: [knots[0].n_basis(), knots[1].n_basis()], degree: [knots[0].degree(), knots[1].degree()] };
    let x = [0, 1, 2].map(|k| gram(&knots[0], k));
    let y = [0, 1, 2].map(|k| gram(&knots[1], k));
    let mut matrix = StencilMatrix::zeros(shape);
    matrix.add_kronecker(1.0, &x[2], &y[0]);
    matrix.add_kronecker(2.0, &x[1], &y[1]);
    matrix.add_kronecker(1.0, &x[0], &y[2]);
    matrix
}
