//! Gaussian bump with its top at the origin: `z = h (exp(-d^2/(2 w^2)) - 1)`, `d^2 = x^2 + y^2`.
//!
//! `expm1` keeps the digits near the top. `z_x = -x g/w^2`, `z_xx = (x^2/w^2 - 1) g/w^2`, `z_xy = x y g/w^4`,
//! `g = h exp(-d^2/(2 w^2))`. Curvatures -h/w^2 at the top; convex inside d = w, saddle-like outside.

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{first_below, through_slab, widened};
use super::{Body, Surface};
use crate::scene::error::{SceneError, finite, positive};
use palpate_numeric::vector::{Vector, along};

/// A hill.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GaussianBump {
    /// Height h of the top above the plain, input units.
    pub height: f64,
    /// Width w (the normal law's sigma), input units.
    pub width: f64,
}

impl Surface {
    /// A hill with its top at the origin: `z = height (exp(-(x^2 + y^2)/(2 width^2)) - 1)`, input units. Range: `height`
    /// finite, `width` above zero.
    pub fn gaussian_bump(height: f64, width: f64) -> Surface {
        Surface::new(Body::Gaussian(GaussianBump { height, width }), 0.0)
    }
}

impl Geometry for GaussianBump {
    fn check(&self) -> Result<(), SceneError> {
        finite("surface.height", self.height)?;
        positive("surface.width", self.width)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (u, v) = (x / self.width, y / self.width);
        Some(self.height * (-0.5 * (u * u + v * v)).exp_m1())
    }

    fn local(&self, [x, y, _]: Vector) -> Option<Local> {
        let w = self.width;
        let (u, v) = (x / w, y / w);
        let g = self.height / w * (-0.5 * (u * u + v * v)).exp();
        Local::of_height([-u * g, -v * g, (u * u - 1.0) * g / w, u * v * g / w, (v * v - 1.0) * g / w])
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let (low, high) = widened(through_slab(o, d, -self.height.abs(), self.height.abs())?);
        first_below(low, high, |t| {
            let p = along(o, t, d);
            self.height(p[0], p[1]).map(|z| p[2] - z)
        })
    }
}
