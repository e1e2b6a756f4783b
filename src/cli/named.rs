//! A model that was named, fitted to contacts or to a grid.

use crate::fit::{FitError, FitOptions, SurfaceKind, fit_grid};
use crate::io::Input;
use crate::parametric::FittedSurface;
use crate::report::ChosenPart;

/// Fits whichever kind of data it is; the kind of surface and why, where that was asked.
pub(super) fn fit_input(input: &Input, options: &FitOptions) -> Result<(FittedSurface, Option<ChosenPart>), FitError> {
    let (found, reason) = match input {
        Input::Contacts(contacts) => FittedSurface::of(contacts, options)?,
        Input::Grid(_) if options.surface == SurfaceKind::Parametric => {
            return Err(FitError::Objective { objective: "a parametric surface", needed: "contacts, not a grid" });
        }
        Input::Grid(grid) => {
            (FittedSurface::Height(Box::new(fit_grid(grid, options)?)), "a grid of heights is one".into())
        }
    };
    let surface = match &found {
        FittedSurface::Height(_) => SurfaceKind::Height,
        FittedSurface::Parametric(_) => SurfaceKind::Parametric,
    };
    let asked = options.surface != SurfaceKind::Height;
    Ok((found, asked.then(|| ChosenPart::new(surface.name(), reason))))
}

/// The same answer whose intervals count that the surface may be of another kind than a height field of these knots.
pub(super) fn counting_other_kinds(found: FittedSurface) -> FittedSurface {
    match found {
        FittedSurface::Height(fit) => FittedSurface::Height(Box::new((*fit).with_model_error())),
        other => other,
    }
}
