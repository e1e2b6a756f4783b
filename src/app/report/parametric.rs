//! A parametric surface as tables: its maps over (u, v), and its values at (u, v) of the user's choice.

use std::io::Write;

use ndarray::Array2;
use serde::Serialize;

use crate::io::{PointUncertainty, Points};
use palpate_geometry::shape::{ParametricMaps, UvSupport};
use palpate_geometry::surface::Parametric;

use super::json::write_json;
use super::maps::{UNCERTAINTIES, after_a_comma, numbers_of};
use super::point_table::PointTable;

/// Point, normal and shape at one (u, v). Input units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ParametricPointShape {
    /// As given.
    pub u: f64,
    /// As given.
    pub v: f64,
    /// Whether contacts surround it.
    pub inside: bool,
    /// Q(u, v).
    pub point: [f64; 3],
    /// Unit normal to the free side.
    pub normal: Option<[f64; 3]>,
    /// Larger principal curvature.
    pub k1: Option<f64>,
    /// Smaller principal curvature.
    pub k2: Option<f64>,
    /// Unit direction of k1.
    pub direction: Option<[f64; 3]>,
    /// Shape index.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Curvedness.
    #[serde(rename = "R")]
    pub curvedness: Option<f64>,
}

/// A parametric surface at given (u, v), which are read under the names x and y.
#[derive(Serialize)]
pub(super) struct ParametricPoints {
    schema: &'static str,
    points: Vec<ParametricPointShape>,
}

impl ParametricPoints {
    pub(super) fn of(surface: &Parametric, support: &UvSupport, places: &Points) -> ParametricPoints {
        let points = places.x.iter().zip(&places.y).map(|(u, v)| point(surface, support, *u, *v)).collect();
        ParametricPoints { schema: "palpate.space_points/1", points }
    }
}

impl PointTable for ParametricPoints {
    fn write_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_parametric_points_csv(&self.points, out)
    }

    fn write_json(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_json(self, out)
    }
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

const HEADER: &str = "u,v,inside,x,y,z,nx,ny,nz,k1,k2,dx,dy,dz,S,R";

/// `u,v,inside,x,y,z,nx,ny,nz,k1,k2,dx,dy,dz,S,R`, one row a point, empty where undefined; d is the direction of k1.
///
/// # Errors
/// What the system says.
pub(super) fn write_parametric_points_csv(points: &[ParametricPointShape], out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = format!("{HEADER}\n");
    for p in points {
        text.push_str(&row(p));
        text.push('\n');
    }
    out.write_all(text.as_bytes())
}

/// The same rows for every point of the maps, u-major, with the uncertainties.
///
/// # Errors
/// What the system says.
pub(super) fn write_parametric_maps_csv(
    maps: &ParametricMaps,
    uncertainty: &Array2<PointUncertainty>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = format!("{HEADER},{}\n", UNCERTAINTIES.join(","));
    for (i, u) in maps.grid.x.iter().enumerate() {
        for (j, v) in maps.grid.y.iter().enumerate() {
            let at = (i, j);
            let inside = maps.supported[at];
            let number = |value: f64| (inside && !value.is_nan()).then_some(value);
            let vector = |value: [f64; 3]| (inside && !value[0].is_nan()).then_some(value);
            text.push_str(&row(&ParametricPointShape {
                u: *u,
                v: *v,
                inside,
                point: maps.points[at],
                normal: vector(maps.normals[at]),
                k1: number(maps.k1[at]),
                k2: number(maps.k2[at]),
                direction: vector(maps.direction[at]),
                shape_index: number(maps.shape_index[at]),
                curvedness: number(maps.curvedness[at]),
            }));
            text.extend(numbers_of(&uncertainty[at]).map(after_a_comma));
            text.push('\n');
        }
    }
    out.write_all(text.as_bytes())
}

/// One row, without its end.
fn row(p: &ParametricPointShape) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    let vector = |value: Option<[f64; 3]>| value.map_or(",,".into(), |[x, y, z]| format!("{x},{y},{z}"));
    let [x, y, z] = p.point;
    let [k1, k2, s, r] = [p.k1, p.k2, p.shape_index, p.curvedness].map(number);
    let (normal, direction) = (vector(p.normal), vector(p.direction));
    format!("{},{},{},{x},{y},{z},{normal},{k1},{k2},{direction},{s},{r}", p.u, p.v, u8::from(p.inside))
}
