//! S and R over the shape grid as tables: `maps.csv` (one row a point) and `maps.npz` (arrays indexed [x, y]).
//!
//! Undefined entries are empty in CSV and NaN in NPZ. Without support by data, S, R, k1 and k2 are undefined.

use std::io::{Cursor, Write};

use ndarray::Array2;

use crate::io::NpzWriter;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::ShapeMaps;

/// Points of a height field's map in the input's coordinates; it stands along the axes of `frame`.
pub(super) fn points_of(maps: &ShapeMaps, frame: &Frame) -> Array2<[f64; 3]> {
    let at = |(i, j)| frame.direction_to_input([maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z]);
    Array2::from_shape_fn(maps.points.dim(), at)
}

/// `x,y,z,k1,k2,S,R`, by the first direction of the maps and then by the second; points in the input's coordinates.
///
/// # Errors
/// What the system says.
pub(super) fn write_maps_csv(maps: &ShapeMaps, frame: &Frame, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("x,y,z,k1,k2,S,R\n");
    let points = points_of(maps, frame);
    for i in 0..maps.grid.x.len() {
        for j in 0..maps.grid.y.len() {
            let [x, y, z] = points[[i, j]];
            let supported = maps.supported[[i, j]];
            let entry = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
            let k1 = entry(supported.then_some(maps.k1[[i, j]]));
            let k2 = entry(supported.then_some(maps.k2[[i, j]]));
            let (s, r) = (entry(maps.shape_index_at(i, j)), entry(maps.curvedness_at(i, j)));
            text.push_str(&format!("{x},{y},{z},{k1},{k2},{s},{r}\n"));
        }
    }
    out.write_all(text.as_bytes())
}

/// 1-D `x`, `y` and 2-D `z`, `k1`, `k2`, `S`, `R`. Where x and y are directions of the surface's own, `points` are given, which
/// become 2-D `X`, `Y`, `Z` in the input's coordinates.
///
/// # Errors
/// What the system says.
pub(super) fn write_maps_npz(
    maps: &ShapeMaps,
    points: Option<&Array2<[f64; 3]>>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut npz = NpzWriter::compressed(Cursor::new(Vec::new()));
    let size = (maps.grid.x.len(), maps.grid.y.len());
    let map =
        |at: &dyn Fn(usize, usize) -> Option<f64>| Array2::from_shape_fn(size, |(i, j)| at(i, j).unwrap_or(f64::NAN));
    let supported = |i, j, value: f64| maps.supported[[i, j]].then_some(value);
    let axes = [("x", &maps.grid.x), ("y", &maps.grid.y)];
    let arrays = [
        ("z", map(&|i, j| Some(maps.points[[i, j]].z))),
        ("k1", map(&|i, j| supported(i, j, maps.k1[[i, j]]))),
        ("k2", map(&|i, j| supported(i, j, maps.k2[[i, j]]))),
        ("S", map(&|i, j| maps.shape_index_at(i, j))),
        ("R", map(&|i, j| maps.curvedness_at(i, j))),
    ];
    for (name, axis) in axes {
        npz.add(name, &[axis.len()], axis.iter().copied())?;
    }
    for (name, array) in arrays {
        npz.add(name, array.shape(), array.iter().copied())?;
    }
    for (k, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        if let Some(points) = points {
            npz.add(name, points.shape(), points.iter().map(|p| p[k]))?;
        }
    }
    out.write_all(npz.finish()?.get_ref())
}
