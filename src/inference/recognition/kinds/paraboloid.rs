//! The second reference of the general hypothesis: a height field of second degree over the frame's tangent plane.
//!
//! ```text
//! q(x, y) = c0 + c1 x + c2 y + (A x^2 + 2 B x y + C y^2)/2         theta = (c0, c1, c2, A, C, B)
//! d = (z - q)/sqrt(1 + |grad q|^2)                                  distance to first order in d
//! ```
//!
//! In the middle it has the curvatures of a torus patch, and it departs from that in the fourth order. Where the two
//! answer differently, the answer depends on a form that nobody knows, and the interval takes in both.

use palpate_geometry::curvature::Derivatives;
use palpate_numeric::vector::Vector;

/// A paraboloid with the parameters above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Paraboloid {
    pub(crate) theta: [f64; 6],
}

impl Paraboloid {
    /// Height and its two slopes.
    pub(crate) fn height(&self, x: f64, y: f64) -> [f64; 3] {
        let [c0, c1, c2, a, c, b] = self.theta;
        [c0 + c1 * x + c2 * y + 0.5 * (a * x * x + c * y * y) + b * x * y, c1 + a * x + b * y, c2 + b * x + c * y]
    }

    pub(crate) fn distance_and_normal(&self, p: Vector) -> (f64, Vector) {
        let [q, qx, qy] = self.height(p[0], p[1]);
        let length = (1.0 + qx * qx + qy * qy).sqrt();
        ((p[2] - q) / length, [-qx / length, -qy / length, 1.0 / length])
    }

    pub(super) fn distance_by_theta(&self, p: Vector) -> (f64, [f64; 6]) {
        let [x, y, z] = p;
        let [q, qx, qy] = self.height(x, y);
        let squared = 1.0 + qx * qx + qy * qy;
        let length = squared.sqrt();
        let d = (z - q) / length;
        let columns = [
            [1.0, 0.0, 0.0],
            [x, 1.0, 0.0],
            [y, 0.0, 1.0],
            [0.5 * x * x, x, 0.0],
            [0.5 * y * y, 0.0, y],
            [x * y, y, x],
        ];
        (d, columns.map(|[f, fx, fy]| -f / length - d * (qx * fx + qy * fy) / squared))
    }

    /// Derivatives of `(x, y, q(x, y))`.
    pub(crate) fn derivatives(&self, x: f64, y: f64) -> Derivatives {
        let [_, qx, qy] = self.height(x, y);
        let [_, _, _, a, c, b] = self.theta;
        Derivatives::of_height(qx, qy, a, b, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let theta = [0.1, 0.2, -0.15, 0.7, -0.3, 0.4];
        for x in [[0.3, -0.2, 0.15], [-0.8, 0.5, 0.2]] {
            let (_, by) = Paraboloid { theta }.distance_by_theta(x);
            for i in 0..6 {
                let at = |e: f64| {
                    let mut moved = theta;
                    moved[i] += e;
                    Paraboloid { theta: moved }.distance_and_normal(x).0
                };
                assert!((by[i] - (at(1e-5) - at(-1e-5)) / 2e-5).abs() < 1e-9, "parameter {i}");
            }
        }
    }
}
