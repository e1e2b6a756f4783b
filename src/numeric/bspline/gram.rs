//! Gram matrices of derivatives, `G_ij = integral over the domain of N_i^(k) N_j^(k)`, by Gauss quadrature, exact.

use super::{Knots, MAX_DEGREE};

/// Lower bands of the Gram matrix of the `order`-th derivatives: `bands[i][d] = G(i, i - d)`, d = 0 to p.
///
/// Gauss-Legendre with p + 1 points on every segment integrates degree 2p exactly.
pub fn gram(knots: &Knots, order: usize) -> Vec<Vec<f64>> {
    let p = knots.degree();
    let (nodes, weights) = gauss_legendre(p + 1);
    let mut bands = vec![vec![0.0; p + 1]; knots.n_basis()];
    let mut rows = vec![0.0; (order + 1) * (p + 1)];
    for segment in 0..knots.n_segments() {
        let [lo, hi] = knots.segment(segment);
        let half = 0.5 * (hi - lo);
        let first = knots.first_basis(segment);
        for (node, weight) in nodes.iter().zip(&weights) {
            knots.derivatives_on(segment, lo + half * (1.0 + node), order, &mut rows);
            let top = &rows[order * (p + 1)..];
            for a in 0..=p {
                for b in 0..=a {
                    bands[first + a][a - b] += half * weight * top[a] * top[b];
                }
            }
        }
    }
    bands
}

/// Gauss-Legendre nodes and weights on [-1, 1], at most 10, by Newton's method on the Legendre recurrence.
pub fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    debug_assert!(n <= MAX_DEGREE + 1);
    let mut nodes = vec![0.0; n];
    let mut weights = vec![0.0; n];
    for i in 0..n {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        // quadratic convergence from a good start: 8 steps reach the last bit for n <= 10
        for _ in 0..8 {
            let (mut before, mut now) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * now - before) / (x * x - 1.0);
            x -= now / slope;
        }
        nodes[i] = x;
        weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    (nodes, weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_sums_to_the_length_and_curvature_of_a_parabola_is_exact() {
        let knots = Knots::uniform(3, 4, -1.0, 2.0).unwrap();
        let form = |bands: &Vec<Vec<f64>>, c: &[f64]| -> f64 {
            let mut sum = 0.0;
            for i in 0..c.len() {
                for d in 0..bands[i].len().min(i + 1) {
                    sum += if d == 0 { 1.0 } else { 2.0 } * bands[i][d] * c[i] * c[i - d];
                }
            }
            sum
        };
        assert!((form(&gram(&knots, 0), &[1.0; 7]) - 3.0).abs() < 1e-14);
        // the spline with Greville coefficients is x, so its slope's square integrates to the length
        assert!((form(&gram(&knots, 1), &knots.greville()) - 3.0).abs() < 1e-13);
        assert!(form(&gram(&knots, 2), &knots.greville()).abs() < 1e-12);
    }
}
