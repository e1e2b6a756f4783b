//! The cone `(rho - r) cos(alpha) = h sin(alpha)`.

use super::{DistanceJet, Primitive, around, from_axis, length, radial, square};
use palpate_numeric::vector::Vector;

/// A cone about the axis, which opens upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Radius at the origin, the first size.
    pub radius: f64,
    /// Angle alpha between axis and surface, the second size.
    pub half_angle: f64,
}

impl Primitive for Cone {
    #[inline]
    fn distance(&self, q: Vector) -> (f64, Vector) {
        let rho = length(q[0], q[1]);
        let radial = radial(q, rho);
        let (sin, cos) = self.half_angle.sin_cos();
        ((rho - self.radius) * cos - q[2] * sin, [cos * radial[0], cos * radial[1], -sin])
    }

    #[inline]
    fn jet(&self, q: Vector) -> DistanceJet {
        let rho = from_axis(q);
        let radial = radial(q, rho);
        let (sin, cos) = self.half_angle.sin_cos();
        DistanceJet {
            hessian: square(|i, j| cos * around(radial, i, j) / rho),
            by_size: [-cos, -(rho - self.radius) * sin - q[2] * cos, 0.0],
            gradient_by_size: [[0.0; 3], [-sin * radial[0], -sin * radial[1], -cos], [0.0; 3]],
            ..DistanceJet::flat(self.distance(q))
        }
    }

    #[inline]
    fn curvatures(&self, q: Vector) -> [f64; 2] {
        let (distance, _) = self.distance(q);
        let cos = self.half_angle.cos();
        [0.0, -cos / (from_axis(q) - distance * cos).abs().max(f64::MIN_POSITIVE)]
    }
}
