//! Thin-plate roughness as a matrix and as rows:
//!
//! ```text
//! c'Pc = integral (S_xx^2 + 2 S_xy^2 + S_yy^2),  P = G2 (x) H0 + 2 G1 (x) H1 + G0 (x) H2,  Gk = int N^(k) N^(k)'
//! P = L'L,  L = [ B2 (x) C0; sqrt(2) B1 (x) C1; B0 (x) C2 ],  Bk = sqrt(weight) N^(k) at the points of Gauss
//! ```

use palpate_numeric::bspline::{Knots, gauss_legendre, gram};
use palpate_numeric::linalg::{StencilMatrix, TensorShape};

/// The penalty matrix P over the whole domain, from one-dimensional Gram matrices.
pub fn roughness_matrix(knots: &[Knots; 2]) -> StencilMatrix {
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

/// Roundings that an entry `P_uv` carries at most, each of the size of `sqrt(P_uu P_vv)`: three a level of both recursions, in
/// both factors of its products.
pub fn roundings(degree: [usize; 2]) -> f64 {
    6.0 * (degree[0] + degree[1]) as f64
}

/// Rows of L for [`roughness_rows`].
pub fn roughness_row_count(knots: &[Knots; 2]) -> usize {
    3 * knots.iter().map(|k| k.n_segments() * (k.degree() + 1)).product::<usize>()
}

/// The dense rows of L: a factorisation of rows keeps twice the digits that one of P itself keeps.
pub fn roughness_rows(knots: &[Knots; 2]) -> Vec<Vec<f64>> {
    let [x, y] = [0, 1].map(|axis| [0, 1, 2].map(|order| weighted_points(&knots[axis], order)));
    let mut rows = Vec::with_capacity(roughness_row_count(knots));
    for (factor, along_x, along_y) in [(1.0, &x[2], &y[0]), (2.0_f64.sqrt(), &x[1], &y[1]), (1.0, &x[0], &y[2])] {
        for n in along_x {
            rows.extend(along_y.iter().map(|m| n.iter().flat_map(|a| m.iter().map(move |b| factor * a * b)).collect()));
        }
    }
    rows
}

/// The derivatives of this order of all basis functions at the points of Gauss, each times the root of its weight.
fn weighted_points(knots: &Knots, order: usize) -> Vec<Vec<f64>> {
    let width = knots.degree() + 1;
    let (nodes, weights) = gauss_legendre(width);
    let mut values = vec![0.0; (order + 1) * width];
    let mut points = Vec::new();
    for segment in 0..knots.n_segments() {
        let [lo, hi] = knots.segment(segment);
        let half = 0.5 * (hi - lo);
        for (node, weight) in nodes.iter().zip(&weights) {
            knots.derivatives_on(segment, lo + half * (1.0 + node), order, &mut values);
            let root = (half * weight).sqrt();
            let mut point = vec![0.0; knots.n_basis()];
            let first = knots.first_basis(segment);
            point[first..first + width].iter_mut().zip(&values[order * width..]).for_each(|(p, v)| *p = root * v);
            points.push(point);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_squared_are_the_matrix() {
        for (degree, segments) in [([3, 2], [2, 3]), ([1, 4], [3, 1]), ([9, 1], [1, 1])] {
            let knots = [0, 1].map(|k| Knots::uniform(degree[k], segments[k], -1.0, 1.0).unwrap());
            let (matrix, rows) = (roughness_matrix(&knots), roughness_rows(&knots));
            assert_eq!(rows.len(), roughness_row_count(&knots));
            let unknowns = matrix.shape().unknowns();
            let largest = matrix.diagonal().iter().fold(0.0_f64, |m, v| m.max(*v));
            for u in 0..unknowns {
                let mut unit = vec![0.0; unknowns];
                unit[u] = 1.0;
                let mut column = vec![0.0; unknowns];
                matrix.multiply(&unit, &mut column);
                for (v, entry) in column.iter().enumerate() {
                    let product: f64 = rows.iter().map(|row| row[u] * row[v]).sum();
                    assert!((product - entry).abs() <= 1e-13 * largest, "({u}, {v}): {product} {entry}");
                }
            }
        }
    }
}
