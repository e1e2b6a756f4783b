//! `palpate fit INPUT` where nothing names a model: the contacts are recognised, and what cannot be is fitted or
//! refused.
//!
//! ```text
//! a simple shape                 S, R, class and radius, with intervals that count doubt about the kind of surface
//! too few to recognise           the height field of degree 2, with a note
//! directions without heights     likewise, since what is recognised is a surface through points
//! one sheet, no simple shape     a height field with as many segments as predict left-out contacts
//! several things, no one sheet   the first lines of `palpate parts`, or an error that says what can be done where a surface is wanted
//! ```

use std::borrow::Cow;

use crate::io::Input;
use crate::report::{Answer, ChosenPart, LackOfFitPart, TriedPart, significant};
use palpate_fitting::fit::{Fit, FitError, FitOptions, Robust};
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::{Contacts, Grid, Orientation};
use palpate_inference::recognition::{
    FieldForm, FieldRequest, Flexible, Recognition, RecognitionError, RecognitionOptions, Shown, shown,
};

use super::adaptive_model::{GRID, adaptive_found};
use super::explicit_model::fit_input;
use super::found::{Found, Refusal};
use super::local_detail::{is_free_form, local_detail};
use super::pixels::weighed_contacts_of;
use super::rival_parts::parts_instead;
use super::viewpoint::sees_from_below;
use super::zero_weights::with_heights;

/// What a user can do with contacts that are not one patch.
const FORWARD: &str = "palpate parts cuts it into its parts; take one part of it with --near X,Y,Z,R or --box X0,X1,Y0,Y1,Z0,Z1; \
     --surface parametric follows a sheet that bends far round, with --closed u one that closes on itself";

/// What a user can do with several things.
const APART: &str = "palpate parts takes them apart; --near X,Y,Z,R or --box X0,X1,Y0,Y1,Z0,Z1 takes one of them";

/// What few contacts do not tell, and what a user can do.
const FEW_ALL_ROUND: &str = "go all round a body that is no ball, bar, cone, ring or ellipsoid, and are too few to tell what else it is: \
     touch it at more places, all over it, with surface normals if you can";

/// What a user can do about too few contacts.
const MORE: &str = "touch a dozen places or more, spread over the patch, with surface normals if you can";

/// A note says that contacts lie off the surface when both their share and their number are at least these: more than a
/// sensor's stray readings.
const STRAY: f64 = 0.02;
const STRAYS: usize = 10;

/// Note where every normal points down, as in a scan in camera axes, but also in a file with inward normals.
const DOWNWARD: &str = "every normal points towards -z, and that side is taken for the free one; \
     if the normals point into the body, reverse them by --flip-normals";

/// Note where nothing tells the free side of a flexible height field.
const UPWARD: &str = "the sign of S takes +z for the free side: name a viewpoint where it is not";

/// Note where the contacts are places and directions alone.
const DIRECTIONS: &str = "the input has no heights (a column z), so that the shape is told from the directions alone, by a \
     height field of degree 2";

/// Where the viewpoint is on the other side than the one that a height field takes for the free one.
const OTHER_SIDE: &str = "the viewpoint is on the lower side of the height field that these contacts are fitted by, and S would have the \
     wrong sign: leave --viewpoint out for the sign as seen from above, or turn the axes of the input";

/// Recognises the input, or fits it where it cannot be recognised.
pub(super) fn automatic(input: &Input, options: &RecognitionOptions, fit: &FitOptions) -> Result<Found, Refusal> {
    let mut found = answer_to(input, options, fit)?;
    if matches!(found.answer, Answer::Recognised(_)) {
        found.notes.extend(without_effect(input, fit));
    }
    match (&found.answer, options.viewpoint) {
        (Answer::Fitted(FittedSurface::Height(fit)), Some(eye)) if is_behind(fit, input, eye) => {
            Err(Refusal::Shape(OTHER_SIDE.into()))
        }
        _ => Ok(found),
    }
}

/// What was chosen for a spline and means nothing for a recognised surface.
fn without_effect(input: &Input, fit: &FitOptions) -> impl Iterator<Item = String> {
    let has_axes = matches!(input, Input::Contacts(_)) && fit.frame.is_some();
    let chosen = [
        (has_axes, "--frame has no effect on a recognised surface, which has axes of its own"),
        (
            fit.robust != Robust::None,
            "--robust has no effect on a recognised surface, which finds false contacts of itself",
        ),
    ];
    chosen.into_iter().filter(|(is, _)| *is).map(|(_, said)| said.to_string())
}

