//! `palpate fit INPUT` where nothing names a model: the contacts are recognised, and what cannot be is fitted or
//! refused.
//!
//! ```text
//! a simple shape                 S, R, class and radius, with intervals that count doubt about the kind of surface
//! too few to recognise           the height field of degree 2, with a note
//! one sheet, no simple shape     a height field with as many segments as predict left-out contacts
//! a closed body, several sheets  an error that says what can be done
//! ```

use crate::contact::{Contacts, Grid, Orientation};
use crate::fit::{FitError, FitOptions};
use crate::io::Input;
use crate::parametric::FittedSurface;
use crate::recognition::{
    Flexible, Recognition, RecognitionError, RecognitionOptions, flexible, recognise, recognise_grid,
};
use crate::report::{Answer, ChosenPart, LackOfFitPart, TriedPart};

use super::named::fit_input;

/// What a user can do with contacts that are not one patch.
const FORWARD: &str = "take one part of it with --near X,Y,Z,R or --box X0,X1,Y0,Y1,Z0,Z1; \
     --surface parametric follows a sheet that bends far round, with --closed u one that closes on itself";

/// A flexible height field is an answer when its error at left-out contacts is below this share of the relief.
const PREDICTED: f64 = 0.5;

/// A simple shape is no answer when its misfit is above both of these: a quarter of the relief (in percent), and a
/// tenth of the patch's size. A sensor's error may be large beside the relief of a flat patch, but not beside the
/// patch's size.
const UNSAID: f64 = 25.0;
const OF_LENGTH: f64 = 0.1;

/// Least cosine of the angle between the patch's normal and z. A height field over x and y does not follow a steeper
/// patch.
const LEVEL: f64 = 0.7;

/// A flexible height field takes the place of the simple shape when its error is below this share of that shape's
/// misfit.
const BETTER: f64 = 0.5;

/// A note says that contacts lie off the surface when both their share and their number are at least these: more than a
/// sensor's stray readings.
const STRAY: f64 = 0.02;
const STRAYS: usize = 10;

/// Note where every normal points down, as in a scan in camera axes, but also in a file with inward normals.
const DOWNWARD: &str = "every normal points towards -z, and that side is taken for the free one; \
     if the normals point into the body, reverse them by --flip-normals";

/// The answer to an input, with what is said beside it.
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
}

/// Recognises the input, or fits it where it cannot be recognised.
pub(super) fn automatic(input: &Input, options: &RecognitionOptions, fit: &FitOptions) -> Result<Found, Refusal> {
    let found = match input {
        Input::Contacts(contacts) => recognise(contacts, options),
        Input::Grid(grid) => recognise_grid(grid, options),
    };
    match found {
        Ok(found) => {
            let mut found = match flexible_instead(input, &found, fit) {
                Some(bent) => bent,
                None => simple(found)?,
            };
            found.notes.extend(all_downward(input).then(|| DOWNWARD.to_string()));
            Ok(found)
        }
        Err(RecognitionError::Contact(error)) => Err(Refusal::Fit(FitError::Contacts(error))),
        Err(error @ (RecognitionError::TooFew { .. } | RecognitionError::Arithmetic { .. })) => {
            let note = format!("{error}; a height field of degree 2 was fitted, and its intervals count noise alone");
            let (found, chosen) = fit_input(input, fit).map_err(Refusal::Fit)?;
            Ok(Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: vec![note] })
        }
        Err(error @ RecognitionError::NotOneSheet { .. }) => {
            let bent = flexible(&contacts_of(input), fit).and_then(Result::ok);
            match bent.filter(|bent| bent.error < PREDICTED * bent.relief) {
                Some(bent) => Ok(bent_found(bent, None)),
                None => Err(Refusal::Shape(format!("{error}: {FORWARD}"))),
            }
        }
        Err(error @ RecognitionError::AllAround { .. }) => Err(Refusal::Shape(format!("{error}: {FORWARD}"))),
        Err(error) => Err(Refusal::Shape(error.to_string())),
    }
}

fn all_downward(input: &Input) -> bool {
    match input {
        Input::Contacts(Contacts { orientation: Orientation::Normals { nz, .. }, .. }) => nz.iter().all(|nz| *nz < 0.0),
        _ => false,
    }
}

/// The pattern of the residuals is more than chance when its p is below this.
const CHANCE: f64 = 0.01;

/// Whether much of the relief has a pattern that the simple shape leaves unsaid.
fn leaves_much_unsaid(found: &Recognition) -> bool {
    found.misfit.percent_of_relief > UNSAID && found.misfit.p < CHANCE
}

