//! The surface as triangles, where contacts support it, with its shape at every vertex.
//!
//! ```text
//! vertices   points of a grid over the domain, of which those that contacts support are kept
//! triangles  two a cell, around their normal to the free side; a cell with a corner that is not supported gives none
//! ```

use ndarray::Array2;

use crate::io::surface_file::{AnySurface, Saved};
use crate::io::uncertainty_map::PointUncertainty;
use palpate_geometry::shape::{ShapeGrid, ShapeMaps, parametric_maps, uv_grid};
use palpate_geometry::surface::Surface;

/// Triangles with the shape at their corners.
#[derive(Clone, Debug)]
pub(super) struct SurfaceMesh {
    /// Input coordinates.
    pub(super) points: Vec<[f64; 3]>,
    /// Unit normals to the free side, input axes.
    pub(super) normals: Vec<[f64; 3]>,
    /// Corners, to the left around the normal.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Numbers at every vertex under the names that every format takes; NaN where undefined.
    pub(super) fields: Vec<(&'static str, Vec<f64>)>,
}

/// One vertex before it is known whether any triangle needs it.
struct Vertex {
    point: [f64; 3],
    normal: [f64; 3],
    shape: [f64; 4],
    place: [f64; 2],
}

impl SurfaceMesh {
    /// Triangles between `points` vertices each way, cut at the support.
    ///
    /// # Errors
    /// When contacts support no cell of the grid.
    pub(super) fn of(saved: &Saved, points: [usize; 2]) -> Result<SurfaceMesh, String> {
        let (vertices, closed) = vertices(saved, points);
        let cells = [0, 1].map(|k| {
            let count = if k == 0 { vertices.nrows() } else { vertices.ncols() };
            if closed[k] { count } else { count.saturating_sub(1) }
        });
        let mut numbers = Array2::from_elem(vertices.dim(), u32::MAX);
        let mut mesh = SurfaceMesh { points: vec![], normals: vec![], triangles: vec![], fields: vec![] };
        let mut kept: Vec<&Vertex> = Vec::new();
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                let (next, above) = ((i + 1) % vertices.nrows(), (j + 1) % vertices.ncols());
                let corners = [(i, j), (next, j), (next, above), (i, above)];
                if corners.iter().any(|at| vertices[*at].is_none()) {
                    continue;
                }
                let [a, b, c, d] = corners.map(|at| {
                    if numbers[at] == u32::MAX {
                        // the limit on grid points is far below 2^32
                        numbers[at] = kept.len() as u32;
                        kept.extend(vertices[at].as_ref());
                    }
                    numbers[at]
                });
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        if mesh.triangles.is_empty() {
            return Err("contacts support no cell of the mesh; give more --grid points, or save .json".into());
        }
        mesh.points = kept.iter().map(|v| v.point).collect();
        mesh.normals = kept.iter().map(|v| v.normal).collect();
        mesh.fields = fields(saved, &kept);
        Ok(mesh)
    }

    /// Least and largest coordinates.
    pub(super) fn bounds(&self) -> [[f64; 3]; 2] {
        self.points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[lo, hi], p| {
            [[0, 1, 2].map(|k| lo[k].min(p[k])), [0, 1, 2].map(|k| hi[k].max(p[k]))]
        })
    }
}

/// Values under their names; the uncertainties where the surface carries any.
fn fields(saved: &Saved, kept: &[&Vertex]) -> Vec<(&'static str, Vec<f64>)> {
    let shape = |k: usize| kept.iter().map(|v| v.shape[k]).collect();
    let mut fields = vec![("S", shape(0)), ("R", shape(1)), ("k1", shape(2)), ("k2", shape(3))];
    if let Some(map) = &saved.uncertainty {
        let all: Vec<PointUncertainty> = kept.iter().map(|v| map.at(v.place)).collect();
        let list = |pick: fn(&PointUncertainty) -> Option<f64>| -> Vec<f64> {
            all.iter().map(|u| pick(u).unwrap_or(f64::NAN)).collect()
        };
        let named = [
            ("u_S", list(|u| u.shape_index)),
            ("u_R", list(|u| u.curvedness)),
            ("u_k1", list(|u| u.k1)),
            ("u_k2", list(|u| u.k2)),
            ("u_position", list(|u| u.position)),
            ("u_normal_deg", list(|u| u.normal_deg)),
        ];
        fields.extend(named.into_iter().filter(|(_, values)| values.iter().any(|v| !v.is_nan())));
    }
    fields
}

/// Supported vertices of the grid, and which directions close.
fn vertices(saved: &Saved, points: [usize; 2]) -> (Array2<Option<Vertex>>, [bool; 2]) {
    match &saved.surface {
        AnySurface::Height(field) => {
            let maps = field.shape_maps(ShapeGrid::over(field.domain(), points, 0.0), &saved.unsupported);
            (of_heights(saved, field.domain(), &maps), [false; 2])
        }
        AnySurface::Hierarchical(field) => {
            let maps = ShapeMaps::of_heights(&**field, ShapeGrid::over(field.domain(), points, 0.0));
            (of_heights(saved, field.domain(), &maps), [false; 2])
        }
        AnySurface::Parametric(map, support) => {
            let knots = [&map.knots()[0], &map.knots()[1]];
            let maps = parametric_maps(map, uv_grid(knots, points, 0.0), support);
            let vertex = |at: (usize, usize)| {
                let [s, r, k1, k2] = [&maps.shape_index, &maps.curvedness, &maps.k1, &maps.k2].map(|m| m[at]);
                maps.supported[at].then(|| Vertex {
                    point: maps.points[at],
                    normal: maps.normals[at],
                    shape: [s, r, k1, k2],
                    place: [maps.grid.x[at.0], maps.grid.y[at.1]],
                })
            };
            (Array2::from_shape_fn(maps.points.dim(), vertex), knots.map(|k| k.is_closed()))
        }
    }
}

/// Vertices of a surface of heights.
fn of_heights(saved: &Saved, domain: [[f64; 2]; 2], maps: &ShapeMaps) -> Array2<Option<Vertex>> {
    let turned = |v: [f64; 3]| if saved.frame.keeps_axes() { v } else { saved.frame.rotate_back(v) };
    let vertex = |(i, j): (usize, usize)| {
        let (x, y) = (maps.grid.x[i], maps.grid.y[j]);
        let held = maps.supported[[i, j]] && saved.support_map.as_ref().is_none_or(|m| m.holds(domain, [x, y]));
        let here = maps.points[[i, j]];
        let [s, r, k1, k2] = [&maps.shape_index, &maps.curvedness, &maps.k1, &maps.k2].map(|m| m[[i, j]]);
        held.then(|| Vertex {
            point: turned([x, y, here.z]),
            normal: turned(here.normal()),
            shape: [s, r, k1, k2],
            place: [x, y],
        })
    };
    Array2::from_shape_fn(maps.points.dim(), vertex)
}

/// Points each way at which the supported share of a domain is counted.
const COUNTED: usize = 33;

/// Share of the domain that contacts support.
pub(super) fn supported_share(saved: &Saved) -> f64 {
    let (vertices, _) = vertices(saved, [COUNTED; 2]);
    vertices.iter().flatten().count() as f64 / vertices.len() as f64
}
