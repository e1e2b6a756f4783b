//! The cylinder `rho = r`.

use super::{DistanceJet, Primitive, around, from_axis, length, radial, square};
use palpate_numeric::vector::Vector;

/// A cylinder about the axis; its radius is the first size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius.
    pub radius: f64,
}

impl Primitive for Cylinder {
    #[inline]
    fn distance(&self, q: Vector) -> (f64, Vector) {
        let rho = length(q[0], q[1]);
        (rho - self.radius, radial(q, rho))
    }

    #[inline]
    fn jet(&self, q: Vector) -> DistanceJet {
        let rho = from_axis(q);
        let radial = radial(q, rho);
        DistanceJet {
            hessian: square(|i, j| around(radial, i, j) / rho),
            by_size: [-1.0, 0.0, 0.0],
            ..DistanceJet::flat(self.distance(q))
        }
    }

    #[inline]
    fn curvatures(&self, _: Vector) -> [f64; 2] {
        [0.0, -1.0 / self.radius]
    }
}
