//! A model that was named, fitted to contacts or to a grid.

use crate::contact::Orientation;
use crate::fit::{FitError, FitOptions, FrameChoice, STEEP, SurfaceKind, fit_grid, steepness};
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

/// A model that names no axes, over contacts that stand steep on the input's x and y: the patch's own axes are taken, and
/// the note says so. A patch that lies upside down is left to the fit, which asks whether its normals point inward.
pub(super) fn with_own_axes_where_steep(input: &Input, options: &mut FitOptions) -> Option<String> {
    let Input::Contacts(contacts) = input else { return None };
    let over_input = options.frame.is_some() || options.domain.is_some() || options.knots.is_some();
    if over_input || options.surface != SurfaceKind::Height {
        return None;
    }
    let cosine = steepness(contacts).filter(|cosine| cosine.abs() < STEEP)?;
    options.frame = Some(FrameChoice::Auto);
    let leans = cosine.clamp(-1.0, 1.0).acos().to_degrees();
    let side = match contacts.orientation {
        Orientation::None => "; the free side is taken to be that of +z, which normals would tell",
        _ => "",
    };
    Some(format!(
        "the patch leans by {leans:.0} degrees, so it has axes of its own: --frame keep holds to the input's, over which it is \
         steep{side}"
    ))
}
