//! `palpate fit INPUT` where nothing names a model: the contacts are recognised, and what cannot be is fitted or refused.
//!
//! ```text
//! recognised                 S, R, class and radius with intervals that count doubt about the kind of surface
//! too few to recognise       the height field of degree 2, with a note
//! not one simple shape       a height field with as many segments as predict contacts left out, where it explains them
//! a closed body, many sheets an error that names the way forward
//! ```

use crate::fit::{FitError, FitOptions};
use crate::io::Input;
use crate::recognition::{RecognitionError, RecognitionOptions, recognise, recognise_grid};
use crate::report::{Answer, ChosenPart};

use super::fit::fit_input;

/// What to do with contacts that are no patch.
const FORWARD: &str = "take one part of it with --near X,Y,Z,R or --box X0,X1,Y0,Y1,Z0,Z1; \
     --surface parametric follows a sheet that bends far round, with --closed u one that closes on itself";

/// An answer, what was chosen where a fit had to choose, and notes.
pub(super) type Found = (Answer, Option<ChosenPart>, Vec<String>);

/// Why there is no answer.
pub(super) enum Refusal {
    /// A fit refused; the message may want a line of the file.
    Fit(FitError),
    /// The recognition refused.
    Shape(String),
}

/// Recognises the input, or fits it where it cannot be recognised.
pub(super) fn automatic(input: &Input, options: &RecognitionOptions, fit: &FitOptions) -> Result<Found, Refusal> {
    let found = match input {
        Input::Contacts(contacts) => recognise(contacts, options),
        Input::Grid(grid) => recognise_grid(grid, options),
    };
    match found {
        Ok(found) => Ok((Answer::Recognised(Box::new(found)), None, Vec::new())),
        Err(RecognitionError::Contact(error)) => Err(Refusal::Fit(FitError::Contacts(error))),
        Err(error @ (RecognitionError::TooFew { .. } | RecognitionError::Arithmetic { .. })) => {
            let note = format!("{error}; a height field of degree 2 was fitted, and its intervals count noise alone");
            named(input, fit, note)
        }
        Err(error @ (RecognitionError::NotOneSheet { .. } | RecognitionError::AllAround { .. })) => {
            Err(Refusal::Shape(format!("{error}: {FORWARD}")))
        }
        Err(error) => Err(Refusal::Shape(error.to_string())),
    }
}

fn named(input: &Input, fit: &FitOptions, note: String) -> Result<Found, Refusal> {
    let (found, chosen) = fit_input(input, fit).map_err(Refusal::Fit)?;
    Ok((Answer::Fitted(found), chosen, vec![note]))
}
