//! Sphere of radius r: `x^2 + y^2 + z^2 + 2 r z = 0`, `k1 = k2 = -1/r`, S = 1, R = 1/r.
//!
//! `z = -d^2 / (r + sqrt(r^2 - d^2))`, `d^2 = x^2 + y^2`: only points within r of the apex's axis can be touched.

use super::geometry::Geometry;
use super::local::Local;
use super::quadric::Quadric;
use super::{Body, Surface};
use crate::scene::error::{SceneError, positive};
use palpate_numeric::vector::Vector;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Radius, input units.
    pub radius: f64,
}

impl Surface {
    /// A ball of this radius, its top at the origin: `x^2 + y^2 + z^2 + 2 r z = 0`, S = 1 and R = 1/r everywhere.
    /// Range: above zero, input units.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::Surface;
    ///
    /// assert_eq!(Surface::sphere(5.0).height(3.0, 0.0), Some(-1.0));
    /// assert_eq!(Surface::sphere(5.0).height(5.5, 0.0), None); // beside the ball
    /// ```
    pub fn sphere(radius: f64) -> Surface {
        Surface::new(Body::Sphere(Sphere { radius }), 0.0)
    }
}

impl Sphere {
    fn quadric(&self) -> Quadric {
        let k = 1.0 / self.radius;
        Quadric { alpha: k, beta: k, gamma: k }
    }
}

impl Geometry for Sphere {
    fn check(&self) -> Result<(), SceneError> {
        positive("surface.radius", self.radius)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let square = x * x + y * y;
        // r^2 - d^2 by factors: exact to rounding at the rim
        let d = square.sqrt();
        let under = (self.radius - d) * (self.radius + d);
        (under >= 0.0).then(|| -square / (self.radius + under.sqrt()))
    }

    fn local(&self, p: Vector) -> Option<Local> {
        Some(Local::known(self.quadric().normal(p), -1.0 / self.radius, -1.0 / self.radius))
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        self.quadric().hit(o, d)
    }

    fn needed(&self, x: f64, y: f64) -> Option<(&'static str, f64)> {
        Some(("radius", x.hypot(y)))
    }
}
