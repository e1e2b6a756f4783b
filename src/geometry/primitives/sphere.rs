//! The sphere `|q| = r`.

use super::{DistanceJet, Primitive, square};
use palpate_numeric::vector::{Vector, norm};

/// A sphere about the origin; its radius is the first size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Radius.
    pub radius: f64,
}

impl Primitive for Sphere {
    #[inline]
    fn distance(&self, q: Vector) -> (f64, Vector) {
        let length = norm(q);
        (length - self.radius, if length > 0.0 { q.map(|v| v / length) } else { [0.0, 0.0, 1.0] })
    }

    #[inline]
    fn jet(&self, q: Vector) -> DistanceJet {
        let (distance, gradient) = self.distance(q);
        let length = (distance + self.radius).max(f64::MIN_POSITIVE);
        let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
        DistanceJet {
            hessian: square(|i, j| (identity(i, j) - gradient[i] * gradient[j]) / length),
            by_size: [-1.0, 0.0, 0.0],
            ..DistanceJet::flat((distance, gradient))
        }
    }

    #[inline]
    fn curvatures(&self, _: Vector) -> [f64; 2] {
        [-1.0 / self.radius, -1.0 / self.radius]
    }
}
