//! `palpate show SURFACE [--at POINTS]`: a saved surface's shape, or its values at given points.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::fit::FitOptions;
use crate::io::{
    FIT_SCHEMA, MOST_GRID_POINTS, Saved, exceeds, page_content, read_bytes, read_points, read_surface_bytes, schema_of,
};
use crate::report::{FitDocument, ShownGrid, TablePage, describe_saved, points_at, write_table_page};

use super::describe;
use super::failure::{Failure, fit_message};
use super::options::{GridFlags, OutputFlags};
use super::output::print;
use super::provenance::provenance;

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote, or a report.html; - for standard input
    surface: PathBuf,
    /// CSV or NPZ with x and y (of a parametric surface: its u and v under these names): print heights, slopes, normals, k1, k2, S and R there, as CSV
    #[arg(long, value_name = "POINTS", conflicts_with_all = ["grid", "inset"])]
    at: Option<PathBuf>,
    #[command(flatten)]
    grid: GridFlags,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn show(args: &ShowArgs) -> Result<(), Failure> {
    if args.at.as_ref().is_some_and(|at| at == &args.surface && at.as_os_str() == "-") {
        return Err(Failure::Input("SURFACE and --at cannot both be standard input".into()));
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
    args.output.prepare(&inputs, &[])?;
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

fn show_points(args: &ShowArgs, saved: &Saved, at: &Path) -> Result<(), Failure> {
    let points = points_at(saved, &read_points(at)?);
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
    let document: FitDocument = serde_json::from_slice(bytes)
        .map_err(|e| Failure::Input(format!("{}: no whole palpate.fit/1 document: {e}", saved.file)))?;
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
    describe::files(&*description, &saved.file, &args.output, &provenance(&saved.file, None, None))?;
    args.output.publish()?;
    describe::show(description.document(), &saved.file, &args.output, false)
}
