//! A model that was named, fitted to contacts or to a grid.

use crate::io::Input;
use crate::report::ChosenPart;
use palpate_fitting::fit::{
    Fit, FitError, FitOptions, FrameChoice, STEEP, SurfaceKind, fit_contacts, fit_grid, steepness,
};
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Orientation;
use palpate_inference::recognition::Recognition;

/// Fits whichever kind of data it is; the kind of surface and why, where that was asked.
pub(super) fn fit_input(input: &Input, options: &FitOptions) -> Result<(FittedSurface, Option<ChosenPart>), FitError> {
    let over_plane = |fit: Fit| FittedSurface::Height(Box::new(fit));
    let (found, reason) = match (input, options.surface) {
        (Input::Contacts(contacts), SurfaceKind::Height) => {
            return Ok((over_plane(fit_contacts(contacts, options)?), None));
        }
        (Input::Grid(grid), SurfaceKind::Height) => return Ok((over_plane(fit_grid(grid, options)?), None)),
        (Input::Contacts(contacts), SurfaceKind::Auto | SurfaceKind::Parametric) => {
            FittedSurface::of(contacts, options)?
        }
        (Input::Grid(grid), SurfaceKind::Auto) => {
            (over_plane(fit_grid(grid, options)?), "a grid of heights is one".into())
        }
        (Input::Grid(_), SurfaceKind::Parametric) => {
            return Err(FitError::Objective { objective: "a parametric surface", needed: "contacts, not a grid" });
        }
    };
    let surface = match &found {
        FittedSurface::Height(_) => SurfaceKind::Height,
        FittedSurface::Parametric(_) => SurfaceKind::Parametric,
    };
    Ok((found, Some(ChosenPart::new(surface.name(), reason))))
}

/// The same answer whose intervals count that the surface may be of another kind than a height field of these knots.
pub(super) fn counting_other_kinds(found: FittedSurface) -> FittedSurface {
    match found {
        FittedSurface::Height(fit) => FittedSurface::Height(Box::new(Recognition::beside(*fit))),
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
