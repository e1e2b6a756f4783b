//! The answer to an input, or why there is none.

use crate::report::{Answer, ChosenPart, LackOfFitPart};
use palpate_fitting::fit::FitError;

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
    /// It found several things, which have no one shape.
    Several(String),
}

impl Refusal {
    /// The reason, where no line of a file belongs to it.
    pub(super) fn words(self) -> String {
        match self {
            Refusal::Fit(error) => fit_message(&error),
            Refusal::Shape(message) | Refusal::Several(message) => message,
        }
    }
}
