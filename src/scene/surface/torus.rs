//! Torus lying flat, its top circle through the origin: ring of radius a about the axis (-a, 0), tube of radius b.
//!
//! ```text
//! s = hypot(x + a, y) - a = (x^2 + y^2 + 2 a x)/(hypot(x + a, y) + a)      z = -s^2 / (b + sqrt(b^2 - s^2))
//! k = -1/b  and  -(s/b)/hypot(x + a, y)
//! ```
//!
//! Dome where s > 0, ridge on the top circle, saddle-like where s < 0.

use super::local::Local;
use crate::scene::vector::Vector;

/// A ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Radius a of the ring's centre line, input units.
    pub major: f64,
    /// Radius b of the tube, less than a.
    pub minor: f64,
}

impl Torus {
    /// (distance from the ring's axis, signed distance from its centre line)
    fn across(&self, x: f64, y: f64) -> (f64, f64) {
        let out = (x + self.major).hypot(y);
        (out, (x * x + y * y + 2.0 * self.major * x) / (out + self.major))
    }

    pub(crate) fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (_, s) = self.across(x, y);
        let under = (self.minor - s) * (self.minor + s);
        (under >= 0.0).then(|| -s * s / (self.minor + under.sqrt()))
    }

    pub(crate) fn local(&self, p: Vector) -> Option<Local> {
        let (out, s) = self.across(p[0], p[1]);
        if out == 0.0 {
            return None;
        }
        let sine = s / self.minor;
        let normal = [(p[0] + self.major) / out * sine, p[1] / out * sine, 1.0 + p[2] / self.minor];
        Some(Local::known(crate::scene::vector::unit(normal), -1.0 / self.minor, -sine / out))
    }

    /// `F = (s^2 + z^2)/(2 b) + z`, for rays.
    pub(crate) fn value(&self, p: Vector) -> f64 {
        let (_, s) = self.across(p[0], p[1]);
        p[2] + 0.5 * (s * s + p[2] * p[2]) / self.minor
    }

    /// The point at `ring` round the ring and `turn` round the tube from its top, radians.
    pub(crate) fn around(&self, ring: f64, turn: f64) -> Vector {
        let out = self.major + self.minor * turn.sin();
        let half = (0.5 * turn).sin();
        [out * ring.cos() - self.major, out * ring.sin(), -2.0 * self.minor * half * half]
    }

    /// Angles round ring and tube of the nearest point.
    pub(crate) fn nearest(&self, p: Vector) -> [f64; 2] {
        let (_, s) = self.across(p[0], p[1]);
        [p[1].atan2(p[0] + self.major), s.atan2(p[2] + self.minor)]
    }
}
