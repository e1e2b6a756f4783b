//! Torus lying flat, its top circle through the origin: ring of radius a about the axis (-a, 0), tube of radius b.
//!
//! ```text
//! s = hypot(x + a, y) - a = (x^2 + y^2 + 2 a x)/(hypot(x + a, y) + a)      z = -s^2 / (b + sqrt(b^2 - s^2))
//! k = -1/b  and  -(s/b)/hypot(x + a, y)
//! ```
//!
//! Dome where s > 0, ridge on the top circle, saddle-like where s < 0.

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{first_below, through_ball};
use super::{Body, Surface};
use crate::scene::error::{SceneError, positive};
use palpate_numeric::vector::{Vector, along, unit};

/// A ring.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Torus {
    /// Radius a of the ring's centre line, input units.
    pub major: f64,
    /// Radius b of the tube, less than a.
    pub minor: f64,
}

impl Surface {
    /// A ring lying flat, its top circle through the origin: centre line of radius `major` about the axis (-major, 0), tube
    /// of radius `minor`. Range: `0 < minor < major`, input units.
    pub fn torus(major: f64, minor: f64) -> Surface {
        Surface::new(Body::Torus(Torus { major, minor }), 0.0)
    }
}

impl Torus {
    /// Distance from the axis of the ring, and signed distance from its centre line.
    fn across(&self, x: f64, y: f64) -> (f64, f64) {
        let out = (x + self.major).hypot(y);
        (out, (x * x + y * y + 2.0 * self.major * x) / (out + self.major))
    }

    /// `F = (s^2 + z^2)/(2 b) + z`: zero on the torus.
    fn value(&self, p: Vector) -> f64 {
        let (_, s) = self.across(p[0], p[1]);
        p[2] + 0.5 * (s * s + p[2] * p[2]) / self.minor
    }
}

impl Geometry for Torus {
    fn check(&self) -> Result<(), SceneError> {
        positive("surface.major", self.major)?;
        positive("surface.minor", self.minor)?;
        if self.minor < self.major {
            return Ok(());
        }
        Err(SceneError::Clash {
            first: format!("surface.minor = {}", self.minor),
            second: format!("surface.major = {}", self.major),
            why: "the tube is thinner than the ring is wide".into(),
        })
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (_, s) = self.across(x, y);
        let under = (self.minor - s) * (self.minor + s);
        (under >= 0.0).then(|| -s * s / (self.minor + under.sqrt()))
    }

    fn local(&self, p: Vector) -> Option<Local> {
        let (out, s) = self.across(p[0], p[1]);
        if out == 0.0 {
            return None;
        }
        let sine = s / self.minor;
        let normal = [(p[0] + self.major) / out * sine, p[1] / out * sine, 1.0 + p[2] / self.minor];
        Some(Local::known(unit(normal), -1.0 / self.minor, -sine / out))
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let (low, high) = through_ball(o, d, [-self.major, 0.0, -self.minor], self.major + self.minor)?;
        first_below(low, high, |t| Some(self.value(along(o, t, d))))
    }

    fn around(&self, ring_deg: f64, angle: f64) -> Option<Vector> {
        let ring = ring_deg.to_radians();
        let out = self.major + self.minor * angle.sin();
        let half = (0.5 * angle).sin();
        Some([out * ring.cos() - self.major, out * ring.sin(), -2.0 * self.minor * half * half])
    }

    fn nearest(&self, p: Vector) -> Option<[f64; 2]> {
        let (_, s) = self.across(p[0], p[1]);
        Some([p[1].atan2(p[0] + self.major).to_degrees(), s.atan2(p[2] + self.minor)])
    }
}
