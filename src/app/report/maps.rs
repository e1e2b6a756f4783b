//! S and R over the shape grid as tables: `maps.csv` (one row a point) and `maps.npz` (arrays indexed [x, y]).
//!
//! Undefined entries are empty in CSV and NaN in NPZ. Without support by data, S, R, k1, k2 and all uncertainties are undefined.

use std::io::{Cursor, Write};

use ndarray::Array2;

use crate::io::{NpzWriter, PointUncertainty};
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::ShapeMaps;

/// Names of the standard uncertainties at a point: of the position along the normal, of the normal in degrees, of S, R, k1
/// and k2.
pub(super) const UNCERTAINTIES: [&str; 6] = ["u_position", "u_normal_deg", "u_S", "u_R", "u_k1", "u_k2"];

/// The numbers under [`UNCERTAINTIES`].
pub(super) fn numbers_of(u: &PointUncertainty) -> [Option<f64>; 6] {
    [u.position, u.normal_deg, u.shape_index, u.curvedness, u.k1, u.k2]
}

/// Points of a height field's map in the input's coordinates; it stands along the axes of `frame`.
pub(super) fn points_of(maps: &ShapeMaps, frame: &Frame) -> Array2<[f64; 3]> {
    let at = |(i, j)| frame.direction_to_input([maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z]);
    Array2::from_shape_fn(maps.points.dim(), at)
}

/// `x,y,z,k1,k2,S,R` and the uncertainties, by the first direction of the maps and then by the second; points in the input's
/// coordinates.
///
/// # Errors
/// What the system says.
pub(super) fn write_maps_csv(
    maps: &ShapeMaps,
    frame: &Frame,
    uncertainty: &Array2<PointUncertainty>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = format!("x,y,z,k1,k2,S,R,{}\n", UNCERTAINTIES.join(","));
    let points = points_of(maps, frame);
    for i in 0..maps.grid.x.len() {
        for j in 0..maps.grid.y.len() {
            let [x, y, z] = points[[i, j]];
            let supported = maps.supported[[i, j]];
            let curvatures = [&maps.k1, &maps.k2].map(|k| supported.then_some(k[[i, j]]));
            let shape = [maps.shape_index_at(i, j), maps.curvedness_at(i, j)];
            text.push_str(&format!("{x},{y},{z}"));
            text.extend(curvatures.into_iter().chain(shape).chain(numbers_of(&uncertainty[[i, j]])).map(after_a_comma));
            text.push('\n');
        }
    }
    out.write_all(text.as_bytes())
}

/// The number as the next field of a row, which is empty where there is none.
pub(super) fn after_a_comma(value: Option<f64>) -> String {
    value.map_or(String::from(","), |v| format!(",{v}"))
}

/// 2-D `z`, `k1`, `k2`, `S`, `R` and the uncertainties. Where x and y are directions of the surface's own, `points` are given, which
/// become 2-D `X`, `Y`, `Z` in the input's coordinates.
pub(super) fn arrays_of(
    maps: &ShapeMaps,
    points: Option<&Array2<[f64; 3]>>,
    uncertainty: &Array2<PointUncertainty>,
) -> Vec<(&'static str, Array2<f64>)> {
    let map = |at: &dyn Fn([usize; 2]) -> Option<f64>| {
        Array2::from_shape_fn(maps.points.dim(), |(i, j)| at([i, j]).unwrap_or(f64::NAN))
    };
    let supported = |at: [usize; 2], value: f64| maps.supported[at].then_some(value);
    let mut arrays = vec![
        ("z", map(&|at| Some(maps.points[at].z))),
        ("k1", map(&|at| supported(at, maps.k1[at]))),
        ("k2", map(&|at| supported(at, maps.k2[at]))),
        ("S", map(&|[i, j]| maps.shape_index_at(i, j))),
        ("R", map(&|[i, j]| maps.curvedness_at(i, j))),
    ];
    for (k, name) in UNCERTAINTIES.into_iter().enumerate() {
        arrays.push((name, map(&|at| numbers_of(&uncertainty[at])[k])));
    }
    for (k, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        arrays.extend(points.map(|points| (name, points.map(|p| p[k]))));
    }
    arrays
}

/// 1-D `x` and `y`, and these 2-D arrays.
///
/// # Errors
/// What the system says.
pub(super) fn write_maps_npz(
    axes: [&[f64]; 2],
    arrays: &[(&'static str, Array2<f64>)],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut npz = NpzWriter::compressed(Cursor::new(Vec::new()));
    for (name, axis) in ["x", "y"].into_iter().zip(axes) {
        npz.add(name, &[axis.len()], axis.iter().copied())?;
    }
    for (name, array) in arrays {
        npz.add(name, array.shape(), array.iter().copied())?;
    }
    out.write_all(npz.finish()?.get_ref())
}
