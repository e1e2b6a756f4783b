//! Monkey saddle: `z = (x^3 - 3 x y^2) / l^2`; flat at the origin (S undefined there), S = 0 only in the limit.
//!
//! `z_x = 3 (x^2 - y^2)/l^2`, `z_y = -6 x y/l^2`, `z_xx = 6 x/l^2 = -z_yy`, `z_xy = -6 y/l^2`. Curvedness near the
//! origin is 6 d/l^2 at distance d.

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{about_the_patch, first_below};
use super::{Body, Surface};
use crate::scene::error::{SceneError, positive};
use palpate_numeric::vector::{Vector, along};

/// Three valleys and three ridges.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MonkeySaddle {
    /// Length l, input units.
    pub length: f64,
}

impl Surface {
    /// Three valleys and three ridges: `z = (x^3 - 3 x y^2)/length^2`, flat at the origin. Range: above zero, input units.
    pub fn monkey_saddle(length: f64) -> Surface {
        Surface::new(Body::MonkeySaddle(MonkeySaddle { length }), 0.0)
    }
}

impl Geometry for MonkeySaddle {
    fn check(&self) -> Result<(), SceneError> {
        positive("surface.length", self.length)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (u, v) = (x / self.length, y / self.length);
        Some(u * (u * u - 3.0 * v * v) * self.length)
    }

    fn local(&self, [x, y, _]: Vector) -> Option<Local> {
        let l = self.length;
        let (u, v) = (x / l, y / l);
        Local::of_height([3.0 * (u - v) * (u + v), -6.0 * u * v, 6.0 * u / l, -6.0 * v / l, -6.0 * u / l])
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let (low, high) = about_the_patch(o, d, self.length)?;
        first_below(low, high, |t| {
            let p = along(o, t, d);
            self.height(p[0], p[1]).map(|z| p[2] - z)
        })
    }
}
