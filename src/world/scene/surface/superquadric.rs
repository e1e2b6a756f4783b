//! Superquadric with semi-axes a, b, c and exponents e1 (north-south), e2 (east-west), its top at the origin:
//!
//! ```text
//! F = (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |(z + c)/c|^(2/e1) - 1
//! s = (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1),    z = c ((1 - s)^(e1/2) - 1) = c expm1(e1/2 log1p(-s))
//! ```
//!
//! e = 1 is the ellipsoid, e -> 0 a box; 0 < e <= 1 here, beyond that edges appear where no normal exists. At a point
//! where F is not twice differentiable (on an axis, when 2/e2 > 2 and e2 > e1 make it so) the curvature is undefined.
//! A. H. Barr, *Superquadrics and angle-preserving transformations*, IEEE CG&A 1 (1981) 11.

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{first_below, through_ball};
use super::{Body, Surface};
use crate::scene::error::{SceneError, all_positive};
use palpate_numeric::vector::{Vector, along};

/// A body between a ball, a pillow and a box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Superquadric {
    /// Semi-axes a, b, c, input units.
    pub semi_axes: [f64; 3],
    /// Exponents e1, e2 in (0, 1].
    pub exponents: [f64; 2],
}

impl Surface {
    /// Anything from a pillow to a box, its top at the origin: semi-axes a, b, c, input units, and exponents e1
    /// (north-south) and e2 (east-west). Exponents of 1 make the ellipsoid, small ones a box. Range: the semi-axes above
    /// zero, the exponents in (0, 1].
    pub fn superquadric(semi_axes: [f64; 3], exponents: [f64; 2]) -> Surface {
        Surface::new(Body::Superquadric(Superquadric { semi_axes, exponents }), 0.0)
    }
}

/// Value and first two derivatives of |t|^n for n >= 2.
fn power(t: f64, n: f64) -> [f64; 3] {
    let size = t.abs();
    [size.powf(n), n * size.powf(n - 1.0) * t.signum(), n * (n - 1.0) * size.powf(n - 2.0)]
}

impl Superquadric {
    fn section(&self, x: f64, y: f64) -> f64 {
        let [a, b, _] = self.semi_axes;
        let [e1, e2] = self.exponents;
        ((x / a).abs().powf(2.0 / e2) + (y / b).abs().powf(2.0 / e2)).powf(e2 / e1)
    }

    /// F of the heading: zero on the surface.
    fn value(&self, p: Vector) -> f64 {
        let c = self.semi_axes[2];
        self.section(p[0], p[1]) + (1.0 + p[2] / c).abs().powf(2.0 / self.exponents[0]) - 1.0
    }

    /// At the very top: flat for e1 < 1, an ellipsoid's apex for e1 = e2 = 1, else undefined.
    fn top(&self) -> Option<Local> {
        let [a, b, c] = self.semi_axes;
        match self.exponents {
            [e1, _] if e1 < 1.0 => Some(Local::known([0.0, 0.0, 1.0], 0.0, 0.0)),
            [1.0, 1.0] => Some(Local::known([0.0, 0.0, 1.0], -c / a / a, -c / b / b)),
            _ => None,
        }
    }
}

impl Geometry for Superquadric {
    fn check(&self) -> Result<(), SceneError> {
        all_positive("surface.semi_axes", &self.semi_axes)?;
        for exponent in self.exponents {
            if !(exponent > 0.0 && exponent <= 1.0) {
                let expected = "an exponent above 0, at most 1, is needed (beyond 1 there are edges without normals)";
                return Err(SceneError::range("surface.exponents", exponent, expected));
            }
        }
        Ok(())
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let s = self.section(x, y);
        (s <= 1.0).then(|| self.semi_axes[2] * (0.5 * self.exponents[0] * (-s).ln_1p()).exp_m1())
    }

    fn local(&self, p: Vector) -> Option<Local> {
        let [a, b, c] = self.semi_axes;
        let [e1, e2] = self.exponents;
        let [fx, fx1, fx2] = power(p[0] / a, 2.0 / e2);
        let [fy, fy1, fy2] = power(p[1] / b, 2.0 / e2);
        let [_, fz1, fz2] = power(1.0 + p[2] / c, 2.0 / e1);
        let m = e2 / e1;
        let g = fx + fy;
        // s = g^m, s' = m g^(m-1), s'' = m (m-1) g^(m-2); at g = 0 only m = 1 leaves them finite
        let (s1, s2) = if g > 0.0 {
            (m * g.powf(m - 1.0), m * (m - 1.0) * g.powf(m - 2.0))
        } else {
            return self.top();
        };
        let (gx, gy) = (fx1 / a, fy1 / b);
        let gradient = [s1 * gx, s1 * gy, fz1 / c];
        let hessian =
            [s1 * fx2 / a / a + s2 * gx * gx, s1 * fy2 / b / b + s2 * gy * gy, fz2 / c / c, s2 * gx * gy, 0.0, 0.0];
        Local::implicit(gradient, hessian)
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let [a, b, c] = self.semi_axes;
        let (low, high) = through_ball(o, d, [0.0, 0.0, -c], a.hypot(b).hypot(c))?;
        first_below(low, high, |t| Some(self.value(along(o, t, d))))
    }
}
