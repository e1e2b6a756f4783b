//! Curvatures at a point of `F(p) = 0`, F growing towards the free side, from its gradient and Hessian.
//!
//! ```text
//! n = grad F / |grad F|        shape operator  [a b; b c] = -T' Hess F T / |grad F|,  T two orthonormal tangents
//! k1, k2 = (a + c)/2 +- hypot((a - c)/2, b)
//! ```
//!
//! Nothing divides by nz, so a rim is as good a place as an apex. The sign makes convex bodies negative, as in
//! [`palpate_geometry::curvature`].

use crate::scene::rotation::tangents;
use palpate_geometry::curvature;
use palpate_numeric::vector::{Vector, dot, norm};

/// Normal and curvatures of a surface at one of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Unit normal towards the free side.
    pub normal: [f64; 3],
    /// Larger principal curvature, 1/length; negative on convex bodies.
    pub k1: f64,
    /// Smaller principal curvature.
    pub k2: f64,
    /// `k1 - k2`, formed without cancellation.
    pub difference: f64,
}

impl Local {
    /// From closed forms of the two curvatures.
    pub(crate) fn known(normal: Vector, one: f64, other: f64) -> Local {
        Local { normal, k1: one.max(other), k2: one.min(other), difference: (one - other).abs() }
    }

    /// From gradient and Hessian (xx, yy, zz, xy, xz, yz) of F; `None` where the gradient vanishes or is not finite.
    pub(crate) fn implicit(gradient: Vector, hessian: [f64; 6]) -> Option<Local> {
        let length = norm(gradient);
        if !(length > 0.0 && length.is_finite()) || hessian.iter().any(|h| !h.is_finite()) {
            return None;
        }
        let normal = gradient.map(|g| g / length);
        let (e1, e2) = tangents(normal);
        let [xx, yy, zz, xy, xz, yz] = hessian;
        let times = |v: Vector| [dot([xx, xy, xz], v), dot([xy, yy, yz], v), dot([xz, yz, zz], v)];
        let (h1, h2) = (times(e1), times(e2));
        let (a, b, c) = (-dot(e1, h1) / length, -dot(e1, h2) / length, -dot(e2, h2) / length);
        let half_gap = (0.5 * (a - c)).hypot(b);
        let mean = 0.5 * (a + c);
        Some(Local { normal, k1: mean + half_gap, k2: mean - half_gap, difference: 2.0 * half_gap })
    }

    /// Of a height field from `[hx, hy, hxx, hxy, hyy]`.
    pub fn of_height([hx, hy, hxx, hxy, hyy]: [f64; 5]) -> Option<Local> {
        Local::implicit([-hx, -hy, 1.0], [-hxx, -hyy, 0.0, -hxy, 0.0, 0.0])
    }

    /// Shape index in [-1, 1]; `None` where both curvatures are zero.
    pub fn shape_index(&self) -> Option<f64> {
        curvature::shape_index(self.k1 + self.k2, self.difference)
    }

    /// Curvedness, 1/length.
    pub fn curvedness(&self) -> f64 {
        curvature::curvedness(self.k1, self.k2)
    }
}
