//! Cylinder of radius r with its generators along the body's x axis: `y^2 + z^2 + 2 r z = 0`.
//!
//! `k1 = 0, k2 = -1/r`, S = 1/2, R = 1/(r sqrt 2). `z = -y^2 / (r + sqrt(r^2 - y^2))`. The scene's `axis_deg` rotates
//! the generators from +x towards +y.

use super::geometry::Geometry;
use super::local::Local;
use super::quadric::Quadric;
use super::{Body, Surface};
use crate::scene::error::{SceneError, positive};
use palpate_numeric::vector::Vector;

/// An endless round bar.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cylinder {
    /// Radius, input units.
    pub radius: f64,
}

impl Surface {
    /// An endless round bar of this radius along x, its top line through the origin: `y^2 + z^2 + 2 r z = 0`, S = 1/2 and
    /// R = 1/(r sqrt 2) everywhere. Range: above zero, input units.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::Surface;
    ///
    /// let bar_along_y = Surface::cylinder(5.0).turned(90.0);
    /// assert_eq!(bar_along_y.height(3.0, 100.0), Some(-1.0));
    /// ```
    pub fn cylinder(radius: f64) -> Surface {
        Surface::new(Body::Cylinder(Cylinder { radius }), 0.0)
    }
}

impl Cylinder {
    fn quadric(&self) -> Quadric {
        let k = 1.0 / self.radius;
        Quadric { alpha: 0.0, beta: k, gamma: k }
    }
}

impl Geometry for Cylinder {
    fn check(&self) -> Result<(), SceneError> {
        positive("surface.radius", self.radius)
    }

    fn height(&self, _x: f64, y: f64) -> Option<f64> {
        let under = (self.radius - y) * (self.radius + y);
        (under >= 0.0).then(|| -y * y / (self.radius + under.sqrt()))
    }

    fn local(&self, p: Vector) -> Option<Local> {
        Some(Local::known(self.quadric().normal(p), 0.0, -1.0 / self.radius))
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        self.quadric().hit(o, d)
    }

    fn around(&self, x: f64, angle: f64) -> Option<Vector> {
        let half = (0.5 * angle).sin();
        Some([x, self.radius * angle.sin(), -2.0 * self.radius * half * half])
    }

    fn nearest(&self, p: Vector) -> Option<[f64; 2]> {
        Some([p[0], p[1].atan2(p[2] + self.radius)])
    }

    fn needed(&self, _x: f64, y: f64) -> Option<(&'static str, f64)> {
        Some(("radius", y.abs()))
    }
}
