//! Normal rows: `|n - n^(S_x, S_y)|^2 / sigma^2`, linearised about the current surface (one Gauss-Newton step).
//!
//! ```text
//! n^ = (-p, -q, 1)/w,  w = sqrt(1 + p^2 + q^2),  J = dn^/d(p, q),  J'J = [1 + q^2, -p q; -p q, 1 + p^2] / w^4 = U'U
//! U = [a b; 0 d],  a = sqrt(1 + q^2)/w^2,  b = -p q/(w^2 sqrt(1 + q^2)),  d = 1/(w sqrt(1 + q^2))
//! rows:  U (S_x, S_y) = U (p, q) + U'^-1 J'n           (J' n^ = 0, so J'(n - n^) = J'n)
//! ```
//!
//! The weights are taken from the fitted surface, because weights from the measured normals would bias the slopes. Nothing
//! is divided by nz.

use palpate_numeric::linalg::SiteWeights;

/// Unweighted rows at the current slopes `(p, q)`: the triangle U and its two targets.
#[inline]
pub fn linearise_normals(normal: [f64; 3], p: f64, q: f64) -> (SiteWeights, [f64; 2]) {
    let w2 = 1.0 + p * p + q * q;
    let w = w2.sqrt();
    let l2 = 1.0 + q * q;
    let l = l2.sqrt();
    let (a, b, d) = (l / w2, -p * q / (w2 * l), 1.0 / (w * l));
    let w3 = w2 * w;
    // J'n: columns of J are n^_p = (-(1 + q^2), p q, -p)/w^3 and n^_q = (p q, -(1 + p^2), -q)/w^3
    let along = (-l2 * normal[0] + p * q * normal[1] - p * normal[2]) / w3;
    let across = (p * q * normal[0] - (1.0 + p * p) * normal[1] - q * normal[2]) / w3;
    let first = along / a;
    let second = (across - b * first) / d;
    (SiteWeights { z: 0.0, a, b, d }, [a * p + b * q + first, d * q + second])
}

/// What Gauss-Newton leaves out of the second derivative of half the squared chord, seen from the triangle U of
/// [`linearise_normals`]: `U'^-1 (J'J + n . d2n^) U^-1`, as `[first, mixed, second]`. Zero where the normals agree.
///
/// ```text
/// n . d2n^ / d(i, j) = (n_i p_j + n_j p_i - (n.v) [i = j] + 3 (n.v) p_i p_j / w^2) / w^3        v = (-p, -q, 1)
/// ```
#[inline]
pub fn normal_curving(normal: [f64; 3], p: f64, q: f64, u: &SiteWeights) -> [f64; 3] {
    let w2 = 1.0 + p * p + q * q;
    let w3 = w2 * w2.sqrt();
    let [nx, ny, nz] = normal;
    let along = nz - nx * p - ny * q;
    let xx = u.a * u.a + (2.0 * nx * p - along + 3.0 * along * p * p / w2) / w3;
    let xy = u.a * u.b + (nx * q + ny * p + 3.0 * along * p * q / w2) / w3;
    let yy = u.b * u.b + u.d * u.d + (2.0 * ny * q - along + 3.0 * along * q * q / w2) / w3;
    let shear = u.b / u.a;
    [xx / (u.a * u.a), (xy - shear * xx) / (u.a * u.d), (yy - shear * (2.0 * xy - shear * xx)) / (u.d * u.d)]
}

/// `|n - n^(p, q)|^2`: the squared chord between a measured and a fitted normal.
#[inline]
pub fn angular_residual_squared(normal: [f64; 3], p: f64, q: f64) -> f64 {
    let w = (1.0 + p * p + q * q).sqrt();
    let d = [normal[0] + p / w, normal[1] + q / w, normal[2] - 1.0 / w];
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quadratic model of the rows must have the true objective's gradient at the current slopes.
    #[test]
    fn gradient_is_that_of_the_true_objective() {
        for (normal, p, q) in [([0.6, 0.0, 0.8], 0.3, -0.5), ([1.0, 0.0, 0.0], -4.0, 2.0), ([0.0, -0.6, 0.8], 0.0, 0.0)]
        {
            let (u, target) = linearise_normals(normal, p, q);
            let first = u.a * p + u.b * q - target[0];
            let second = u.d * q - target[1];
            let model = [2.0 * u.a * first, 2.0 * (u.b * first + u.d * second)];
            let h = 1e-6;
            let f = |p, q| angular_residual_squared(normal, p, q);
            let exact = [(f(p + h, q) - f(p - h, q)) / (2.0 * h), (f(p, q + h) - f(p, q - h)) / (2.0 * h)];
            assert!((model[0] - exact[0]).abs() < 1e-9 && (model[1] - exact[1]).abs() < 1e-9);
        }
    }

    /// J'J less the second derivatives of half the squared chord, by differences of the gradient.
    #[test]
    fn curving_is_what_the_steps_leave_out() {
        for (normal, p, q) in
            [([0.6, 0.0, 0.8], 0.3, -0.5), ([0.48, -0.6, 0.64], -4.0, 2.0), ([0.0, -0.6, 0.8], 0.0, 0.0)]
        {
            let (u, _) = linearise_normals(normal, p, q);
            let [k11, k12, k22] = normal_curving(normal, p, q, &u);
            let left_out = [
                u.a * u.a * k11,
                u.a * (u.b * k11 + u.d * k12),
                u.b * u.b * k11 + 2.0 * u.b * u.d * k12 + u.d * u.d * k22,
            ];
            let squares = [u.a * u.a, u.a * u.b, u.b * u.b + u.d * u.d];
            let gradient = |p: f64, q: f64| {
                let (u, target) = linearise_normals(normal, p, q);
                let (first, second) = (u.a * p + u.b * q - target[0], u.d * q - target[1]);
                [u.a * first, u.b * first + u.d * second]
            };
            let h = 1e-5;
            let along = [0, 1].map(|k| (gradient(p + h, q)[k] - gradient(p - h, q)[k]) / (2.0 * h));
            let across = (gradient(p, q + h)[1] - gradient(p, q - h)[1]) / (2.0 * h);
            for (k, second) in [along[0], along[1], across].into_iter().enumerate() {
                assert!(
                    (squares[k] - second - left_out[k]).abs() < 1e-9,
                    "{k}: {} for {}",
                    squares[k] - second,
                    left_out[k]
                );
            }
        }
        let w = (1.0_f64 + 0.3 * 0.3 + 0.5 * 0.5).sqrt();
        let agreeing = [-0.3 / w, 0.5 / w, 1.0 / w];
        let (u, _) = linearise_normals(agreeing, 0.3, -0.5);
        assert!(normal_curving(agreeing, 0.3, -0.5, &u).iter().all(|k| k.abs() < 1e-14));
    }
}
