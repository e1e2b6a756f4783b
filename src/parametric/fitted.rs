//! A fit of whichever kind the options or the contacts call for.

use super::{ParametricFit, choose_surface, fit_parametric};
use crate::contact::Contacts;
use crate::fit::{Fit, FitError, FitOptions, SurfaceKind, fit_contacts};

/// The least degree of a surface in space that `auto` takes: a biquadratic bends too little to go round.
const LEAST_DEGREE: usize = 3;

/// Either kind of fit.
#[derive(Debug)]
pub enum FittedSurface {
    /// `z = S(x, y)`.
    Height(Box<Fit>),
    /// `Q(u, v)`.
    Parametric(Box<ParametricFit>),
}

/// Fits a height field or a surface in space, and says why that one.
///
/// Where `auto` takes a surface in space, degrees below 3 are raised to 3, and the reason says so.
///
/// # Errors
/// Every [`FitError`].
pub fn fit_surface(contacts: &Contacts, options: &FitOptions) -> Result<(FittedSurface, String), FitError> {
    let (kind, mut reason) = choose_surface(contacts, options);
    if kind == SurfaceKind::Height {
        return Ok((FittedSurface::Height(Box::new(fit_contacts(contacts, options)?)), reason));
    }
    let mut options = options.clone();
    if options.surface == SurfaceKind::Auto && options.degree.iter().any(|p| *p < LEAST_DEGREE) {
        options.degree = options.degree.map(|p| p.max(LEAST_DEGREE));
        reason.push_str("; degree raised to 3, which a surface in space needs to go round");
    }
    Ok((FittedSurface::Parametric(Box::new(fit_parametric(contacts, &options)?)), reason))
}
