//! `palpate fit INPUT`: contacts or a grid, from a file or a pipe, to surface and shape.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::contact::ContactError;
use crate::fit::{FitError, FitOptions, SurfaceKind, fit_grid};
use crate::io::{Input, Reading, read_input};
use crate::parametric::{FittedSurface, fit_surface};
use crate::report::{ChosenPart, Subject};

use super::describe::{Destination, Taken, describe};
use super::failure::{Failure, fit_message};
use super::options::{FitFlags, OutputFlags};
use super::reading::ReadFlags;

/// Arguments of `palpate fit`.
#[derive(Args)]
pub(super) struct FitArgs {
    /// CSV, XYZ, NPZ, NPY, PLY, PCD, OBJ, OFF, STL or a depth image, each also as .gz; - for standard input
    input: PathBuf,
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file
    #[arg(long)]
    skip_invalid: bool,
    /// Normals point into the body: reverse them all
    #[arg(long)]
    flip_normals: bool,
    /// Save the surface and all that is known of it as JSON
    #[arg(long, value_name = "F")]
    save: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadFlags,
    #[command(flatten)]
    fit: FitFlags,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn fit(args: &FitArgs) -> Result<(), Failure> {
    let began = Instant::now();
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    args.output.prepare(&[&args.input], args.save.as_slice())?;
    let spinner = args.output.spinner(format!("fitting {}", args.input.display()));
    let mut reading = read_input(&args.input, &args.reading.options(args.skip_invalid))?;
    if args.flip_normals {
        reading.input = match reading.input {
            Input::Contacts(contacts) => Input::Contacts(contacts.with_flipped_normals()),
            grid => grid,
        };
    }
    let read = began.elapsed().as_secs_f64();
    let clock = Instant::now();
    let found = fit_input(&reading.input, &args.fit.over(FitOptions::default()));
    let found = found.map_err(|error| Failure::Input(placed(&error, &reading)))?;
    let fitted = clock.elapsed().as_secs_f64();
    let notes = notes(&reading);
    let (found, chosen) = found;
    let subject = Subject { chosen, input: &reading.input, truth: None, notes };
    drop(spinner);
    let taken = Taken { began, read, fitted };
    describe(&found, &reading.file, &subject, &taken, &Destination { output: &args.output, save: args.save.as_ref() })
}

/// Fits whichever kind of data it is; the kind of surface and why, where that was asked.
pub(super) fn fit_input(input: &Input, options: &FitOptions) -> Result<(FittedSurface, Option<ChosenPart>), FitError> {
    let (found, reason) = match input {
        Input::Contacts(contacts) => fit_surface(contacts, options)?,
        Input::Grid(_) if options.surface == SurfaceKind::Parametric => {
            return Err(FitError::Objective { objective: "a parametric surface", needed: "contacts, not a grid" });
        }
        Input::Grid(grid) => {
            (FittedSurface::Height(Box::new(fit_grid(grid, options)?)), "a grid of heights is one".into())
        }
    };
    let surface = match &found {
        FittedSurface::Height(_) => SurfaceKind::Height,
        FittedSurface::Parametric(_) => SurfaceKind::Parametric,
    };
    let asked = options.surface != SurfaceKind::Height;
    Ok((found, asked.then(|| ChosenPart { surface: surface.name().into(), reason })))
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
