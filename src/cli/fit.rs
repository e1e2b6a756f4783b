//! `palpate fit INPUT`: contacts or a grid to surface and shape.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::contact::{Contacts, Grid};
use crate::fit::{Fit, FitError, FitOptions, fit_contacts, fit_grid};
use crate::io::{Input, ReadOptions, Reading, read_input};
use crate::report::Seconds;

use super::describe::{deliver, document};
use super::failure::Failure;
use super::options::{FitFlags, OutputFlags};

/// Arguments of `palpate fit`.
#[derive(Args)]
pub(super) struct FitArgs {
    /// CSV, NPZ or PLY of contacts, or NPZ of a grid; - for standard input
    input: PathBuf,
    #[command(flatten)]
    flags: FitFlags,
    /// Count rows with missing or non-finite numbers out instead of refusing the file
    #[arg(long)]
    skip_invalid: bool,
    /// Reverse every normal: those of the file point into the body
    #[arg(long)]
    flip_normals: bool,
    /// Save the surface (and the whole document) as JSON; - for standard output
    #[arg(long, value_name = "SURFACE.json")]
    save: Option<PathBuf>,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn fit(args: &FitArgs) -> Result<(), Failure> {
    let start = Instant::now();
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    args.output.prepare()?;
    let options = args.flags.over(FitOptions::default());
    let reading = read_input(&args.input, &ReadOptions { skip_invalid: args.skip_invalid })?;
    let read = start.elapsed().as_secs_f64();
    let spinner = args.output.spinner(format!("fitting {}", reading.file));
    let (notes, name) = (notes_of(&reading), reading.file.clone());
    let (fit, contacts, dots) = match reading.input {
        Input::Contacts(ref contacts) => {
            let contacts = if args.flip_normals { contacts.clone().with_flipped_normals() } else { contacts.clone() };
            let fit = fit_contacts(&contacts, &options).map_err(|e| located(&e, &reading))?;
            (fit, contacts.len(), Some(contacts))
        }
        Input::Grid(ref grid) => {
            let fit = fit_grid(grid, &options).map_err(|e| located(&e, &reading))?;
            (fit, measured(grid), None)
        }
    };
    let fitted = start.elapsed().as_secs_f64();
    fit.shape();
    let total = start.elapsed().as_secs_f64();
    let seconds = Seconds { read, fit: fitted - read, shape: total - fitted, total };
    let document = document(&fit, contacts, None, notes, seconds)?;
    drop(spinner);
    let dots = dots.map(|contacts| in_frame(&fit, &contacts));
    let dots = dots.as_ref().map(|(x, y)| (&x[..], &y[..]));
    deliver(&name, &document, fit.shape(), dots, &args.output, args.save.as_deref())
}

/// Contacts along the frame's axes in input units, as the maps have them.
pub(super) fn in_frame(fit: &Fit, contacts: &Contacts) -> (Vec<f64>, Vec<f64>) {
    if fit.frame().keeps_axes() {
        return (contacts.x.clone(), contacts.y.clone());
    }
    (0..contacts.len())
        .map(|r| {
            let [x, y, _] = fit.frame().turn([contacts.x[r], contacts.y[r], contacts.z[r]]);
            (x, y)
        })
        .unzip()
}

fn measured(grid: &Grid) -> usize {
    let has = |array: &Option<ndarray::Array2<f64>>, at| {
        array.as_ref().is_some_and(|a: &ndarray::Array2<f64>| !a[at].is_nan())
    };
    grid.z.indexed_iter().filter(|(at, z)| !z.is_nan() || has(&grid.zx, *at) || has(&grid.zy, *at)).count()
}

fn notes_of(reading: &Reading) -> Vec<String> {
    let mut notes = Vec::new();
    if !reading.ignored.is_empty() {
        notes.push(format!("columns not used: {}", reading.ignored.join(", ")));
    }
    if reading.skipped > 0 {
        notes.push(format!("{} rows with missing or non-finite numbers counted out", reading.skipped));
    }
    notes
}

/// The fault with its file, and its line where it is one contact's.
fn located(error: &FitError, reading: &Reading) -> Failure {
    let index = match error {
        FitError::Outside { index, .. } | FitError::NormalDown { index, .. } | FitError::Steep { index, .. } => {
            Some(*index)
        }
        _ => None,
    };
    let place = index.and_then(|index| Some(format!(", {}", reading.places.as_ref()?.of(index)))).unwrap_or_default();
    Failure::Input(format!("{}{place}: {error}", reading.file))
}
