//! `palpate show SURFACE [--at POINTS | --save FILE]`: a saved surface's shape, its values at given points, or the surface in
//! another format.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::fit::FitOptions;
use crate::io::{MOST_GRID_POINTS, Saved, exceeds, is_cad, read_bytes, read_points, read_surface_bytes};
use crate::report::{FitDocument, ShownGrid, describe_saved, document_of_surface, points_at};

use super::describe;
use super::failure::{Failure, fit_message};
use super::options::{GridFlags, OutputFlags, WordsFlags};
use super::output::print;
use super::save::{check_name, save};

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote, or a STEP or IGES file of one B-spline surface; - for standard input
    surface: PathBuf,
    /// Write the surface to .step, .igs, .npz, .json, or as a mesh to .ply, .obj, .stl, .glb, .vtu, or its points to .parquet, of --grid points each way [default: 49x49]
    #[arg(long, value_name = "F", conflicts_with_all = ["at", "inset"])]
    save: Option<PathBuf>,
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
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    let (file, bytes) = read_bytes(&args.surface)?;
    let saved = read_surface_bytes(&file, &bytes)?;
    let inputs: Vec<&Path> = std::iter::once(&args.surface).chain(&args.at).map(PathBuf::as_path).collect();
    args.output.prepare(&inputs, args.save.as_slice())?;
    check_name(args.save.as_deref())?;
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
    let (mut document, again) = document(saved, bytes)?;
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
    if let Some(path) = &args.save {
        // the grid is the mesh's, and the document is saved as it was
        save(path, &document, &saved.file, args.grid.points(), args.output.quiet)?;
        if args.output.out.is_none() && !args.output.json {
            return Ok(());
        }
    }
    let grid = ShownGrid { points: options.grid, inset: options.inset, again: again || args.grid.any() };
    let description = describe_saved(saved, document, grid);
    describe::files(&*description, None, &saved.file, &args.output)?;
    args.output.publish()?;
    describe::show(&*description, &saved.file, &args.output, &args.words, false)
}

/// The document that the surface was saved in, or one of the surface alone, whose shape is still to be taken.
fn document(saved: &Saved, bytes: &[u8]) -> Result<(FitDocument, bool), Failure> {
    if is_cad(bytes) {
        return Ok((document_of_surface(saved), true));
    }
    let document = serde_json::from_slice(bytes)
        .map_err(|e| Failure::Input(format!("{}: no whole palpate.fit/1 document: {e}", saved.file)))?;
    Ok((document, false))
}
