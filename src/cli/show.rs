//! `palpate show SURFACE [--at POINTS]`: a saved surface's shape, or its values at given points.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::curvature::{ShapeClass, principal_curvatures};
use crate::fit::FitOptions;
use crate::io::{AnySurface, Saved, read_bytes, read_points, read_surface_bytes};
use crate::report::{
    FitDocument, MeasurePart, PictureOptions, PointShape, write_json, write_maps_csv, write_maps_npz, write_picture,
    write_points_csv, write_table,
};
use crate::shape::{ShapeGrid, ShapeMaps, Spread, radius_of, shape_maps, spread};
use crate::surface::HeightField;

use super::describe::{headline, picture_maps, spread_part};
use super::failure::Failure;
use super::options::{GridFlags, OutputFlags};
use super::output::print;
use super::show_parametric;

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// What `--save` or `--json` wrote; - for standard input
    surface: PathBuf,
    /// CSV or NPZ with x and y (of a parametric surface: its u and v under these names): print heights, slopes, normals, k1, k2, S and R there, as CSV
    #[arg(long, value_name = "POINTS", conflicts_with_all = ["grid", "inset"])]
    at: Option<PathBuf>,
    #[command(flatten)]
    pub(super) grid: GridFlags,
    #[command(flatten)]
    pub(super) output: OutputFlags,
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
    match (&saved.surface, &args.at) {
        (AnySurface::Height(surface), Some(at)) => show_points(args, &saved, surface, at),
        (AnySurface::Height(surface), None) => show_shape(args, &saved, surface, &bytes),
        (AnySurface::Parametric(surface, support), Some(at)) => show_parametric::points(args, surface, support, at),
        (AnySurface::Parametric(surface, support), None) => {
            show_parametric::shape(args, &saved, surface, support, &bytes)
        }
    }
}

fn show_points(args: &ShowArgs, saved: &Saved, surface: &HeightField, at: &std::path::Path) -> Result<(), Failure> {
    let places = read_points(at)?;
    let points: Vec<PointShape> = places.x.iter().zip(&places.y).map(|(x, y)| point(saved, surface, *x, *y)).collect();
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

fn point(saved: &Saved, surface: &HeightField, x: f64, y: f64) -> PointShape {
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
        normal: if saved.frame.keeps_axes() { normal } else { saved.frame.rotate_back(normal) },
        k1: principal.map(|p| p.k1),
        k2: principal.map(|p| p.k2),
        shape_index: principal.and_then(|p| p.shape_index()),
        curvedness: principal.map(|p| p.curvedness()),
    }
}

fn show_shape(args: &ShowArgs, saved: &Saved, surface: &HeightField, bytes: &[u8]) -> Result<(), Failure> {
    let mut document = whole(saved, bytes)?;
    let mut options = FitOptions { grid: document.shape.grid, ..FitOptions::default() };
    args.grid.apply(&mut options);
    options.check().map_err(|e| Failure::Input(e.to_string()))?;
    let domain = [0, 1].map(|k| surface.knots()[k].domain());
    let grid = ShapeGrid::over(domain, options.grid, options.inset);
    let maps = shape_maps(surface, grid, &saved.unsupported);
    if args.grid.any() {
        take_again(&mut document, &spreads(&maps));
    }
    args.output.file("fit.json", &mut |out| write_json(&document, out))?;
    args.output.file("maps.csv", &mut |out| write_maps_csv(&maps, out))?;
    args.output.file("maps.npz", &mut |out| write_maps_npz(&maps, out))?;
    let title = headline(&saved.file, &document);
    let fine = picture_maps(surface, options.grid, &saved.unsupported);
    let picture = PictureOptions { title: &title, ..PictureOptions::default() };
    args.output.file("shape.svg", &mut |out| write_picture(&fine, &picture, out))?;
    finish(args, saved, &document)
}

/// All of the document, not only its surface.
pub(super) fn whole(saved: &Saved, bytes: &[u8]) -> Result<FitDocument, Failure> {
    serde_json::from_slice(bytes)
        .map_err(|e| Failure::Input(format!("{}: no whole palpate.fit/1 document: {e}", saved.file)))
}

/// The document on standard output.
pub(super) fn finish(args: &ShowArgs, saved: &Saved, document: &FitDocument) -> Result<(), Failure> {
    if args.output.json {
        return print(&mut |out| write_json(document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_table(&saved.file, document, out))
}

/// What a shape over another grid is made of.
pub(super) struct Again {
    pub(super) grid: [usize; 2],
    pub(super) spreads: [Spread; 4],
}

/// The shape over another grid. The covariance is not saved, so what came from it is undefined now; whether the patch
/// is a plane was decided with it, and stays.
pub(super) fn take_again(document: &mut FitDocument, again: &Again) {
    let [s, r, k1, k2] = again.spreads;
    let plane = document.shape.class.as_deref() == Some(ShapeClass::Plane.name());
    let class = s.mean.filter(|_| !plane).map(ShapeClass::of_shape_index);
    let measure = |spread: Spread| MeasurePart { mean: spread.mean, sd: spread.sd, u: None, interval: None };
    let shape = &mut document.shape;
    shape.grid = again.grid;
    shape.shape_index = if plane { MeasurePart::default() } else { measure(s) };
    shape.curvedness = measure(r);
    if !plane {
        shape.class = class.map(|c| c.name().to_string());
    }
    shape.class_probability = None;
    shape.radius = class.zip(r.mean).and_then(|(class, mean)| radius_of(class, mean));
    (shape.k1, shape.k2) = (spread_part(k1), spread_part(k2));
    shape.support = s.count as f64 / (again.grid[0] * again.grid[1]) as f64;
    document.truth = None;
    document.fit.notes.push("shape taken again over another grid: its uncertainty is not saved".into());
}

fn spreads(maps: &ShapeMaps) -> Again {
    let places: Vec<(usize, usize)> = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at).collect();
    let over = |value: &dyn Fn(usize, usize) -> Option<f64>| -> Spread {
        spread(places.iter().filter_map(|(i, j)| value(*i, *j)).collect::<Vec<_>>().into_iter())
    };
    Again {
        grid: [maps.grid.x.len(), maps.grid.y.len()],
        spreads: [
            over(&|i, j| maps.shape_index_at(i, j)),
            over(&|i, j| maps.curvedness_at(i, j)),
            over(&|i, j| Some(maps.k1[[i, j]])),
            over(&|i, j| Some(maps.k2[[i, j]])),
        ],
    }
}
