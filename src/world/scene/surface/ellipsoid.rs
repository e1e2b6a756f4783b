//! Ellipsoid with semi-axes a, b, c along x, y, z: `x^2/a^2 + y^2/b^2 + (z + c)^2/c^2 = 1`, touched on its upper half.
//!
//! As the quadric `alpha = c/a^2`, `beta = c/b^2`, `gamma = 1/c`: curvatures -c/a^2 and -c/b^2 at the apex.

use super::quadric::{Quadric, QuadricBody};
use super::{Body, Surface};
use crate::scene::error::{SceneError, all_positive};

/// A stretched ball.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ellipsoid {
    /// Semi-axes along x, y, z, input units.
    pub semi_axes: [f64; 3],
}

impl Surface {
    /// A stretched ball with these semi-axes a, b, c along x, y, z, its top at the origin:
    /// `x^2/a^2 + y^2/b^2 + (z + c)^2/c^2 = 1`. Range: above zero, input units.
    pub fn ellipsoid(semi_axes: [f64; 3]) -> Surface {
        Surface::new(Body::Ellipsoid(Ellipsoid { semi_axes }), 0.0)
    }
}

impl QuadricBody for Ellipsoid {
    fn check(&self) -> Result<(), SceneError> {
        all_positive("surface.semi_axes", &self.semi_axes)
    }

    fn quadric(&self) -> Quadric {
        let [a, b, c] = self.semi_axes;
        Quadric { alpha: c / a / a, beta: c / b / b, gamma: 1.0 / c }
    }
}
