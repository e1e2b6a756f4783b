//! The parts of a smooth departure that a body has which was turned about the normal in the middle of the patch.
//!
//! ```text
//! r, theta           distance from the axis and angle about it, in units of the kernel's length
//! order 0            mean over turns of e^-|p - q|^2/2 = e^-(r^2 + s^2)/2 I_0(r s)             = sum_k a_k(p) a_k(q)
//! order 1            2 e^-(r^2 + s^2)/2 I_1(r s) cos(theta_p - theta_q)                        = sum_k b_k(p).b_k(q)
//! a_k = e^-h h^k / k!      b_k = e^-h h^k (x, y) / sqrt(k! (k + 1)!)      h = r^2/2
//! ```
//!
//! A kernel that depends on the distance of two places alone is a sum over angular orders, each a process of its own. Order 0 is turned
//! about the middle, and order 1 moves the middle to first order. I_0 and I_1 by their series (M. Abramowitz, I. Stegun, *Handbook of
//! Mathematical Functions*, 9.6.10). The circles are those in space, which the chart of a curved surface distorts.

use faer::Mat;
use statrs::function::factorial::factorial;

use crate::recognition::kinds::ConstantCurvature;
use palpate_numeric::bspline::Knots;
use palpate_numeric::vector::{cross, dot, minus, reject, unit};

/// Terms of either order; more change nothing at lengths of at least a half side of the patch.
const TERMS: usize = 6;

/// Step along the chart that shows the direction of its first coordinate.
const STEP_OF_DIRECTION: f64 = 1e-3;

/// Values of every term at the sites of u (rows) and v (columns) of the splines.
pub(super) fn values(surface: &ConstantCurvature, knots: &[Knots; 2], length: f64) -> Vec<Mat<f64>> {
    let [us, vs] = knots.each_ref().map(Knots::greville);
    let [u, v] = knots.each_ref().map(Knots::domain).map(|[lo, hi]| 0.5 * (lo + hi));
    let middle = surface.point(u, v, 0.0);
    let normal = surface.distance_and_normal(middle).1;
    let first = unit(reject(minus(surface.point(u + STEP_OF_DIRECTION, v, 0.0), middle), normal));
    let axes = [first, cross(normal, first)];
    let place = |i: usize, j: usize| {
        let away = minus(surface.point(us[i], vs[j], 0.0), middle);
        axes.map(|axis| dot(away, axis) / length)
    };
    let places: Vec<Vec<[f64; 2]>> = (0..us.len()).map(|i| (0..vs.len()).map(|j| place(i, j)).collect()).collect();
    let of = |term: fn(usize, [f64; 2]) -> f64, k| Mat::from_fn(us.len(), vs.len(), |i, j| term(k, places[i][j]));
    (0..TERMS).flat_map(|k| [of(even, k), of(along_x, k), of(along_y, k)]).collect()
}

/// a_k at a place.
fn even(k: usize, [x, y]: [f64; 2]) -> f64 {
    let h = 0.5 * (x * x + y * y);
    (-h).exp() * h.powi(k as i32) / factorial(k as u64)
}

/// First part of b_k at a place.
fn along_x(k: usize, place: [f64; 2]) -> f64 {
    even(k, place) * place[0] / ((k + 1) as f64).sqrt()
}

/// Second part of b_k.
fn along_y(k: usize, place: [f64; 2]) -> f64 {
    even(k, place) * place[1] / ((k + 1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_the_kernel_s_parts_of_angular_order_0_and_1() {
        let (p, q) = ([0.9, -0.4], [-0.3, 0.8]);
        let turned = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let [x, y] = [cos * q[0] - sin * q[1], sin * q[0] + cos * q[1]];
            (-0.5 * ((p[0] - x).powi(2) + (p[1] - y).powi(2))).exp()
        };
        let turns = 64;
        let angles = (0..turns).map(|i| 2.0 * std::f64::consts::PI * i as f64 / turns as f64);
        let (order_0, order_1) = angles.fold((0.0, 0.0), |(zero, one), angle| {
            let share = turned(angle) / turns as f64;
            (zero + share, one + 2.0 * share * angle.cos())
        });
        let sum = |term: fn(usize, [f64; 2]) -> f64| (0..12).map(|k| term(k, p) * term(k, q)).sum::<f64>();
        assert!((sum(even) - order_0).abs() < 1e-14);
        assert!((sum(along_x) + sum(along_y) - order_1).abs() < 1e-14, "{order_1}");
    }
}
