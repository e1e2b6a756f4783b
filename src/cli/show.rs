//! `palpate show SURFACE [--at POINTS]`: a saved surface's shape, or its values at given points.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::curvature::{ShapeClass, principal_curvatures};
use crate::fit::FitOptions;
use crate::io::{Saved, read_bytes, read_points, read_surface_bytes};
use crate::report::{
    FitDocument, MeasurePart, PictureOptions, PointShape, write_json, write_maps_csv, write_maps_npz, write_picture,
    write_points_csv, write_table,
};
use crate::shape::{ShapeGrid, ShapeMaps, Spread, radius_of, shape_maps, spread};

use super::describe::{headline, picture_maps, spread_part};
use super::failure::Failure;
use super::options::{GridFlags, OutputFlags};
use super::output::print;

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote; - for standard input
    surface: PathBuf,
    /// CSV or NPZ with x and y: print heights, slopes, normals, k1, k2, S and R there, as CSV
    #[arg(long, value_name = "POINTS", conflicts_with_all = ["grid", "inset"])]
    at: Option<PathBuf>,
    #[command(flatten)]
    grid: GridFlags,
    #[command(flatten)]
    output: OutputFlags,
}

#[derive(Serialize)]
struct PointsDocument<'a> {
    schema: &'static str,
    axes: [[f64; 3]; 3],
    points: &'a [PointShape],
}

pub(super) fn show(args: &ShowArgs) -> Result<(), Failure> {
    if args.at.as_ref().is_some_and(|at| at == &args.surface && at.as_os_str() == "-") {
        return Err(Failure::Input("SURFACE and --at cannot both be standard input".into()));
    }
    let (file, bytes) = read_bytes(&args.surface)?;
    let saved = read_surface_bytes(&file, &bytes)?;
    args.output.prepare()?;
    match &args.at {
        Some(at) => show_points(args, &saved, at),
        None => show_shape(args, &saved, &bytes),
    }
}

fn show_points(args: &ShowArgs, saved: &Saved, at: &std::path::Path) -> Result<(), Failure> {
    let places = read_points(at)?;
    let points: Vec<PointShape> = places.x.iter().zip(&places.y).map(|(x, y)| point(saved, *x, *y)).collect();
    args.output.file("points.csv", &mut |out| write_points_csv(&points, out))?;
    if args.output.json {
        let document = PointsDocument { schema: "palpate.points/1", axes: saved.frame.axes, points: &points };
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_points_csv(&points, out))
}

fn point(saved: &Saved, x: f64, y: f64) -> PointShape {
    let surface = &saved.surface;
    let here = surface.at(x, y);
    let principal = principal_curvatures(&here.derivatives());
    let within = |k: usize, v: f64| {
        let [lo, hi] = surface.knots()[k].domain();
        (lo..=hi).contains(&v)
    };
    let normal = here.normal();
    PointShape {
        x,
        y,
        inside: within(0, x) && within(1, y),
        z: here.z,
        zx: here.zx,
        zy: here.zy,
        normal: if saved.frame.keeps_axes() { normal } else { saved.frame.turn_back(normal) },
        k1: principal.map(|p| p.k1),
        k2: principal.map(|p| p.k2),
        shape_index: principal.and_then(|p| p.shape_index()),
        curvedness: principal.map(|p| p.curvedness()),
    }
}

fn show_shape(args: &ShowArgs, saved: &Saved, bytes: &[u8]) -> Result<(), Failure> {
    let mut document: FitDocument = serde_json::from_slice(bytes)
        .map_err(|e| Failure::Input(format!("{}: no whole palpate.fit/1 document: {e}", saved.file)))?;
    let mut options = FitOptions { grid: document.shape.grid, ..FitOptions::default() };
    args.grid.apply(&mut options);
    options.check().map_err(|e| Failure::Input(e.to_string()))?;
    let domain = [0, 1].map(|k| saved.surface.knots()[k].domain());
    let grid = ShapeGrid::over(domain, options.grid, options.inset);
    let maps = shape_maps(&saved.surface, grid, &saved.unsupported);
    if args.grid.any() {
        take_again(&mut document, &maps);
    }
    args.output.file("fit.json", &mut |out| write_json(&document, out))?;
    args.output.file("maps.csv", &mut |out| write_maps_csv(&maps, out))?;
    args.output.file("maps.npz", &mut |out| write_maps_npz(&maps, out))?;
    let title = headline(&saved.file, &document);
    let fine = picture_maps(&saved.surface, options.grid, &saved.unsupported);
    let picture = PictureOptions { title: &title, contacts: None };
    args.output.file("shape.svg", &mut |out| write_picture(&fine, &picture, out))?;
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_table(&saved.file, &document, out))
}

/// The shape over another grid. The covariance is not saved, so what came from it is undefined now; whether the patch
/// is a plane was decided with it, and stays.
fn take_again(document: &mut FitDocument, maps: &ShapeMaps) {
    let places: Vec<(usize, usize)> = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at).collect();
    let over = |value: &dyn Fn(usize, usize) -> Option<f64>| -> Spread {
        spread(places.iter().filter_map(|(i, j)| value(*i, *j)).collect::<Vec<_>>().into_iter())
    };
    let s = over(&|i, j| maps.shape_index_at(i, j));
    let r = over(&|i, j| maps.curvedness_at(i, j));
    let plane = document.shape.class.as_deref() == Some(ShapeClass::Plane.name());
    let class = s.mean.filter(|_| !plane).map(ShapeClass::of_shape_index);
    let measure = |spread: Spread| MeasurePart { mean: spread.mean, sd: spread.sd, u: None, interval: None };
    let shape = &mut document.shape;
    shape.grid = [maps.grid.x.len(), maps.grid.y.len()];
    shape.shape_index = if plane { MeasurePart::default() } else { measure(s) };
    shape.curvedness = measure(r);
    if !plane {
        shape.class = class.map(|c| c.name().to_string());
    }
    shape.class_probability = None;
    shape.radius = class.zip(r.mean).and_then(|(class, mean)| radius_of(class, mean));
    shape.k1 = spread_part(over(&|i, j| Some(maps.k1[[i, j]])));
    shape.k2 = spread_part(over(&|i, j| Some(maps.k2[[i, j]])));
    shape.support = s.count as f64 / maps.grid.len() as f64;
    document.truth = None;
    document.fit.notes.push("shape taken again over another grid: its uncertainty is not saved".into());
}
