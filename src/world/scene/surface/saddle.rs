//! Hyperbolic saddle: `z = x^2/(2 r_x) - y^2/(2 r_y)`: rising along x, falling along y; S = 0 at the origin when r_x = r_y.

use super::quadric::{Quadric, QuadricBody};
use super::{Body, Surface};
use crate::scene::error::{SceneError, all_not_zero};

/// A pass between two hills.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Saddle {
    /// Radii of curvature at the origin: of the rise along x, of the fall along y; input units.
    pub radii: [f64; 2],
}

impl Surface {
    /// A pass between two hills: `z = x^2/(2 r_x) - y^2/(2 r_y)`, with these radii of curvature at the origin, input units;
    /// S = 0 there when they are equal. Range: not zero.
    pub fn saddle(radii: [f64; 2]) -> Surface {
        Surface::new(Body::Saddle(Saddle { radii }), 0.0)
    }
}

impl QuadricBody for Saddle {
    fn check(&self) -> Result<(), SceneError> {
        all_not_zero("surface.radii", &self.radii)
    }

    fn quadric(&self) -> Quadric {
        Quadric { alpha: -1.0 / self.radii[0], beta: 1.0 / self.radii[1], gamma: 0.0 }
    }
}