/// Whether `eye` is on the lower side of a height field.
fn is_behind(fit: &Fit, input: &Input, eye: [f64; 3]) -> bool {
    let contacts = contacts_of(input);
    let at = |r: usize| fit.frame().to_patch([contacts.x[r], contacts.y[r], contacts.z[r]]);
    let over_field: Vec<[f64; 3]> = (0..contacts.len()).map(at).collect();
    sees_from_below(&Contacts::from_points(&over_field), fit.frame().to_patch(eye))
}

fn answer_to(input: &Input, options: &RecognitionOptions, fit: &FitOptions) -> Result<Found, Refusal> {
    let Some((input, weighed)) = with_heights(input) else {
        let (found, chosen) = fit_input(input, fit).map_err(Refusal::Fit)?;
        let notes = vec![DIRECTIONS.to_string()];
        return Ok(Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes });
    };
    let mut found = recognised(&input, options, fit)?;
    found.notes.extend(weighed);
    Ok(found)
}

/// The same of an input whose heights all count.
fn recognised(input: &Input, options: &RecognitionOptions, fit: &FitOptions) -> Result<Found, Refusal> {
    let found = match input {
        Input::Contacts(contacts) => Recognition::of(contacts, options),
        Input::Grid(grid) => Recognition::of_grid(grid, options),
    };
    let request = FieldRequest { fit, recognition: options, gridded: matches!(input, Input::Grid(_)) };
    match shown(found, || contacts_of(input), &request) {
        Ok(answer) => {
            let mut found = match answer {
                Shown::Simple(found) => simple(found),
                Shown::Flexible(field, simple) => flexible_field(*field, simple.as_deref()),
                Shown::Detailed(field, simple) => detailed(*field, &simple),
            };
            if let Some(detailed) = with_local_detail(input, &found.answer, options, fit) {
                found = detailed;
            }
            let flexible = matches!(found.answer, Answer::Fitted(_) | Answer::Adaptive(_));
            if let Some(parts) = parts_instead(input, &found.answer, options) {
                let count = parts.parts.len();
                let what = format!(
                    "the contacts are {count} things, to which they lie nearer than to any one surface. {APART}"
                );
                return Err(Refusal::several(what, Some(parts)));
            }
            found.notes.extend((flexible && without_side(input, options)).then(|| UPWARD.to_string()));
            found.notes.extend(all_downward(input).then(|| DOWNWARD.to_string()));
            Ok(found)
        }
        Err(RecognitionError::Contact(error)) => Err(Refusal::Fit(FitError::Contacts(error))),
        Err(error @ (RecognitionError::TooFew { .. } | RecognitionError::Arithmetic { .. })) => {
            let note = format!("{error}; a height field of degree 2 was fitted, and its intervals count noise alone");
            let (found, chosen) = fit_input(input, fit).map_err(|refused| match refused {
                // no model was named: what one would need is of no use
                FitError::TooFew { .. } | FitError::Collinear { .. } => Refusal::Shape(format!("{error}: {MORE}")),
                refused => Refusal::Fit(refused),
            })?;
            Ok(Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: vec![note] })
        }
        Err(error @ (RecognitionError::NotOneSheet { .. } | RecognitionError::AllAround { .. })) => {
            let contacts = contacts_of(input);
            if matches!(error, RecognitionError::AllAround { .. }) && are_few(&contacts, options) {
                return Err(Refusal::Shape(format!("the {} contacts {FEW_ALL_ROUND}", contacts.len())));
            }
            Err(Refusal::several(format!("{error}: {FORWARD}"), None))
        }
        Err(error @ RecognitionError::SeveralThings { .. }) => Err(Refusal::several(format!("{error}. {APART}"), None)),
        Err(error) => Err(Refusal::Shape(error.to_string())),
    }
}

/// Whether contacts are fewer than twice as many as let a free surface take the place of a patch: more would have told a smooth body.
fn are_few(contacts: &Contacts, options: &RecognitionOptions) -> bool {
    let without = !matches!(contacts.orientation, Orientation::Normals { .. });
    contacts.len() < 2 * options.tuning.free_beside_patch[usize::from(without)]
}

/// Note beside an adaptive surface that nobody named.
const DETAILED: &str = "the contacts show features far smaller than the whole, and the surface follows them; --degree 3 --segments 8 \
     fits one smooth over them";

