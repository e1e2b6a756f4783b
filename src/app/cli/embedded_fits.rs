//! A fit for a program that holds the contacts already: the answer, its document, its maps and its surface.

use std::borrow::Cow;
use std::time::Instant;

use crate::io::{AnySurface, Input, read_surface_bytes, tensor};
use crate::report::{
    Answer, Audience, Description, PartsDocument, Seconds, Subject, compute_shape, describe_fit, write_json,
    write_words,
};
use palpate_fitting::fit::{Fit, FitError, FitOptions};
use palpate_fitting::parametric::{FittedSurface, ParametricFit};
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::{ShapeMaps, ShapeReport};
use palpate_geometry::surface::HeightField;
use palpate_inference::parts::{Parts, PartsOptions};
use palpate_inference::recognition::Recognition;
use palpate_studies::explore::planning_fit;

use super::adaptive_model::{TypedForAdaptive, adaptive_model};
use super::answer::recognition_of;
use super::explicit_model::fit_input;
use super::found::{Found, Refusal};
use super::recognise_or_fit::automatic;
use super::tuned::TunedOption;

/// Why there is no fit.
#[derive(Debug)]
pub enum FitRefusal {
    /// A fault of the data or of the options.
    Fit(FitError),
    /// The contacts show no shape; the message says what can be done.
    Shape(String),
}

impl From<Refusal> for FitRefusal {
    fn from(refusal: Refusal) -> FitRefusal {
        match refusal {
            Refusal::Fit(error) => FitRefusal::Fit(error),
            Refusal::Shape(message) => FitRefusal::Shape(message),
            Refusal::Several(things) => FitRefusal::Shape(things.message),
        }
    }
}

/// Which surface is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum AskedSurface {
    /// What the contacts show.
    Recognised,
    /// The spline that the options name.
    Spline,
    /// Small cells where the contacts ask for them; degrees and grid points where they were named.
    Adaptive {
        /// Degrees in x and y.
        degree: Option<[usize; 2]>,
        /// Points of the shape grid.
        grid: Option<[usize; 2]>,
        /// Other numbers.
        tuned: Vec<TunedOption>,
    },
}

/// The answer to an input, with the input.
#[derive(Debug)]
pub struct FitAnswer {
    input: Input,
    found: Found,
    bare: bool,
    /// The document shall count that the surface may be of another kind than the one that was named.
    uncertain: bool,
    seconds: f64,
}

