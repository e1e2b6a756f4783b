//! A surface from elsewhere, `z = h(x, y)`: a fit of real contacts, say.
//!
//! To test a spline on contacts that were made on a spline is an inverse crime: the model error is zero by construction.
//! Every report of such a scene says so (see [`super::Surface::inverse_crime`]).

use std::sync::Arc;

use super::geometry::Geometry;
use super::local::Local;
use super::ray::{about_the_patch, first_below};
use super::{Body, Surface};
use crate::scene::error::SceneError;
use palpate_numeric::vector::along;

/// A height field that another room supplies.
pub trait ImportedSurface: std::fmt::Debug + Send + Sync {
    /// Where it came from; appears in every output.
    fn label(&self) -> &str;

    /// Whether it is itself a fit, of the same kind as what will be fitted to it. A formula of the caller's own is none:
    /// contacts on it are no inverse crime.
    fn is_fit(&self) -> bool {
        true
    }

    /// `[h, h_x, h_y, h_xx, h_xy, h_yy]` at a point, input units; `None` outside its domain.
    fn jet(&self, x: f64, y: f64) -> Option<[f64; 6]>;
}

impl Surface {
    /// A surface `z = h(x, y)` of the caller's own.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::{ImportedSurface, Surface};
    ///
    /// /// `z = -x^4`
    /// #[derive(Debug)]
    /// struct Quartic;
    ///
    /// impl ImportedSurface for Quartic {
    ///     fn label(&self) -> &str {
    ///         "quartic"
    ///     }
    ///     fn is_fit(&self) -> bool {
    ///         false
    ///     }
    ///     fn jet(&self, x: f64, _y: f64) -> Option<[f64; 6]> {
    ///         Some([-x.powi(4), -4.0 * x.powi(3), 0.0, -12.0 * x * x, 0.0, 0.0])
    ///     }
    /// }
    ///
    /// assert_eq!(Surface::imported(Quartic).height(2.0, 0.0), Some(-16.0));
    /// ```
    pub fn imported(surface: impl ImportedSurface + 'static) -> Surface {
        Surface::new(Body::Imported(Arc::new(surface)), 0.0)
    }
}

impl Geometry for Arc<dyn ImportedSurface> {
    fn check(&self) -> Result<(), SceneError> {
        Ok(())
    }

    fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.jet(x, y).map(|jet| jet[0])
    }

    fn local(&self, p: [f64; 3]) -> Option<Local> {
        let [_, hx, hy, hxx, hxy, hyy] = self.jet(p[0], p[1])?;
        Local::of_height([hx, hy, hxx, hxy, hyy])
    }

    fn hit(&self, o: [f64; 3], d: [f64; 3]) -> Option<f64> {
        let (low, high) = about_the_patch(o, d, 0.0)?;
        first_below(low, high, |t| {
            let p = along(o, t, d);
            self.height(p[0], p[1]).map(|z| p[2] - z)
        })
    }
}
