//! The plane `z = 0`, tilted by its pose. `k1 = k2 = 0`, S undefined, R = 0.

use super::geometry::Geometry;
use super::local::Local;
use super::quadric::Quadric;
use super::{Body, Surface};
use crate::scene::error::SceneError;
use crate::scene::rotation::UP;
use palpate_numeric::vector::Vector;

const QUADRIC: Quadric = Quadric { alpha: 0.0, beta: 0.0, gamma: 0.0 };

/// The plane `z = 0`, which has no size.
pub(super) struct Plane;

impl Surface {
    /// The plane `z = 0`: both curvatures zero, S undefined.
    pub fn plane() -> Surface {
        Surface::new(Body::Plane, 0.0)
    }
}

impl Geometry for Plane {
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    fn height(&self, _x: f64, _y: f64) -> Option<f64> {
        Some(0.0)
    }

    fn local(&self, _p: Vector) -> Option<Local> {
        Some(Local::known(UP, 0.0, 0.0))
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        QUADRIC.hit(o, d)
    }
}