impl FitAnswer {
    /// Does what `palpate fit` does: the surface that is asked for, by the options.
    ///
    /// # Errors
    /// Both kinds of [`FitRefusal`].
    pub fn new(
        input: Input,
        asked: AskedSurface,
        options: &FitOptions,
        viewpoint: Option<[f64; 3]>,
        bare: bool,
    ) -> Result<FitAnswer, FitRefusal> {
        let clock = Instant::now();
        let uncertain = asked == AskedSurface::Spline && !bare;
        let found = match asked {
            AskedSurface::Spline => {
                let (found, chosen) = fit_input(&input, options).map_err(FitRefusal::Fit)?;
                Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: Vec::new() }
            }
            AskedSurface::Adaptive { degree, grid, tuned } => {
                adaptive_model(&input, &TypedForAdaptive { degree, grid, tuned }, options, bare)?
            }
            AskedSurface::Recognised => {
                options.check().map_err(FitRefusal::Fit)?;
                automatic(&input, &recognition_of(options, viewpoint), options)?
            }
        };
        Ok(FitAnswer { input, found, bare, uncertain, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The answer to contacts that are elsewhere.
    pub(super) fn without_contacts(found: Found, bare: bool, seconds: f64) -> FitAnswer {
        FitAnswer { input: Input::Contacts(Contacts::default()), found, bare, uncertain: false, seconds }
    }

    /// The fitted height field, where one was fitted.
    pub fn height_field(&self) -> Option<&Fit> {
        match &self.found.answer {
            Answer::Fitted(FittedSurface::Height(fit)) => Some(fit),
            _ => None,
        }
    }

    /// The fitted surface in space, where one was fitted.
    pub fn parametric(&self) -> Option<&ParametricFit> {
        match &self.found.answer {
            Answer::Fitted(FittedSurface::Parametric(fit)) => Some(fit),
            _ => None,
        }
    }

    /// The shape of an adaptive surface, where one was fitted.
    pub fn adaptive_shape(&self) -> Option<&ShapeReport<ShapeMaps>> {
        match &self.found.answer {
            Answer::Adaptive(answer) => Some(&answer.shape),
            _ => None,
        }
    }

    /// The tensor spline of an adaptive surface's smallest cells, where one was fitted.
    ///
    /// # Errors
    /// Why it has none: it would be too large.
    pub fn adaptive_spline(&self) -> Option<Result<HeightField, String>> {
        let Answer::Adaptive(answer) = &self.found.answer else { return None };
        Some(answer.fit.input_field().map_err(|error| error.to_string()).and_then(|field| tensor(&field)))
    }

    /// The fit by which touches are planned: the fitted height field, or, of contacts that were recognised, one with the
    /// noise that was found. `None` where no height field over x and y fits them.
    pub fn planning_fit(&self) -> Option<Cow<'_, Fit>> {
        match (&self.found.answer, &self.input) {
            (Answer::Fitted(FittedSurface::Height(fit)), _) => Some(Cow::Borrowed(fit)),
            (Answer::Recognised(found), Input::Contacts(contacts)) => {
                planning_fit(contacts, Some(found)).map(Cow::Owned)
            }
            _ => None,
        }
    }

    /// How far each contact lies off the surface: along its normal where it was recognised, along z of a height field. `None`
    /// of other surfaces, of a grid, and of contacts that are elsewhere.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn residuals(&self) -> Result<Option<Vec<f64>>, FitError> {
        let Input::Contacts(contacts) = &self.input else { return Ok(None) };
        if contacts.is_empty() {
            return Ok(None);
        }
        let places = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]);
        Ok(match &self.found.answer {
            Answer::Recognised(found) => Some(places.map(|place| found.distance(place)).collect()),
            Answer::Fitted(FittedSurface::Height(fit)) => {
                let (surface, frame) = (fit.input_surface()?, fit.frame());
                let off = |place: [f64; 3]| {
                    let [x, y, z] = frame.rotate(place);
                    z - surface.at(x, y).z
                };
                Some(places.map(off).collect())
            }
            Answer::Adaptive(answer) => Some(places.map(|[x, y, z]| z - answer.fit.at(x, y).z).collect()),
            Answer::Fitted(FittedSurface::Parametric(_)) => None,
        })
    }

    /// What the contacts were recognised as.
    pub fn recognition(&self) -> Option<&Recognition> {
        match &self.found.answer {
            Answer::Recognised(found) => Some(found),
            Answer::Adaptive(_) | Answer::Fitted(_) => None,
        }
    }

    /// The document that `palpate fit --json` prints, and the table that it prints without; lengths are in `unit`.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn document(&self, name: &str, unit: Option<&str>) -> Result<[Vec<u8>; 2], FitError> {
        self.described(unit, |description| {
            let (mut json, mut table) = (Vec::new(), Vec::new());
            // a Vec takes every byte
            let _ = write_json(description.document(), &mut json);
            let _ =
                write_words(name, description.document(), Audience { detailed: false, ..Audience::READER }, &mut table);
            [json, table]
        })
    }

    /// The document that `palpate fit --save` writes: with support and uncertainty point by point.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn saved(&self, unit: Option<&str>) -> Result<Vec<u8>, FitError> {
        self.described(unit, |description| {
            let mut json = Vec::new();
            // a Vec takes every byte
            let _ = write_json(&description.saved(), &mut json);
            json
        })
    }

    /// The axes and the arrays of `maps.npz`, over another number of points where one is given.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn maps(&self, points: Option<[usize; 2]>) -> Result<([Vec<f64>; 2], Vec<NamedArray>), FitError> {
        self.described(None, |description| {
            let (grid, arrays) = description.map_arrays(points);
            ([grid.x, grid.y], arrays)
        })
    }

    fn described<T>(&self, unit: Option<&str>, of: impl FnOnce(&Description) -> T) -> Result<T, FitError> {
        let clock = Instant::now();
        // other kinds of surface are asked only here: it takes longer than many a fit, whose surface alone may be wanted
        let counted = match &self.found.answer {
            Answer::Fitted(FittedSurface::Height(fit)) if self.uncertain => {
                let fit = Recognition::beside(fit.as_ref().clone());
                Some(Answer::Fitted(FittedSurface::Height(Box::new(fit))))
            }
            _ => None,
        };
        let answer = counted.as_ref().unwrap_or(&self.found.answer);
        compute_shape(answer, self.bare);
        let shape = clock.elapsed().as_secs_f64();
        let seconds = Seconds { read: 0.0, fit: self.seconds, shape, total: self.seconds + shape };
        let subject = Subject {
            input: &self.input,
            unit: unit.map(String::from),
            truth: None,
            bare: self.bare,
            notes: self.found.notes.clone(),
            chosen: self.found.chosen.clone(),
            lack_of_fit: self.found.lack_of_fit.clone(),
        };
        Ok(of(&describe_fit(answer, &subject, seconds)?))
    }
}

/// The tensor spline of the smallest cells of an adaptive surface, from its document.
///
/// # Errors
/// What is wrong with the document, and why there is no spline.
pub fn adaptive_spline_of(document: &[u8]) -> Result<HeightField, String> {
    match read_surface_bytes("document", document).map_err(|error| error.to_string())?.surface {
        AnySurface::Hierarchical(field) => tensor(&field),
        _ => Err("the document is not that of an adaptive surface".into()),
    }
}

/// A map with its name.
pub type NamedArray = (&'static str, ndarray::Array2<f64>);

/// The document that `palpate parts --json` prints, and the part of every contact, counted from 1; 0 is none.
///
/// # Errors
/// What the command line would say.
pub fn parts_of(
    contacts: &Contacts,
    tolerance: Option<f64>,
    viewpoint: Option<[f64; 3]>,
) -> Result<(Vec<u8>, Vec<u32>), String> {
    let clock = Instant::now();
    let found = Parts::of(contacts, &PartsOptions { tolerance, viewpoint, ..PartsOptions::default() })
        .map_err(|error| error.to_string())?;
    let document = PartsDocument::new("contacts", &found, Vec::new(), clock.elapsed().as_secs_f64());
    let mut json = Vec::new();
    // a Vec takes every byte
    let _ = write_json(&document, &mut json);
    Ok((json, found.labels.iter().map(|label| label.map_or(0, |part| part + 1)).collect()))
}