/// An adaptive surface in the place of a smooth one, where the contacts show small features beside it.
fn with_local_detail(
    input: &Input,
    smooth: &Answer,
    options: &RecognitionOptions,
    request: &FitOptions,
) -> Option<Found> {
    if !is_free_form(smooth) {
        return None;
    }
    let contacts = match input {
        Input::Contacts(contacts) => Cow::Borrowed(contacts),
        Input::Grid(grid) => Cow::Owned(weighed_contacts_of(grid)),
    };
    // a height field is seen from above
    if options.viewpoint.is_some_and(|eye| sees_from_below(&contacts, eye)) {
        return None;
    }
    let fit = local_detail(&contacts, smooth, request)?;
    let untyped = request.grid == FitOptions::default().grid;
    let points = if untyped { GRID } else { request.grid };
    let found = adaptive_found(fit, &contacts, request, points);
    Some(Found { notes: vec![DETAILED.into()], ..found })
}

fn without_side(input: &Input, options: &RecognitionOptions) -> bool {
    let positions = matches!(input, Input::Contacts(Contacts { orientation: Orientation::None, .. }));
    positions && options.viewpoint.is_none()
}

fn all_downward(input: &Input) -> bool {
    match input {
        Input::Contacts(Contacts { orientation: Orientation::Normals { nz, .. }, .. }) => nz.iter().all(|nz| *nz < 0.0),
        _ => false,
    }
}

/// A simple shape, with a note where many contacts lie off it.
fn simple(found: Box<Recognition>) -> Found {
    let strays = found.outliers;
    let share = strays as f64 / (strays + found.contacts) as f64;
    let elsewhere = (strays >= STRAYS && share > STRAY).then(|| {
        let percent = 100.0 * share;
        format!("{percent:.0} % of the contacts belong to something else, a background or another part: {FORWARD}")
    });
    Found { answer: Answer::Recognised(found), chosen: None, lack_of_fit: None, notes: elsewhere.into_iter().collect() }
}

/// A flexible height field, with the simple shape that it takes the place of.
fn flexible_field(field: Flexible, simple: Option<&Recognition>) -> Found {
    let unsaid = 100.0 * field.error / field.relief;
    let mut tried: Vec<TriedPart> = field
        .tried
        .iter()
        .map(|(form, error)| TriedPart { name: named(form), rms: Some(*error), ..TriedPart::default() })
        .collect();
    tried.extend(simple.iter().flat_map(|found| &found.tried).map(|t| TriedPart {
        name: t.hypothesis.name().into(),
        probability: None,
        k1: Some(t.k1),
        k2: Some(t.k2),
        rms: Some(t.rms),
    }));
    let options = field.fit.options();
    let why = format!(
        "no simple shape explains the contacts; of the height fields tried, a {} predicts contacts left out in blocks best \
         (error {unsaid:.1} % of the relief)",
        named(&field.form)
    );
    let chosen = ChosenPart {
        degree: Some(options.degree),
        segments: Some(options.segments),
        frame: Some(if field.fit.frame().keeps_axes() { "keep" } else { "auto" }.into()),
        tried,
        ..ChosenPart::new("height", why)
    };
    let lack = LackOfFitPart {
        p: None,
        percent_of_relief: Some(unsaid),
        words: "the surface is not one simple shape: S and R change from place to place, see the maps of --out".into(),
    };
    let noise_alone = "the intervals count noise alone, not what more segments would change";
    let notes = (!field.form.smoothed).then(|| noise_alone.to_string()).into_iter().collect();
    let answer = Answer::Fitted(FittedSurface::Height(Box::new(field.fit)));
    Found { answer, chosen: Some(chosen), lack_of_fit: Some(lack), notes }
}

/// A height field that follows a simple shape and a detail along a line.
fn detailed(field: Flexible, simple: &Recognition) -> Found {
    let form = named(&field.form);
    let mut found = flexible_field(field, Some(simple));
    let what = simple.hypothesis.described();
    let radius = simple.radius.map_or(String::new(), |radius| format!(" of radius {}", significant(radius, 4)));
    found.notes.push(format!(
        "but for a detail along a line, as a scratch, a seam or a ridge, the contacts lie on {what}{radius}; S and R \
         count the detail as far as the surface follows it: touch beside it alone for those of {what}"
    ));
    if let Some(chosen) = found.chosen.as_mut() {
        chosen.reason = format!(
            "what the contacts lie off {what} runs along a line, as errors of a sensor do not; a {form} predicts contacts left out best"
        );
        chosen.why.clone_from(&chosen.reason);
    }
    found
}

fn named(form: &FieldForm) -> String {
    let [n, m] = form.segments;
    format!("{}height field of {n} x {m} segments", if form.smoothed { "smoothed " } else { "" })
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
