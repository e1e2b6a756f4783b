//! The answer to an input, or why there is none.

use crate::report::{Answer, ChosenPart, LackOfFitPart};
use palpate_fitting::fit::FitError;
use palpate_inference::parts::Parts;

use super::failure::fit_message;

/// The answer to an input, with what is said beside it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) answer: Answer,
    pub(super) chosen: Option<ChosenPart>,
    pub(super) lack_of_fit: Option<LackOfFitPart>,
    pub(super) notes: Vec<String>,
}

/// Why there is no answer.
pub(super) enum Refusal {
    /// A fit refused; the message may want a line of the file.
    Fit(FitError),
    /// The recognition refused.
    Shape(String),
    /// The contacts are several things, which have no one shape.
    Several(Box<SeveralThings>),
}

/// Several things in the place of one surface.
#[derive(Debug)]
pub(super) struct SeveralThings {
    /// Which they are, and what can be done.
    pub(super) message: String,
    /// Their parts, where these are known.
    pub(super) parts: Option<Parts>,
}

impl Refusal {
    /// The reason, where no line of a file belongs to it.
    pub(super) fn words(self) -> String {
        match self {
            Refusal::Fit(error) => fit_message(&error),
            Refusal::Shape(message) => message,
            Refusal::Several(things) => things.message,
        }
    }

    /// Several things of which a message says what can be done.
    pub(super) fn several(message: String, parts: Option<Parts>) -> Refusal {
        Refusal::Several(Box::new(SeveralThings { message, parts }))
    }
}
