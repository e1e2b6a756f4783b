//! From an answer of any kind to its description: each kind tells its parts, and here they become a document.

mod adaptive;
pub(super) mod height;
mod parametric;
pub(super) mod recognised;
mod truth;

use std::borrow::Cow;
use std::cell::OnceCell;

use crate::io::{AnySurface, FIT_SCHEMA, Points, Saved, SavedFrame};
use palpate_fitting::fit::FitError;
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Frame;
use palpate_inference::recognition::Recognition;

use super::adaptive_answer::AdaptiveAnswer;
use super::description::Description;
use super::document::{FitDocument, FitPart, Seconds, ShapePart};
use super::parametric::ParametricPoints;
use super::point_table::PointTable;
use super::points::HeightPoints;
use super::shape_part::{take_again, take_back_class};
use super::subject::{Source, Subject};
use super::surface_maps::{Maps, ShownGrid};
use super::truth_part::TruthPart;

/// What a fit of the contacts answered.
#[derive(Debug)]
pub(crate) enum Answer {
    /// A surface of the kind that was named.
    Fitted(FittedSurface),
    /// A surface with knots where the contacts asked for them.
    Adaptive(Box<AdaptiveAnswer>),
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
        // these have their shape already
        Answer::Adaptive(_) | Answer::Recognised(_) => {}
    }
}

/// What any kind of answer tells: the parts of the document, and the surface itself.
struct Found<'a> {
    contacts: usize,
    /// The patch frame as the document has it.
    saved_frame: Frame,
    /// The frame along whose axes a height field stands.
    frame: Frame,
    fit: FitPart,
    shape: ShapePart,
    truth: Option<TruthPart>,
    surface: AnySurface,
    /// Coefficients without data.
    unsupported: Cow<'a, [usize]>,
    source: Source<'a>,
}

/// Describes an answer of any kind.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(crate) fn describe_fit<'a>(
    answer: &'a Answer,
    subject: &Subject<'a>,
    seconds: Seconds,
) -> Result<Description<'a>, FitError> {
    let found = match answer {
        Answer::Fitted(FittedSurface::Height(fit)) => height::found(fit, subject)?,
        Answer::Fitted(FittedSurface::Parametric(fit)) => parametric::found(fit, subject)?,
        Answer::Adaptive(answer) => adaptive::found(answer, subject)?,
        Answer::Recognised(found) => recognised::found(found, subject)?,
    };
    let grid = found.shape.grid;
    let mut document = FitDocument {
        schema: FIT_SCHEMA.into(),
        unit: subject.unit.clone(),
        contacts: found.contacts,
        frame: SavedFrame::of(&found.saved_frame),
        fit: found.fit,
        shape: found.shape,
        truth: found.truth,
        surface: found.surface.saved_form(&found.unsupported),
        uncertainty: None,
        seconds,
    };
    match found.source {
        // without a model that was named and tested there is nothing to take back
        Source::Height { fit, bare, .. } if subject.lack_of_fit.is_some() => {
            let shape = if bare { fit.bare_shape() } else { fit.shape() };
            take_back_class(&mut document, height::shape_index(&shape.maps));
        }
        Source::Adaptive { answer, .. } => take_back_class(&mut document, height::shape_index(&answer.shape.maps)),
        Source::Recognised { found, .. } => {
            let supported = found.map.iter().filter(|p| p.supported);
            take_back_class(&mut document, supported.filter_map(|p| p.shape_index));
        }
        _ => {}
    }
    let Found { surface, frame, unsupported, source, .. } = found;
    Ok(Description {
        document,
        surface: Cow::Owned(surface),
        frame,
        grid,
        unsupported,
        source,
        pointwise: OnceCell::new(),
    })
}

/// Describes a saved surface of either kind over a grid; `document` is all that was saved with it.
pub(crate) fn describe_saved(saved: &Saved, mut document: FitDocument, grid: ShownGrid) -> Description<'_> {
    let mut maps = Maps::over(&saved.surface, grid, &saved.unsupported);
    if let (Maps::Height(maps), Some(map)) = (&mut maps, &saved.support_map) {
        let (maps, domain) = (maps.to_mut(), saved.surface.map().domain());
        let places = &maps.grid;
        let each = maps.supported.indexed_iter_mut();
        each.for_each(|((i, j), s)| *s &= map.holds(domain, [places.x[i], places.y[j]]));
    }
    if grid.again {
        take_again(&mut document, &maps.flat());
    }
    Description {
        document,
        surface: Cow::Borrowed(&saved.surface),
        frame: saved.frame,
        grid: grid.points,
        unsupported: Cow::Borrowed(&saved.unsupported),
        source: Source::Saved(Box::new(maps)),
        pointwise: OnceCell::new(),
    }
}

/// A saved surface of either kind at given places.
pub(crate) fn points_at(saved: &Saved, places: &Points) -> Box<dyn PointTable> {
    match &saved.surface {
        AnySurface::Height(surface) => Box::new(HeightPoints::of(surface, &saved.frame, places)),
        AnySurface::Hierarchical(surface) => Box::new(HeightPoints::of(&**surface, &saved.frame, places)),
        AnySurface::Parametric(surface, support) => Box::new(ParametricPoints::of(surface, support, places)),
    }
}
