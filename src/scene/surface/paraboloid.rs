//! Elliptic paraboloid: `z = -x^2/(2 r_x) - y^2/(2 r_y)`, the quadric with gamma = 0.
//!
//! `r_x, r_y` are the radii of curvature at the apex; an infinite one makes a parabolic cylinder.

use super::quadric::Quadric;

/// A dish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paraboloid {
    /// Radii of curvature at the apex in x and y, input units.
    pub radii: [f64; 2],
}

impl Paraboloid {
    pub(crate) fn quadric(&self) -> Quadric {
        Quadric { alpha: 1.0 / self.radii[0], beta: 1.0 / self.radii[1], gamma: 0.0 }
    }
}
