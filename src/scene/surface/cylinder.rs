//! Cylinder of radius r with its generators along the body's x axis: `y^2 + z^2 + 2 r z = 0`.
//!
//! `k1 = 0, k2 = -1/r`, S = 1/2, R = 1/(r sqrt 2). `z = -y^2 / (r + sqrt(r^2 - y^2))`. The scene's `axis_deg` turns
//! the generators from +x towards +y.

use super::local::Local;
use super::quadric::Quadric;
use crate::scene::vector::Vector;

/// An endless round bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius, input units.
    pub radius: f64,
}

impl Cylinder {
    pub(crate) fn quadric(&self) -> Quadric {
        let k = 1.0 / self.radius;
        Quadric { alpha: 0.0, beta: k, gamma: k }
    }

    pub(crate) fn height(&self, y: f64) -> Option<f64> {
        let under = (self.radius - y) * (self.radius + y);
        (under >= 0.0).then(|| -y * y / (self.radius + under.sqrt()))
    }

    pub(crate) fn local(&self, p: Vector) -> Local {
        Local::known(self.quadric().normal(p), 0.0, -1.0 / self.radius)
    }

    /// The point at `x` along the bar and `turn` round it from its top, radians.
    pub(crate) fn around(&self, x: f64, turn: f64) -> Vector {
        let half = (0.5 * turn).sin();
        [x, self.radius * turn.sin(), -2.0 * self.radius * half * half]
    }

    /// Length along the bar and turn round it of the nearest point.
    pub(crate) fn nearest(&self, p: Vector) -> [f64; 2] {
        [p[0], p[1].atan2(p[2] + self.radius)]
    }
}
