//! Fits of either kind: the options or the contacts decide between a height field and a parametric surface.

use super::{ParametricFit, choose_surface};
use crate::fit::{Fit, FitError, FitOptions, SurfaceKind, fit_contacts};
use palpate_geometry::contact::Contacts;

/// The least degree of a parametric surface that `auto` takes: a biquadratic cannot follow strongly curved bodies.
const LEAST_DEGREE: usize = 3;

/// A height field fit or a parametric fit.
#[derive(Debug)]
pub enum FittedSurface {
    /// `z = S(x, y)`.
    Height(Box<Fit>),
    /// `Q(u, v)`.
    Parametric(Box<ParametricFit>),
}

impl FittedSurface {
    /// Fits a height field or a parametric surface, and gives the reason for the choice in words.
    ///
    /// Where `auto` takes a parametric surface, degrees below 3 are raised to 3, and the reason says so.
    ///
    /// ```
    /// # use palpate_fitting::facade as palpate;
    /// use palpate::Contacts;
    /// use palpate::fit::{FitOptions, SurfaceKind};
    /// use palpate::parametric::FittedSurface;
    ///
    /// // a shallow bowl z = (x^2 + y^2)/20 is well fitted by a height field
    /// let grid = || (0..25).map(|r| [f64::from(r / 5) - 2.0, f64::from(r % 5) - 2.0]);
    /// let points: Vec<[f64; 3]> = grid().map(|[x, y]| [x, y, (x * x + y * y) / 20.0]).collect();
    /// let normals: Vec<[f64; 3]> = grid().map(|[x, y]| [-x / 10.0, -y / 10.0, 1.0]).collect();
    /// let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    /// let mut options = FitOptions::default();
    /// options.surface = SurfaceKind::Auto;
    /// let (fit, _reason) = FittedSurface::of(&contacts, &options)?;
    /// assert!(matches!(fit, FittedSurface::Height(_)));
    /// # Ok::<(), palpate::fit::FitError>(())
    /// ```
    ///
    /// # Errors
    /// Every [`FitError`].
    pub fn of(contacts: &Contacts, options: &FitOptions) -> Result<(FittedSurface, String), FitError> {
        let (kind, mut reason) = choose_surface(contacts, options);
        if kind == SurfaceKind::Height {
            return Ok((FittedSurface::Height(Box::new(fit_contacts(contacts, options)?)), reason));
        }
        let mut options = options.clone();
        if options.surface == SurfaceKind::Auto && options.degree.iter().any(|p| *p < LEAST_DEGREE) {
            options.degree = options.degree.map(|p| p.max(LEAST_DEGREE));
            reason.push_str("; degree raised to 3, which a surface in space needs to go round");
        }
        Ok((FittedSurface::Parametric(Box::new(ParametricFit::new(contacts, &options)?)), reason))
    }
}
