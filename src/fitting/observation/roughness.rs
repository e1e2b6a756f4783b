//! Thin-plate roughness as a matrix and as rows:
//!
//! ```text
//! second   c'Pc = integral (S_xx^2 + 2 S_xy^2 + S_yy^2)                     third   integral (S_xxx^2 + 3 S_xxy^2 + 3 S_xyy^2 + S_yyy^2)
//! P = sum_k (m over k) G_(m-k) (x) H_k,  Gk = int N^(k) N^(k)'              m = 2, 3
//! P = L'L,  L = [ sqrt(m over k) B_(m-k) (x) C_k ],  Bk = sqrt(weight) N^(k) at the points of Gauss
//! stretched  a^3 S_xxx^2 + a S_xxy^2 + S_xyy^2 / a + S_yyy^2 / a^3          each derivative once, bends a times as long along x as along y
//! ```
//!
//! What costs nothing is a plane, or a surface of second degree, whose curvatures are left as they are. P. Green and B. Silverman,
//! *Nonparametric Regression and Generalized Linear Models* (1994), section 7.9.

use palpate_numeric::bspline::{Knots, gauss_legendre, gram};
use palpate_numeric::linalg::{StencilMatrix, TensorShape};

/// Which derivatives a penalty squares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoughnessOrder {
    /// Second ones: planes cost nothing.
    Second,
    /// Third ones: surfaces of second degree cost nothing.
    Third,
}

impl RoughnessOrder {
    /// The highest that splines of these degrees have: below degree 3 the third derivative is zero between knots.
    pub fn of_degrees(degree: [usize; 2]) -> RoughnessOrder {
        if degree[0].min(degree[1]) >= 3 { RoughnessOrder::Third } else { RoughnessOrder::Second }
    }

    /// Independent surfaces that cost nothing.
    pub fn null_dimension(self) -> usize {
        match self {
            RoughnessOrder::Second => 3,
            RoughnessOrder::Third => 6,
        }
    }

    /// Derivatives by x and by y of every term, with its binomial coefficient.
    pub fn terms(self) -> &'static [(f64, usize, usize)] {
        match self {
            RoughnessOrder::Second => &[(1.0, 2, 0), (2.0, 1, 1), (1.0, 0, 2)],
            RoughnessOrder::Third => &[(1.0, 3, 0), (3.0, 2, 1), (3.0, 1, 2), (1.0, 0, 3)],
        }
    }

    /// The same, each derivative once, over x divided and y multiplied by the root of `aspect`.
    pub fn stretched_terms(self, aspect: f64) -> Vec<(f64, usize, usize)> {
        self.terms().iter().map(|&(_, by_x, by_y)| (stretch(aspect, by_x, by_y), by_x, by_y)).collect()
    }

    /// Their derivatives by the logarithm of `aspect`.
    pub fn slopes_by_aspect(self, aspect: f64) -> Vec<(f64, usize, usize)> {
        let slope = |&(_, by_x, by_y): &(f64, usize, usize)| {
            ((by_x as f64 - by_y as f64) * stretch(aspect, by_x, by_y), by_x, by_y)
        };
        self.terms().iter().map(slope).collect()
    }
}

/// `aspect^(by_x - by_y)`, by products: the same digits wherever it is computed.
fn stretch(aspect: f64, by_x: usize, by_y: usize) -> f64 {
    let power: f64 = (0..by_x.abs_diff(by_y)).map(|_| aspect).product();
    if by_x >= by_y { power } else { 1.0 / power }
}

/// `lambda c'Pc`, added to the sum of squares.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// Its weight.
    pub lambda: f64,
    /// P.
    pub penalty: StencilMatrix,
    /// Which derivatives P squares.
    pub order: RoughnessOrder,
    /// The factor of every term, with its derivatives by x and by y.
    pub terms: Vec<(f64, usize, usize)>,
}

impl Roughness {
    /// Alike in all directions, over the whole domain of the knots.
    pub fn new(lambda: f64, knots: &[Knots; 2], order: RoughnessOrder) -> Roughness {
        Roughness { lambda, penalty: roughness_matrix(knots, order.terms()), order, terms: order.terms().to_vec() }
    }

    /// Where bends are `aspect` times as long along x as along y.
    pub fn stretched(lambda: f64, knots: &[Knots; 2], order: RoughnessOrder, aspect: f64) -> Roughness {
        let terms = order.stretched_terms(aspect);
        Roughness { lambda, penalty: roughness_matrix(knots, &terms), order, terms }
    }

    /// The same with another weight.
    pub fn weighing(&self, lambda: f64) -> Roughness {
        Roughness { lambda, ..self.clone() }
    }
}

/// The penalty matrix P over the whole domain, from one-dimensional Gram matrices.
pub fn roughness_matrix(knots: &[Knots; 2], terms: &[(f64, usize, usize)]) -> StencilMatrix {
    let shape =
        TensorShape { basis: [knots[0].n_basis(), knots[1].n_basis()], degree: [knots[0].degree(), knots[1].degree()] };
    let mut matrix = StencilMatrix::zeros(shape);
    for (factor, by_x, by_y) in terms {
        matrix.add_kronecker(*factor, &gram(&knots[0], *by_x), &gram(&knots[1], *by_y));
    }
    matrix
}

/// Roundings that an entry `P_uv` carries at most, each of the size of `sqrt(P_uu P_vv)`: three a level of both recursions, in
/// both factors of its products.
pub fn roundings(degree: [usize; 2]) -> f64 {
    6.0 * (degree[0] + degree[1]) as f64
}

/// Rows of L for [`roughness_rows`].
pub fn roughness_row_count(knots: &[Knots; 2], terms: &[(f64, usize, usize)]) -> usize {
    terms.len() * knots.iter().map(|k| k.n_segments() * (k.degree() + 1)).product::<usize>()
}

/// The dense rows of L: a factorisation of rows keeps twice the digits that one of P itself keeps.
pub fn roughness_rows(knots: &[Knots; 2], terms: &[(f64, usize, usize)]) -> Vec<Vec<f64>> {
    let mut rows = Vec::with_capacity(roughness_row_count(knots, terms));
    for (square, by_x, by_y) in terms {
        let (factor, along_y) = (square.sqrt(), weighted_points(&knots[1], *by_y));
        for n in &weighted_points(&knots[0], *by_x) {
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
        let (second, third) = (RoughnessOrder::Second.terms(), RoughnessOrder::Third.terms());
        let stretched = &RoughnessOrder::Third.stretched_terms(2.5);
        for (degree, segments, terms) in [
            ([3, 2], [2, 3], second),
            ([1, 4], [3, 1], second),
            ([9, 1], [1, 1], second),
            ([3, 3], [2, 3], third),
            ([4, 5], [3, 1], third),
            ([3, 4], [2, 2], stretched),
        ] {
            let knots = [0, 1].map(|k| Knots::uniform(degree[k], segments[k], -1.0, 1.0).unwrap());
            let (matrix, rows) = (roughness_matrix(&knots, terms), roughness_rows(&knots, terms));
            assert_eq!(rows.len(), roughness_row_count(&knots, terms));
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
