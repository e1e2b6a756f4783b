//! Which description goes with which kind of surface.

use crate::io::{AnySurface, Points, Saved};
use palpate_fitting::fit::FitError;
use palpate_fitting::parametric::FittedSurface;
use palpate_inference::recognition::Recognition;

use super::describe_height::HeightDescription;
use super::describe_parametric::ParametricDescription;
use super::describe_recognised::RecognisedDescription;
use super::description::{Description, ShownGrid, Subject};
use super::document::{FitDocument, Seconds};
use super::parametric::ParametricPoints;
use super::point_table::PointTable;
use super::points::HeightPoints;

/// What a fit of the contacts answered.
#[derive(Debug)]
pub(crate) enum Answer {
    /// A surface of the kind that was named.
    Fitted(FittedSurface),
    /// What the contacts show, nothing being named.
    Recognised(Box<Recognition>),
}

impl Answer {
    /// Whether a parametric surface was fitted.
    pub(crate) fn is_parametric(&self) -> bool {
        matches!(self, Answer::Fitted(FittedSurface::Parametric(_)))
    }
}

/// Computes what a fit computes on first access, so that a caller with a clock can time it.
pub(crate) fn compute_shape(answer: &Answer, bare: bool) {
    match answer {
        Answer::Fitted(FittedSurface::Height(fit)) if bare => {
            let _ = fit.bare_shape();
        }
        Answer::Fitted(FittedSurface::Height(fit)) => {
            let _ = fit.shape();
            let _ = fit.certificate();
        }
        Answer::Fitted(FittedSurface::Parametric(fit)) => {
            let _ = fit.shape();
        }
        // a recognition has its shape already
        Answer::Recognised(_) => {}
    }
}

/// Describes an answer of any kind.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(crate) fn describe_fit<'a>(
    answer: &'a Answer,
    subject: &Subject<'a>,
    seconds: Seconds,
) -> Result<Box<dyn Description + 'a>, FitError> {
    Ok(match answer {
        Answer::Fitted(FittedSurface::Height(fit)) => Box::new(HeightDescription::of_fit(fit, subject, seconds)?),
        Answer::Fitted(FittedSurface::Parametric(fit)) => {
            Box::new(ParametricDescription::of_fit(fit, subject, seconds)?)
        }
        Answer::Recognised(found) => Box::new(RecognisedDescription::new(found, subject, seconds)?),
    })
}

/// Describes a saved surface of either kind over a grid; `document` is all that was saved with it.
pub(crate) fn describe_saved(saved: &Saved, document: FitDocument, grid: ShownGrid) -> Box<dyn Description + '_> {
    match &saved.surface {
        AnySurface::Height(surface) => Box::new(HeightDescription::of_saved(surface, saved, document, grid)),
        AnySurface::Parametric(surface, support) => {
            Box::new(ParametricDescription::of_saved(surface, support, document, grid))
        }
    }
}

/// A saved surface of either kind at given places.
pub(crate) fn points_at(saved: &Saved, places: &Points) -> Box<dyn PointTable> {
    match &saved.surface {
        AnySurface::Height(surface) => Box::new(HeightPoints::of(surface, &saved.frame, places)),
        AnySurface::Parametric(surface, support) => Box::new(ParametricPoints::of(surface, support, places)),
    }
}
