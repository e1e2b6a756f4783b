//! What comes of the call of a way.

use palpate_fitting::parametric::FittedSurface;
use palpate_inference::recognition::Recognition;

/// A surface of a model that was named, or what was recognised.
#[derive(Debug)]
pub enum FoundSurface {
    /// Of a model.
    Named(FittedSurface),
    /// Recognised; its intervals are part of it.
    Recognised(Box<Recognition>),
}

/// What a timed call gives back.
pub(super) type TimedAnswer = Result<FoundSurface, String>;
