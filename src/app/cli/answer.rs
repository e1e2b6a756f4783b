//! What is found in an input, by `fit` and `run` alike: the model that was named, or what the contacts show where none was.

use crate::io::Input;
use crate::report::{Answer, Description, Seconds, Subject, describe_fit};
use palpate_fitting::fit::FitOptions;
use palpate_inference::recognition::RecognitionOptions;

use super::adaptive_model::{AdaptiveFlags, adaptive_model};
use super::explicit_model::{counting_other_kinds, fit_input, with_own_axes_where_steep};
use super::failure::fit_message;
use super::found::{Found, Refusal};
use super::options::FitFlags;
use super::recognise_or_fit::automatic;

/// What is asked of an input.
pub(super) struct Question<'a> {
    /// What was typed.
    pub(super) flags: &'a FitFlags,
    /// Whether an adaptive surface was asked for, and how.
    pub(super) adaptive: &'a AdaptiveFlags,
    /// What it is typed over.
    pub(super) base: FitOptions,
    /// Certificate, uncertainties and intervals are declined.
    pub(super) bare: bool,
    /// Where the sensor stood.
    pub(super) viewpoint: Option<[f64; 3]>,
}

/// The answer, or why there is none.
pub(super) fn answer(input: &Input, question: &Question) -> Result<Found, Refusal> {
    let mut fit = question.flags.over(question.base.clone());
    if question.adaptive.adaptive {
        return adaptive_model(input, &question.adaptive.typed(question.flags), &fit, question.bare);
    }
    if question.flags.names_a_model() {
        let notes = with_own_axes_where_steep(input, &mut fit).into_iter().collect();
        return Ok(Found { notes, ..as_named(input, &fit, question.bare)? });
    }
    if question.bare {
        let what = "--bare declines what the recognition rests on: its intervals and probabilities are its answer; \
             name a model beside it, as in --degree 2";
        return Err(Refusal::Shape(what.into()));
    }
    fit.check().map_err(Refusal::Fit)?;
    automatic(input, &recognition_of(&fit, question.viewpoint), &fit)
}

/// What these options say to a recognition.
pub(super) fn recognition_of(fit: &FitOptions, viewpoint: Option<[f64; 3]>) -> RecognitionOptions {
    RecognitionOptions {
        grid: fit.grid,
        inset: fit.inset,
        level: fit.level,
        sigma_xy: fit.sigma_xy,
        viewpoint,
        ..RecognitionOptions::default()
    }
}

/// The answer described with these notes, without a truth and without a unit, and what it took.
pub(super) fn described<'a>(
    found: &'a Found,
    input: &'a Input,
    seconds: f64,
    notes: Vec<String>,
) -> Result<Description<'a>, String> {
    let subject = Subject {
        chosen: found.chosen.clone(),
        lack_of_fit: found.lack_of_fit.clone(),
        input,
        unit: None,
        truth: None,
        bare: false,
        notes,
    };
    let seconds = Seconds { read: 0.0, fit: seconds, shape: 0.0, total: seconds };
    describe_fit(&found.answer, &subject, seconds).map_err(|error| fit_message(&error))
}

/// Exactly this model; its intervals count other kinds of surface unless they are declined.
pub(super) fn as_named(input: &Input, fit: &FitOptions, bare: bool) -> Result<Found, Refusal> {
    let (found, chosen) = fit_input(input, fit).map_err(Refusal::Fit)?;
    let found = if bare { found } else { counting_other_kinds(found) };
    Ok(Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: Vec::new() })
}
