//! `palpate show SURFACE [--at POINTS | --save FILE]`: a saved surface's shape, its values at given points, or the surface in
//! another format.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::io::{
    AnySurface, FIT_SCHEMA, MOST_GRID_POINTS, Saved, exceeds, is_cad, page_content, read_bytes, read_points,
    read_surface_bytes, schema_of,
};
use crate::report::{
    FitDocument, ShownGrid, TablePage, describe_saved, document_of_surface, points_at, write_table_page,
};
use palpate_fitting::fit::FitOptions;

use super::describe;
use super::failure::{Failure, fit_message};
use super::options::{GridFlags, OutputFlags, WordsFlags};
use super::output::print;
use super::provenance::provenance;
use super::save::{check_name, save};

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote, a report.html, or a STEP or IGES file of one B-spline surface; - for standard input
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
    let (bytes, table) = match page_content(&file, &bytes)? {
        Some(page) => (page.document, Some(page.table)),
        None => (bytes, None),
    };
    if let (Some(table), Some(schema)) = (table, schema_of(&bytes).filter(|schema| schema != FIT_SCHEMA)) {
        return show_page(args, &file, &schema, &bytes, &table);
    }
    let saved = read_surface_bytes(&file, &bytes)?;
    let inputs: Vec<&Path> = std::iter::once(&args.surface).chain(&args.at).map(PathBuf::as_path).collect();
    args.output.prepare(&inputs, args.save.as_slice())?;
    check_name(args.save.as_deref())?;
    match &args.at {
        Some(at) => show_points(args, &saved, at),
        None => show_shape(args, &saved, &bytes),
    }
}

/// A page that holds no surface: its document, or the table that was printed with it.
fn show_page(args: &ShowArgs, file: &str, schema: &str, document: &[u8], table: &str) -> Result<(), Failure> {
    let kind = schema.split(['.', '/']).nth(1).unwrap_or("document");
    if args.at.is_some() || args.grid.any() {
        return Err(Failure::Input(format!(
            "{file}: holds a {kind} ({schema}) and no surface; leave out --at, --grid and --inset"
        )));
    }
    args.output.prepare(&[&args.surface], &[])?;
    args.output.file(&format!("{kind}.json"), &mut |out| out.write_all(document))?;
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| out.write_all(document));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| out.write_all(table.as_bytes()))
}

/// Words and pictures tell of a whole surface, a table of points has neither.
fn check_words(words: &WordsFlags) -> Result<(), Failure> {
    let typed = [(words.verbose, "--verbose"), (words.unit.is_some(), "--unit"), (words.pictures.any(), "--pictures")];
    match typed.iter().find(|(typed, _)| *typed) {
        Some((_, option)) => {
            Err(Failure::Input(format!("{option} changes nothing of the table of --at; leave it out")))
        }
        None => Ok(()),
    }
}

fn show_points(args: &ShowArgs, saved: &Saved, at: &Path) -> Result<(), Failure> {
    check_words(&args.words)?;
    let points = points_at(saved, &read_points(at)?);
    if let (AnySurface::Height(_), false) = (&saved.surface, saved.frame.keeps_axes()) {
        let file = &saved.file;
        let what = "the surface has axes of its own: x, y, z and slopes are along these, normals along the input's";
        // standard output is the table
        let _ = writeln!(std::io::stderr(), "palpate: {file}: {what}; --json tells the axes");
    }
    args.output.file("points.csv", &mut |out| points.write_csv(out))?;
    let (mut json, mut table) = (Vec::new(), Vec::new());
    // a Vec takes every byte
    let _ = points.write_json(&mut json).and_then(|()| points.write_csv(&mut table));
    let page = TablePage {
        kind: "a saved surface at given points",
        title: &saved.file,
        lead: "Heights, slopes, normals, curvatures, S and R at the points that were asked for.",
        document: &json,
        table: &table,
    };
    let provenance = provenance(&saved.file, None, None);
    args.output.file("report.html", &mut |out| write_table_page(&page, &provenance, out))?;
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
    describe::files(&description, None, &saved.file, &args.output, &args.words, &provenance(&saved.file, None, None))?;
    args.output.publish()?;
    describe::show(&description, &saved.file, &args.output, &args.words, false)
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
