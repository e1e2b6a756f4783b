//! A height field at places of the user's choice: `show --at`.

use std::io::Write;

use serde::Serialize;

use crate::io::Points;
use palpate_geometry::contact::Frame;
use palpate_geometry::surface::Heights;

use super::json::write_json;
use super::point_table::PointTable;

/// Heights, slopes, normal and shape at one point. Input units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PointShape {
    /// As given.
    pub x: f64,
    /// As given.
    pub y: f64,
    /// Whether the point lies in the surface's domain; outside, the end polynomial is shown.
    pub inside: bool,
    /// Height.
    pub z: f64,
    /// dz/dx.
    pub zx: f64,
    /// dz/dy.
    pub zy: f64,
    /// Unit normal to the free side.
    pub normal: [f64; 3],
    /// Larger principal curvature.
    pub k1: Option<f64>,
    /// Smaller principal curvature.
    pub k2: Option<f64>,
    /// Shape index.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Curvedness.
    #[serde(rename = "R")]
    pub curvedness: Option<f64>,
}

/// A height field at given places.
#[derive(Serialize)]
pub(super) struct HeightPoints {
    schema: &'static str,
    /// Axes of the frame that the places lie along.
    axes: [[f64; 3]; 3],
    points: Vec<PointShape>,
}

impl HeightPoints {
    pub(super) fn of(surface: &dyn Heights, frame: &Frame, places: &Points) -> HeightPoints {
        let points = places.x.iter().zip(&places.y).map(|(x, y)| point(surface, frame, *x, *y)).collect();
        HeightPoints { schema: "palpate.points/1", axes: frame.axes, points }
    }
}

impl PointTable for HeightPoints {
    fn write_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_points_csv(&self.points, out)
    }

    fn write_json(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_json(self, out)
    }
}

fn point(surface: &dyn Heights, frame: &Frame, x: f64, y: f64) -> PointShape {
    let here = surface.height_at(x, y);
    let principal = here.derivatives().principal();
    let within = |k: usize, v: f64| {
        let [lo, hi] = surface.domain()[k];
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
        normal: if frame.keeps_axes() { normal } else { frame.rotate_back(normal) },
        k1: principal.map(|p| p.k1),
        k2: principal.map(|p| p.k2),
        shape_index: principal.and_then(|p| p.shape_index()),
        curvedness: principal.map(|p| p.curvedness()),
    }
}

/// `x,y,inside,z,zx,zy,nx,ny,nz,k1,k2,S,R`, one row a point, empty where undefined.
///
/// # Errors
/// What the system says.
pub(super) fn write_points_csv(points: &[PointShape], out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("x,y,inside,z,zx,zy,nx,ny,nz,k1,k2,S,R\n");
    // far outside the domain the end polynomial leaves the range of numbers: undefined, as in the JSON
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    let entry = |value: Option<f64>| value.map_or(String::new(), number);
    for p in points {
        let ([nx, ny, nz], inside) = (p.normal.map(number), u8::from(p.inside));
        let [z, zx, zy] = [p.z, p.zx, p.zy].map(number);
        let [k1, k2, s, r] = [p.k1, p.k2, p.shape_index, p.curvedness].map(entry);
        let row = format!("{},{},{inside},{z},{zx},{zy},{nx},{ny},{nz},{k1},{k2},{s},{r}\n", p.x, p.y);
        text.push_str(&row);
    }
    out.write_all(text.as_bytes())
}
