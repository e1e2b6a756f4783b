//! The kernel of all quadrics that touch z = 0 with their apex at the origin:
//!
//! ```text
//! F = z + (alpha x^2 + beta y^2 + gamma z^2)/2 = 0        k = -alpha, -beta at the apex
//! q = alpha x^2 + beta y^2,    z = -q / (1 + sqrt(1 - gamma q))
//! along p = o + t d:   A t^2 + 2 B t + C = 0,  the branch with grad F . d > 0:  t = -C / (B + sqrt(B^2 - A C))
//! ```
//!
//! The sphere is 1/r, 1/r, 1/r; the cylinder 0, 1/r, 1/r; a paraboloid has gamma = 0. Neither form cancels at any
//! radius: the sagitta keeps all its digits at r = 1e9.

use super::geometry::Geometry;
use super::local::Local;
use crate::scene::error::SceneError;
use palpate_numeric::vector::{Vector, dot};

/// `F = z + (alpha x^2 + beta y^2 + gamma z^2)/2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    pub alpha: f64,
    pub beta: f64,
    pub gamma: f64,
}

impl Quadric {
    #[inline]
    pub(crate) fn height(&self, x: f64, y: f64) -> Option<f64> {
        let q = self.alpha * x * x + self.beta * y * y;
        let under = 1.0 - self.gamma * q;
        (under >= 0.0).then(|| -q / (1.0 + under.sqrt()))
    }

    #[inline]
    pub(crate) fn gradient(&self, p: Vector) -> Vector {
        [self.alpha * p[0], self.beta * p[1], 1.0 + self.gamma * p[2]]
    }

    pub(crate) fn local(&self, p: Vector) -> Option<Local> {
        Local::implicit(self.gradient(p), [self.alpha, self.beta, self.gamma, 0.0, 0.0, 0.0])
    }

    pub(crate) fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        let bend = |u: Vector, v: Vector| self.alpha * u[0] * v[0] + self.beta * u[1] * v[1] + self.gamma * u[2] * v[2];
        let a = 0.5 * bend(d, d);
        let b = 0.5 * (d[2] + bend(o, d));
        let c = o[2] + 0.5 * bend(o, o);
        let under = b * b - a * c;
        if under < 0.0 {
            return None;
        }
        // grad F . d = 2 (A t + B) = 2 sqrt(under) on the wanted branch
        let root = under.sqrt();
        if b + root > 0.0 {
            return Some(-c / (b + root));
        }
        (a != 0.0).then(|| (-b + root) / a)
    }

    /// Unit normal at p.
    pub(crate) fn normal(&self, p: Vector) -> Vector {
        let g = self.gradient(p);
        let length = dot(g, g).sqrt();
        g.map(|v| v / length)
    }
}

/// A body that is a quadric and nothing more: its sizes say which.
pub trait QuadricBody {
    /// Checks that every size is in its range.
    fn check(&self) -> Result<(), SceneError>;

    /// The quadric of these sizes.
    fn quadric(&self) -> Quadric;
}

impl<B: QuadricBody> Geometry for B {
    fn check(&self) -> Result<(), SceneError> {
        QuadricBody::check(self)
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.quadric().height(x, y)
    }

    fn local(&self, p: Vector) -> Option<Local> {
        self.quadric().local(p)
    }

    fn hit(&self, o: Vector, d: Vector) -> Option<f64> {
        self.quadric().hit(o, d)
    }
}
