//! How far a surface naturally departs from two constant curvatures: by its third and fourth derivatives.
//!
//! ```text
//! f(u, v) = sum_(a+b = 3, 4) z_ab s_ab u^a v^b / (a! b!)          z ~ N(0, natural_departure^2), nine of them
//! s_ab = R^2 / sqrt(binom(3, a))                                  third degree
//! s_ab = 3 R^3 / sqrt(binom(4, a))                                fourth degree
//! ```
//!
//! But for planes, spheres and cylinders no surface has two constant curvatures. (B. O'Neill, *Elementary Differential
//! Geometry*, 2nd ed., 2006, section 6.) A form whose radius is 1/R has features of about that size, so its derivatives of
//! order n are near R^(n - 1): a sphere has 3 R^3 in fourth order, and a parabola none. Such a departure moves mean R by one
//! or two per cent where it is too small to show in the residuals of few contacts. An interval that takes the curvatures for
//! constant then misses the truth. The binomials make the prior the same in every direction. Forms that are less round depart by
//! more: the flat end of an ellipsoid whose half axes are a and c has (a/c)^2 times a sphere's fourth derivative. The prior
//! of the interval is therefore `Tuning::natural_departure` times as wide as that size.

use faer::Mat;
use statrs::function::factorial::factorial;

use crate::recognition::kinds::ConstantCurvature;
use palpate_numeric::bspline::Knots;

/// Degree of the splines that hold the departure exactly.
const DEGREE: usize = 4;

/// Fourth derivative of a sphere, in units of R^3.
const FOURTH: f64 = 3.0;

/// Powers of u and v.
pub(crate) const TERMS: [[usize; 2]; 9] = [[3, 0], [2, 1], [1, 2], [0, 3], [4, 0], [3, 1], [2, 2], [1, 3], [0, 4]];

/// Spline coefficients of the nine departures about the middle of the chart, each with its prior standard deviation of so many natural sizes.
pub(crate) fn columns(knots: &[Knots; 2], surface: &ConstantCurvature, sizes: f64) -> Mat<f64> {
    let powers = knots.each_ref().map(|knots| {
        let t = knots.as_slice();
        let middle = 0.5 * (t[0] + t[t.len() - 1]);
        let one = |i: usize| powers_of(&t[i + 1..=i + DEGREE], middle);
        (0..knots.n_basis()).map(one).collect::<Vec<_>>()
    });
    let across = knots[1].n_basis();
    Mat::from_fn(knots[0].n_basis() * across, TERMS.len(), |row, j| {
        let [a, b] = TERMS[j];
        sizes * size(surface, [a, b]) * powers[0][row / across][a] * powers[1][row % across][b]
    })
}

/// Natural size of the coefficient of u^a v^b.
pub(crate) fn size(surface: &ConstantCurvature, [a, b]: [usize; 2]) -> f64 {
    let [_, _, _, k1, k2, _] = surface.theta;
    let r = (0.5 * (k1 * k1 + k2 * k2)).sqrt();
    let derivative = if a + b == 3 { r.powi(2) } else { FOURTH * r.powi(3) };
    derivative / ([a + b, a, b].map(|n| factorial(n as u64)).iter().product::<f64>()).sqrt()
}

/// Coefficients of 1, t, .., t^4 about `middle`: the mean products of the knots inside a basis function's support
/// (Marsden's identity; C. de Boor, *A Practical Guide to Splines*, 2001, chapter IX).
fn powers_of(knots: &[f64], middle: f64) -> [f64; DEGREE + 1] {
    const SUBSETS: [f64; DEGREE + 1] = [1.0, 4.0, 6.0, 4.0, 1.0];
    let mut sums = [0.0; DEGREE + 1];
    sums[0] = 1.0;
    for (k, knot) in knots.iter().enumerate() {
        (1..=k + 1).rev().for_each(|j| sums[j] += (knot - middle) * sums[j - 1]);
    }
    std::array::from_fn(|j| sums[j] / SUBSETS[j])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_the_monomials_of_third_and_fourth_degree_with_their_prior() {
        let knots = [Knots::uniform(DEGREE, 5, -1.0, 1.4).unwrap(), Knots::uniform(DEGREE, 5, -0.8, 0.8).unwrap()];
        let surface = ConstantCurvature::new([0.0, 0.0, 0.0, 0.5, -0.3, 0.0]);
        let r = (0.5 * (0.25 + 0.09_f64)).sqrt();
        let found = columns(&knots, &surface, 2.0);
        let (u, v) = (0.9, -0.35);
        let value = |j: usize| {
            let mut values = [[0.0; DEGREE + 1]; 2];
            let first = [0, 1].map(|side| knots[side].derivatives([u, v][side], 0, &mut values[side]));
            let term = |a: usize, b: usize| {
                values[0][a] * values[1][b] * found[((first[0] + a) * knots[1].n_basis() + first[1] + b, j)]
            };
            (0..=DEGREE).flat_map(|a| (0..=DEGREE).map(move |b| (a, b))).map(|(a, b)| term(a, b)).sum::<f64>()
        };
        let u = u - 0.2; // the middle of the first side
        let expected = [
            2.0 * r * r * u.powi(3) / 6.0,
            2.0 * r * r * u * u * v / (2.0 * 3_f64.sqrt()),
            6.0 * r.powi(3) * u * u * v * v / (4.0 * 6_f64.sqrt()),
            6.0 * r.powi(3) * v.powi(4) / 24.0,
        ];
        for (j, expected) in [0, 1, 6, 8].into_iter().zip(expected) {
            assert!((value(j) - expected).abs() < 1e-14, "{j}: {} {expected}", value(j));
        }
    }
}
