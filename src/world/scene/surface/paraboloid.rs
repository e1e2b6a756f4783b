//! Elliptic paraboloid: `z = -x^2/(2 r_x) - y^2/(2 r_y)`, the quadric with gamma = 0.
//!
//! `r_x, r_y` are the radii of curvature at the apex; an infinite one makes a parabolic cylinder.

use super::quadric::{Quadric, QuadricBody};
use super::{Body, Surface};
use crate::scene::error::{SceneError, all_not_zero};

/// A dish.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Paraboloid {
    /// Radii of curvature at the apex in x and y, input units.
    pub radii: [f64; 2],
}

impl Surface {
    /// A dish: `z = -x^2/(2 r_x) - y^2/(2 r_y)`, with these radii of curvature at the apex, input units. Range: not zero;
    /// an infinite one makes a parabolic cylinder.
    pub fn paraboloid(radii: [f64; 2]) -> Surface {
        Surface::new(Body::Paraboloid(Paraboloid { radii }), 0.0)
    }
}

impl QuadricBody for Paraboloid {
    fn check(&self) -> Result<(), SceneError> {
        all_not_zero("surface.radii", &self.radii)
    }

    fn quadric(&self) -> Quadric {
        Quadric { alpha: 1.0 / self.radii[0], beta: 1.0 / self.radii[1], gamma: 0.0 }
    }
}
