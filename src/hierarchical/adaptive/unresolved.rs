//! What is smaller than the smallest cells: how far a spline of degree p is off the surface that it is fitted to, noise apart.
//!
//! ```text
//! d^m (f - S)/dx^m = - h^(p+1-m) f^(p+1) B_(p+1-m)(t) / (p+1-m)! + ..          t place in the cell, h its side, B Bernoulli's polynomials
//! root mean square over t   h^(2-m) |D| sqrt(|B_2n| / (2n)!),  n = p + 1 - m,   D = h^(p-1) f^(p+1) = difference of order p - 1 of S_xx
//! ```
//!
//! The first line is the leading term of least squares (S. Zhou, X. Shen, D. Wolfe, *Ann. Stat.* 26 (1998) 1760). Cells end where heights no longer tell what is left from noise, and what is left bends the
//! surface all the same: near features its share of the uncertainty of R is as large as that of noise. The difference is taken over cells
//! of the place's own size; noise in it adds a hundredth to a variance.

use crate::field::HierarchicalField;
use palpate_numeric::bspline::Knots;

/// `sqrt(|B_2n| / (2n)!)`, B Bernoulli's numbers, n from 1 on.
const MEAN_ERRORS: [f64; 6] = [
    0.288_675_134_594_812_9,
    0.037_267_799_624_996_49,
    5.750_546_332_745_624e-3,
    9.092_412_093_166_139e-4,
    1.444_909_580_246_797e-4,
    2.298_720_398_476_574e-5,
];

/// Binomial coefficients with their signs: differences of order 1 to 4.
const DIFFERENCES: [&[f64]; 4] =
    [&[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0], &[1.0, -4.0, 6.0, -4.0, 1.0]];

/// Variance of a functional by what the cells at a place do not resolve, from the weights of the six numbers of a point.
pub(super) fn unresolved_variance(field: &HierarchicalField, place: [f64; 2], weights: [f64; 6]) -> f64 {
    let space = field.space();
    let leaf = space.leaf_at(place);
    let cell = space.leaves()[leaf];
    // of z, of the slope and of the second derivative along x and along y
    let along = [[weights[0], weights[1], weights[3]], [weights[0], weights[2], weights[5]]];
    let variance = |axis: usize| {
        let knots = space.knots_of(leaf)[axis];
        let [lo, hi] = knots.segment(cell.place[axis] as usize);
        let Some(difference) = difference(field, knots, place, axis, hi - lo) else { return 0.0 };
        let terms = along[axis].iter().enumerate().map(|(order, weight)| {
            // one of them counts as a rule: those of R and S are of second order
            let n = knots.degree() + 1 - order;
            (weight * (hi - lo).powi(2 - order as i32) * MEAN_ERRORS[n - 1] * difference).powi(2)
        });
        terms.sum::<f64>()
    };
    variance(0) + variance(1)
}

/// The difference of order p - 1 of the second derivative along an axis, over steps of one cell; `None` where the domain is too short.
fn difference(field: &HierarchicalField, knots: &Knots, place: [f64; 2], axis: usize, step: f64) -> Option<f64> {
    let coefficients = DIFFERENCES.get(knots.degree().checked_sub(2)?)?;
    let [lo, hi] = knots.domain();
    let reach = step * (coefficients.len() - 1) as f64;
    if reach > hi - lo {
        return None;
    }
    let first = (place[axis] - 0.5 * reach).clamp(lo, hi - reach);
    let term = |(k, coefficient): (usize, &f64)| {
        let mut at = place;
        at[axis] = first + step * k as f64;
        let here = field.at(at[0], at[1]);
        coefficient * if axis == 0 { here.zxx } else { here.zyy }
    };
    Some(coefficients.iter().enumerate().map(term).sum())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::mesh::Mesh;
    use crate::space::HierarchicalSpace;

    /// The spline of degree p that is nearest to a monomial of degree p + 1 is off by exactly the first line.
    #[test]
    fn of_a_monomial_it_is_the_error_of_the_spline() {
        for degree in [3, 5] {
            let knots = || Knots::uniform(degree, 20, -1.0, 1.0).unwrap();
            let space = Arc::new(HierarchicalSpace::new(Mesh::new([knots(), knots()]).unwrap()));
            let power = degree as i32 + 1;
            // coefficients of least squares along x, found on a fine grid; the same for every y
            let along = nearest(&knots(), |x| x.powi(power));
            let high = knots().n_basis();
            let coefficients = along.iter().flat_map(|c| std::iter::repeat_n(*c, high)).collect();
            let field = HierarchicalField::new(space, coefficients).unwrap();
            let (mut squares, mut told, count) = (0.0, 0.0, 400);
            for k in 0..count {
                let x = -0.2 + 0.4 * (f64::from(k) + 0.5) / f64::from(count);
                let exact = f64::from(power * (power - 1)) * x.powi(power - 2);
                squares += (field.at(x, 0.1).zxx - exact).powi(2);
                told += unresolved_variance(&field, [x, 0.1], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
            }
            assert!((told / squares - 1.0).abs() < 0.02, "degree {degree}: {told} for {squares}");
        }
    }

    /// Coefficients of the spline of least squares, by conjugate gradients on the normal equations.
    fn nearest(knots: &Knots, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let n = knots.n_basis();
        let rows: Vec<_> =
            (0..4000).map(|k| -1.0 + (f64::from(k) + 0.5) / 2000.0).map(|x| (knots.basis(x), f(x))).collect();
        let normal = |c: &[f64], out: &mut [f64]| {
            out.fill(0.0);
            for (row, _) in &rows {
                let b = row.derivative(0);
                let value: f64 = b.iter().zip(&c[row.first..]).map(|(b, c)| b * c).sum();
                b.iter().enumerate().for_each(|(a, b)| out[row.first + a] += b * value);
            }
        };
        let mut load = vec![0.0; n];
        for (row, z) in &rows {
            row.derivative(0).iter().enumerate().for_each(|(a, b)| load[row.first + a] += b * z);
        }
        let limits = palpate_numeric::linalg::GradientLimits { tolerance: 1e-14, steps: 2000 };
        palpate_numeric::linalg::conjugate_gradients(normal, |_| (), &load, limits).0
    }
}
