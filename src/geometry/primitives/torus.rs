//! The torus `hypot(rho - R, h) = r`.

use super::{DistanceJet, Primitive, around, from_axis, length, radial, square};
use palpate_numeric::vector::{Vector, dot};

/// A torus about the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Radius R of the circle in the tube's middle, the first size.
    pub ring: f64,
    /// Radius r of the tube, the second size.
    pub tube: f64,
}

impl Primitive for Torus {
    #[inline]
    fn distance(&self, q: Vector) -> (f64, Vector) {
        let rho = length(q[0], q[1]);
        let radial = radial(q, rho);
        let (across, up) = (rho - self.ring, q[2]);
        let length = length(across, up);
        let [c, s] = if length > 0.0 { [across / length, up / length] } else { [1.0, 0.0] };
        (length - self.tube, [c * radial[0], c * radial[1], s])
    }

    #[inline]
    fn jet(&self, q: Vector) -> DistanceJet {
        let (distance, gradient) = self.distance(q);
        let rho = from_axis(q);
        let radial = radial(q, rho);
        let length = (distance + self.tube).max(f64::MIN_POSITIVE);
        let c = dot(gradient, radial);
        let s = gradient[2];
        // along the tube's circle, and round the axis
        let tangent = [-s * radial[0], -s * radial[1], c];
        DistanceJet {
            hessian: square(|i, j| tangent[i] * tangent[j] / length + c * around(radial, i, j) / rho),
            by_size: [-c, -1.0, 0.0],
            gradient_by_size: [tangent.map(|t| s / length * t), [0.0; 3], [0.0; 3]],
            ..DistanceJet::flat((distance, gradient))
        }
    }

    #[inline]
    fn curvatures(&self, q: Vector) -> [f64; 2] {
        let (_, gradient) = self.distance(q);
        let c = dot(gradient, radial(q, from_axis(q)));
        [-1.0 / self.tube, -c / (self.ring + self.tube * c)]
    }
}
