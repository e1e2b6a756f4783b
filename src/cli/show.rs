//! `palpate show SURFACE [--at POINTS]`: a saved surface's shape, or its values at given points.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::fit::FitOptions;
use crate::io::{MOST_GRID_POINTS, Saved, exceeds, read_bytes, read_points, read_surface_bytes};
use crate::report::{FitDocument, ShownGrid, describe_saved, points_at};

use super::describe;
use super::failure::{Failure, fit_message};
use super::options::{GridFlags, OutputFlags, WordsFlags};
use super::output::print;

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote; - for standard input
    surface: PathBuf,
    /// CSV or NPZ with x and y (of a parametric surface: its u and v under these names): print heights, slopes, normals, k1, k2, S and R there, as CSV
    #[arg(long, value_name = "POINTS", conflicts_with_all = ["grid", "inset"])]
    at: Option<PathBuf>,
    #[command(flatten)]
    grid: GridFlags,
    #[command(flatten)]
    words: WordsFlags,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn show(args: &ShowArgs) -> Result<(), Failure> {
    if args.at.as_ref().is_some_and(|at| at == &args.surface && at.as_os_str() == "-") {
        return Err(Failure::Input("SURFACE and --at cannot both be standard input".into()));
    }
    let (file, bytes) = read_bytes(&args.surface)?;
    let saved = read_surface_bytes(&file, &bytes)?;
    let inputs: Vec<&Path> = std::iter::once(&args.surface).chain(&args.at).map(PathBuf::as_path).collect();
    args.output.prepare(&inputs, &[])?;
    match &args.at {
        Some(at) => show_points(args, &saved, at),
        None => show_shape(args, &saved, &bytes),
    }
}

fn show_points(args: &ShowArgs, saved: &Saved, at: &Path) -> Result<(), Failure> {
    let points = points_at(saved, &read_points(at)?);
    args.output.file("points.csv", &mut |out| points.write_csv(out))?;
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| points.write_json(out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| points.write_csv(out))
}

fn show_shape(args: &ShowArgs, saved: &Saved, bytes: &[u8]) -> Result<(), Failure> {
    let mut document: FitDocument = serde_json::from_slice(bytes)
        .map_err(|e| Failure::Input(format!("{}: no whole palpate.fit/1 document: {e}", saved.file)))?;
    if args.words.unit.is_some() {
        document.unit.clone_from(&args.words.unit);
    }
    let mut options = FitOptions::default().with_grid(document.shape.grid[0], document.shape.grid[1]);
    args.grid.apply(&mut options);
    if exceeds(options.grid, MOST_GRID_POINTS) {
        let [n, m] = options.grid;
        return Err(Failure::Input(format!(
            "{}: a shape grid of {n} x {m} points is too large; give --grid",
            saved.file
        )));
    }
    options.check().map_err(|e| Failure::Input(fit_message(&e)))?;
    let grid = ShownGrid { points: options.grid, inset: options.inset, again: args.grid.any() };
    let description = describe_saved(saved, document, grid);
    describe::files(&*description, &saved.file, &args.output)?;
    args.output.publish()?;
    describe::show(&*description, &saved.file, &args.output, &args.words, false)
}
