//! `palpate fit INPUT`: contacts or a grid, from a file or a pipe, to surface and shape.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::contact::ContactError;
use crate::fit::{FitError, FitOptions};
use crate::io::{Input, ReadOptions, Reading, read_input};
use crate::recognition::RecognitionOptions;
use crate::report::{Answer, Subject};

use super::automatic::{Found, Refusal, automatic};
use super::describe::{Destination, Taken, describe};
use super::failure::{Failure, fit_message};
use super::named::{counting_other_kinds, fit_input};
use super::options::{FitFlags, OutputFlags, WordsFlags};
use super::preparation::PreparationFlags;
use super::reading::{ReadFlags, seen_from};

/// Arguments of `palpate fit`.
#[derive(Args)]
pub(super) struct FitArgs {
    /// CSV, XYZ, NPZ, NPY, PLY, PCD, OBJ, OFF, STL or a depth image, each also as .gz; - for standard input
    input: PathBuf,
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file
    #[arg(long)]
    skip_invalid: bool,
    /// Save the surface and all that is known of it as JSON
    #[arg(long, value_name = "F")]
    save: Option<PathBuf>,
    /// Leave out certificate, uncertainties and intervals, which can take longer than the fit; for a named model
    #[arg(long)]
    bare: bool,
    #[command(flatten)]
    preparation: PreparationFlags,
    #[command(flatten)]
    reading: ReadFlags,
    #[command(flatten)]
    fit: FitFlags,
    #[command(flatten)]
    words: WordsFlags,
    #[command(flatten)]
    output: OutputFlags,
}

impl FitArgs {
    /// How the file is read. A model that was named takes the normals as they are; a recognition leaves out those of
    /// length zero and counts them.
    fn read_options(&self) -> ReadOptions {
        let keep_zero_normals = !self.fit.names_a_model();
        ReadOptions { keep_zero_normals, ..self.reading.options(self.skip_invalid) }
    }
}

pub(super) fn fit(args: &FitArgs) -> Result<(), Failure> {
    let began = Instant::now();
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    args.output.prepare(&[&args.input], args.save.as_slice())?;
    let spinner = args.output.spinner(format!("fitting {}", args.input.display()));
    let mut reading = read_input(&args.input, &args.read_options())?;
    let prepared = args.preparation.apply(&mut reading)?;
    let read = began.elapsed().as_secs_f64();
    let clock = Instant::now();
    let found = answer(&reading, args).map_err(|refusal| {
        Failure::Input(match refusal {
            Refusal::Fit(error) => placed(&error, &reading),
            Refusal::Shape(message) => format!("{}: {message}", reading.file),
        })
    })?;
    let fitted = clock.elapsed().as_secs_f64();
    let mut notes = notes(&reading);
    notes.extend(prepared);
    notes.extend(found.notes);
    let gridded = matches!(reading.input, Input::Grid(_));
    notes.extend(args.fit.without_effect(found.answer.is_parametric(), gridded));
    let subject = Subject {
        chosen: found.chosen,
        lack_of_fit: found.lack_of_fit,
        input: &reading.input,
        unit: args.words.unit.clone(),
        truth: None,
        bare: args.bare,
        notes,
    };
    drop(spinner);
    let taken = Taken { began, read, fitted };
    describe(
        &found.answer,
        &reading.file,
        &subject,
        &taken,
        &Destination { output: &args.output, words: &args.words, save: args.save.as_ref() },
    )
}

/// The model that was named, or what the contacts show where none was.
fn answer(reading: &Reading, args: &FitArgs) -> Result<Found, Refusal> {
    let (input, fit) = (&reading.input, args.fit.over(FitOptions::default()));
    let viewpoint = args.preparation.viewpoint;
    if args.fit.names_a_model() {
        if viewpoint.is_some() && !args.preparation.estimates_normals() {
            let what =
                "a viewpoint changes nothing for a model that is named by options: --flip-normals reverses normals";
            return Err(Refusal::Shape(what.into()));
        }
        let (found, chosen) = fit_input(input, &fit).map_err(Refusal::Fit)?;
        let found = if args.bare { found } else { counting_other_kinds(found) };
        return Ok(Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: Vec::new() });
    }
    if args.bare {
        let what = "--bare declines what the recognition rests on: its intervals and probabilities are its answer; \
             name a model beside it, as in --degree 2";
        return Err(Refusal::Shape(what.into()));
    }
    fit.check().map_err(Refusal::Fit)?;
    let viewpoint = viewpoint.or(seen_from(reading));
    let recognition =
        RecognitionOptions { grid: fit.grid, level: fit.level, viewpoint, ..RecognitionOptions::default() };
    automatic(input, &recognition, &fit)
}

/// The error with its file, and its line where it is about one contact.
fn placed(error: &FitError, reading: &Reading) -> String {
    let index = match error {
        FitError::Outside { index, .. } | FitError::NormalDown { index, .. } | FitError::Steep { index, .. } => {
            Some(*index)
        }
        FitError::Contacts(ContactError::NotFinite { index, .. } | ContactError::Weight { index, .. }) => Some(*index),
        FitError::Contacts(ContactError::ZeroNormal { index }) => Some(*index),
        _ => None,
    };
    match index.zip(reading.places.as_ref()) {
        Some((index, places)) => format!("{}, {}: {}", reading.file, places.of(index), fit_message(error)),
        None => format!("{}: {}", reading.file, fit_message(error)),
    }
}

fn notes(reading: &Reading) -> Vec<String> {
    let mut notes = reading.notes.clone();
    if !reading.ignored.is_empty() {
        notes.push(format!("columns not used: {}", reading.ignored.join(", ")));
    }
    if reading.skipped > 0 {
        let what = if matches!(reading.input, Input::Grid(_)) { "infinite entries" } else { "invalid rows" };
        notes.push(format!("{} {what} counted out", reading.skipped));
    }
    notes
}
