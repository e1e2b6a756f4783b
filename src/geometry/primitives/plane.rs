//! The plane `q3 = 0`.

use super::{DistanceJet, Primitive};
use palpate_numeric::vector::Vector;

/// A plane across the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane;

impl Primitive for Plane {
    #[inline]
    fn distance(&self, q: Vector) -> (f64, Vector) {
        (q[2], [0.0, 0.0, 1.0])
    }

    #[inline]
    fn jet(&self, q: Vector) -> DistanceJet {
        DistanceJet::flat(self.distance(q))
    }

    #[inline]
    fn curvatures(&self, _: Vector) -> [f64; 2] {
        [0.0, 0.0]
    }
}
