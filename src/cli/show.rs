//! `palpate show SURFACE [--at POINTS]`: a saved surface's shape over a grid, or everything at given points.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::curvature::{curvedness, principal_curvatures};
use crate::fit::FitOptions;
use crate::io::{Saved, read_points, read_surface};
use crate::report::{
    PictureOptions, PointShape, write_json, write_maps_csv, write_maps_npz, write_picture, write_points_csv,
};
use crate::shape::{ShapeGrid, ShapeMaps, Spread, shape_maps, spread};
use crate::surface::HeightField;

use super::failure::Failure;
use super::options::{GridFlags, OutputFlags};
use super::output::print;

/// Arguments of `palpate show`.
#[derive(Args)]
pub(super) struct ShowArgs {
    /// A surface that `fit --save`, `fit --json` or `run --json` wrote; - for standard input
    surface: PathBuf,
    /// CSV or NPZ with columns x, y: print heights, slopes, normals, k1, k2, S and R there as CSV
    #[arg(long, value_name = "POINTS")]
    at: Option<PathBuf>,
    #[command(flatten)]
    grid: GridFlags,
    #[command(flatten)]
    output: OutputFlags,
}

#[derive(Serialize)]
struct PointsDocument<'a> {
    schema: &'static str,
    points: &'a [PointShape],
}

#[derive(Serialize)]
struct ShowDocument {
    schema: &'static str,
    degree: [usize; 2],
    segments: [usize; 2],
    domain: [f64; 4],
    grid: [usize; 2],
    #[serde(rename = "S")]
    shape_index: Means,
    #[serde(rename = "R")]
    curvedness: Means,
    k1: Means,
    k2: Means,
}

#[derive(Serialize)]
struct Means {
    mean: Option<f64>,
    sd: Option<f64>,
}

impl From<Spread> for Means {
    fn from(spread: Spread) -> Means {
        Means { mean: spread.mean, sd: spread.sd }
    }
}

pub(super) fn show(args: &ShowArgs) -> Result<(), Failure> {
    args.output.prepare()?;
    let saved = read_surface(&args.surface)?;
    if let Some(at) = &args.at {
        if at.as_os_str() == "-" && args.surface.as_os_str() == "-" {
            return Err(Failure::Input("SURFACE and --at cannot both be standard input".into()));
        }
        return show_points(args, &saved);
    }
    let mut options = FitOptions::default();
    args.grid.apply(&mut options);
    options.check().map_err(|e| Failure::Input(e.to_string()))?;
    let domain = [saved.surface.knots()[0].domain(), saved.surface.knots()[1].domain()];
    let maps = shape_maps(&saved.surface, ShapeGrid::over(domain, options.grid, options.inset), &[]);
    write_maps(&saved.file, &maps, &args.output)?;
    let document = document(&saved.surface, &maps);
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet { Ok(()) } else { print(&mut |out| table(&saved.file, &document, out)) }
}

fn write_maps(name: &str, maps: &ShapeMaps, output: &OutputFlags) -> Result<(), Failure> {
    output.file("maps.csv", &mut |out| write_maps_csv(maps, out))?;
    output.file("maps.npz", &mut |out| write_maps_npz(maps, out))?;
    let picture = PictureOptions { title: name, contacts: None };
    output.file("shape.svg", &mut |out| write_picture(maps, &picture, out))
}

fn document(surface: &HeightField, maps: &ShapeMaps) -> ShowDocument {
    let knots = surface.knots();
    let [[x0, x1], [y0, y1]] = [knots[0].domain(), knots[1].domain()];
    let defined = maps.shape_index.iter().copied().filter(|s| !s.is_nan());
    ShowDocument {
        schema: "palpate.show/1",
        degree: [knots[0].degree(), knots[1].degree()],
        segments: [knots[0].n_segments(), knots[1].n_segments()],
        domain: [x0, x1, y0, y1],
        grid: [maps.grid.x.len(), maps.grid.y.len()],
        shape_index: spread(defined).into(),
        curvedness: spread(maps.curvedness.iter().copied()).into(),
        k1: spread(maps.k1.iter().copied()).into(),
        k2: spread(maps.k2.iter().copied()).into(),
    }
}

fn table(name: &str, document: &ShowDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let ([p, q], [n, m], [gx, gy]) = (document.degree, document.segments, document.grid);
    let [x0, x1, y0, y1] = document.domain;
    writeln!(out, "surface    {name}: degree {p} x {q}, segments {n} x {m}")?;
    writeln!(out, "domain     x {x0} to {x1}, y {y0} to {y1}")?;
    writeln!(out, "grid       {gx} x {gy} points")?;
    let rows = [("S", &document.shape_index), ("R", &document.curvedness), ("k1", &document.k1), ("k2", &document.k2)];
    for (label, means) in rows {
        match (means.mean, means.sd) {
            (Some(mean), Some(sd)) => writeln!(out, "{label:<10} {mean:.6} +- {sd:.6} over the patch")?,
            _ => writeln!(out, "{label:<10} undefined")?,
        }
    }
    Ok(())
}

fn show_points(args: &ShowArgs, saved: &Saved) -> Result<(), Failure> {
    let Some(at) = &args.at else { return Ok(()) };
    let points = read_points(at)?;
    let shapes: Vec<PointShape> =
        points.x.iter().zip(&points.y).map(|(x, y)| at_point(&saved.surface, *x, *y)).collect();
    args.output.file("points.csv", &mut |out| write_points_csv(&shapes, out))?;
    if args.output.json {
        let document = PointsDocument { schema: "palpate.points/1", points: &shapes };
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet { Ok(()) } else { print(&mut |out| write_points_csv(&shapes, out)) }
}

fn at_point(surface: &HeightField, x: f64, y: f64) -> PointShape {
    let [[x0, x1], [y0, y1]] = [surface.knots()[0].domain(), surface.knots()[1].domain()];
    let point = surface.at(x, y);
    let principal = principal_curvatures(&point.derivatives());
    PointShape {
        x,
        y,
        inside: (x0..=x1).contains(&x) && (y0..=y1).contains(&y),
        z: point.z,
        zx: point.zx,
        zy: point.zy,
        normal: point.normal(),
        k1: principal.map(|p| p.k1),
        k2: principal.map(|p| p.k2),
        shape_index: principal.and_then(|p| p.shape_index()),
        curvedness: principal.map(|p| curvedness(p.k1, p.k2)),
    }
}
