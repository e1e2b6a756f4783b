//! `palpate show` of a surface in space.

use std::path::Path;

use serde::Serialize;

use super::describe::headline;
use super::describe_parametric::picture_maps;
use super::failure::Failure;
use super::output::print;
use super::show::{Again, ShowArgs, finish, take_again, whole};
use crate::fit::FitOptions;
use crate::io::{Saved, read_points};
use crate::report::{
    ParametricPointShape, PictureOptions, write_json, write_maps_npz, write_parametric_maps_csv,
    write_parametric_points_csv, write_picture,
};
use crate::shape::{ParametricMaps, UvSupport, parametric_maps, spread, uv_grid};
use crate::surface::Parametric;

#[derive(Serialize)]
struct PointsDocument<'a> {
    schema: &'static str,
    points: &'a [ParametricPointShape],
}

/// Its values at given (u, v).
pub(super) fn points(args: &ShowArgs, surface: &Parametric, support: &UvSupport, at: &Path) -> Result<(), Failure> {
    let places = read_points(at)?;
    let points: Vec<ParametricPointShape> =
        places.x.iter().zip(&places.y).map(|(u, v)| point(surface, support, *u, *v)).collect();
    args.output.file("points.csv", &mut |out| write_parametric_points_csv(&points, out))?;
    if args.output.json {
        let document = PointsDocument { schema: "palpate.space_points/1", points: &points };
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_parametric_points_csv(&points, out))
}

fn point(surface: &Parametric, support: &UvSupport, u: f64, v: f64) -> ParametricPointShape {
    let here = surface.at(u, v);
    let principal = here.principal();
    ParametricPointShape {
        u,
        v,
        inside: support.holds(u, v),
        point: here.point,
        normal: principal.map(|p| p.normal),
        k1: principal.map(|p| p.k1),
        k2: principal.map(|p| p.k2),
        direction: principal.map(|p| p.direction1),
        shape_index: principal.and_then(|p| p.shape_index()),
        curvedness: principal.map(|p| p.curvedness()),
    }
}

/// Its shape over the saved grid or another.
pub(super) fn shape(
    args: &ShowArgs,
    saved: &Saved,
    surface: &Parametric,
    support: &UvSupport,
    bytes: &[u8],
) -> Result<(), Failure> {
    let mut document = whole(saved, bytes)?;
    let mut options = FitOptions { grid: document.shape.grid, ..FitOptions::default() };
    args.grid.apply(&mut options);
    options.check().map_err(|e| Failure::Input(e.to_string()))?;
    let knots = [0, 1].map(|k| &surface.knots()[k]);
    let maps = parametric_maps(surface, uv_grid(knots, options.grid, options.inset), support);
    if args.grid.any() {
        take_again(&mut document, &spreads(&maps));
    }
    args.output.file("fit.json", &mut |out| write_json(&document, out))?;
    args.output.file("maps.csv", &mut |out| write_parametric_maps_csv(&maps, out))?;
    args.output.file("maps.npz", &mut |out| write_maps_npz(&maps.flat(), out))?;
    let title = headline(&saved.file, &document);
    let fine = picture_maps(surface, options.grid, support);
    let picture = PictureOptions { title: &title, contacts: None, axes: ["u", "v"] };
    args.output.file("shape.svg", &mut |out| write_picture(&fine.flat(), &picture, out))?;
    finish(args, saved, &document)
}

fn spreads(maps: &ParametricMaps) -> Again {
    Again {
        grid: [maps.grid.x.len(), maps.grid.y.len()],
        spreads: [&maps.shape_index, &maps.curvedness, &maps.k1, &maps.k2].map(|map| spread(maps.defined(map))),
    }
}