/// Whether that is more than any sensor errs, so that the simple shape is no answer.
fn is_no_answer(found: &Recognition) -> bool {
    let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis);
    leaves_much_unsaid(found) && best.is_some_and(|t| t.rms > OF_LENGTH * found.frame.scale)
}

/// The simple shape, unless its misfit is too large for an answer.
fn simple(found: Recognition) -> Result<Found, Refusal> {
    let mut notes = Vec::new();
    let strays = found.dropped.outliers;
    if is_no_answer(&found) {
        let outliers = 100.0 * strays as f64 / (strays + found.contacts) as f64;
        let error = RecognitionError::NotOneSheet { misfit: found.misfit.percent_of_relief, outliers };
        return Err(Refusal::Shape(format!("{error}: {FORWARD}")));
    }
    if strays >= STRAYS && strays as f64 > STRAY * (strays + found.contacts) as f64 {
        notes.push(format!(
            "{:.0} % of the contacts belong to something else, a background or another part: {FORWARD}",
            100.0 * strays as f64 / (strays + found.contacts) as f64
        ));
    }
    Ok(Found { answer: Answer::Recognised(Box::new(found)), chosen: None, lack_of_fit: None, notes })
}

/// A flexible height field, where the simple shape has a large misfit and such a field predicts the contacts. Both are
/// compared on the contacts that belong to the simple shape, so that strays decide nothing.
fn flexible_instead(input: &Input, found: &Recognition, fit: &FitOptions) -> Option<Found> {
    let up = found.frame.rotate_back([0.0, 0.0, 1.0])[2].abs();
    if !leaves_much_unsaid(found) || up < LEVEL {
        return None;
    }
    let contacts = contacts_of(input);
    let distance = |r: usize| found.surface.distance([contacts.x[r], contacts.y[r], contacts.z[r]]).abs();
    let mut order: Vec<(f64, u32)> = (0..contacts.len()).map(|r| (distance(r), r as u32)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.truncate(contacts.len().saturating_sub(found.dropped.outliers));
    let rms = (order.iter().map(|(d, _)| d * d).sum::<f64>() / order.len().max(1) as f64).sqrt();
    let belonging: Vec<u32> = order.iter().map(|(_, r)| *r).collect();
    let bent = flexible(&contacts.in_order(&belonging), fit)?.ok()?;
    if up * bent.error >= BETTER * rms {
        return None;
    }
    let bent = if belonging.len() == contacts.len() { bent } else { flexible(&contacts, fit)?.ok()? };
    Some(bent_found(bent, Some(found)))
}

fn bent_found(bent: Flexible, simple: Option<&Recognition>) -> Found {
    let segments = bent.fit.options().segments;
    let unsaid = 100.0 * bent.error / bent.relief;
    let mut tried: Vec<TriedPart> = bent
        .tried
        .iter()
        .map(|(n, error)| TriedPart {
            name: format!("height field of {n} x {n} segments"),
            rms: Some(*error),
            ..TriedPart::default()
        })
        .collect();
    tried.extend(simple.iter().flat_map(|found| &found.tried).map(|t| TriedPart {
        name: t.hypothesis.name().into(),
        probability: None,
        k1: Some(t.k1),
        k2: Some(t.k2),
        rms: Some(t.rms),
    }));
    let why = format!(
        "no simple shape explains the contacts; of the height fields tried, {} x {} segments predict contacts left \
             out in blocks best (error {unsaid:.1} % of the relief)",
        segments[0], segments[1]
    );
    let chosen = ChosenPart {
        degree: Some(bent.fit.options().degree),
        segments: Some(segments),
        frame: Some(if bent.fit.frame().keeps_axes() { "keep" } else { "auto" }.into()),
        tried,
        ..ChosenPart::new("height", why)
    };
    let lack = LackOfFitPart {
        p: None,
        percent_of_relief: Some(unsaid),
        words: "the surface is not one simple shape: S and R change from place to place, see the maps of --out".into(),
    };
    let note = "the intervals count noise alone, not what more segments would change".to_string();
    let answer = Answer::Fitted(FittedSurface::Height(Box::new(bent.fit)));
    Found { answer, chosen: Some(chosen), lack_of_fit: Some(lack), notes: vec![note] }
}

/// The measured pixels of a grid as contacts.
fn contacts_of(input: &Input) -> Contacts {
    match input {
        Input::Contacts(contacts) => contacts.clone(),
        Input::Grid(grid) => pixels(grid),
    }
}

fn pixels(grid: &Grid) -> Contacts {
    let known = grid.z.indexed_iter().filter(|(_, z)| !z.is_nan());
    let points: Vec<[f64; 3]> = known.map(|((i, j), z)| [grid.x[i], grid.y[j], *z]).collect();
    Contacts::from_points(&points)
}
