//! NPZ for SciPy: the spline itself.
//!
//! ```text
//! height field   tx, ty, c (n x m), degree     bisplev(x, y, (tx, ty, c.ravel(), *degree.astype(int)))
//! in space       tx, ty, c (n x m x 3), degree, closed     NdBSpline((tx, ty), c, degree.astype(int))([u, v])
//! both           axes, rows of the frame: a point is axes' (x, y, z) where they are not those of the input
//! ```

use std::io::Cursor;

use crate::io::npz_writer::NpzWriter;
use crate::io::surface_file::{AnySurface, Saved};
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::Knots;

use super::cad::tensor;

/// Writes knots and coefficients under their names.
type WriteSpline<'a> = &'a mut dyn FnMut(&[Knots; 2], &[usize], &mut dyn Iterator<Item = f64>) -> std::io::Result<()>;

fn heights(field: &HeightField, spline: WriteSpline) -> std::io::Result<()> {
    let (n, m) = field.coefficients().dim();
    spline(field.knots(), &[n, m], &mut field.coefficients().iter().copied())
}

/// The whole file.
///
/// # Errors
/// What the writer of archives says.
pub(super) fn write(saved: &Saved) -> std::io::Result<Vec<u8>> {
    let mut npz = NpzWriter::stored(Cursor::new(Vec::new()));
    let mut spline = |knots: &[Knots; 2], shape: &[usize], values: &mut dyn Iterator<Item = f64>| {
        for (name, axis) in ["tx", "ty"].into_iter().zip(knots) {
            npz.add(name, &[axis.as_slice().len()], axis.as_slice().iter().copied())?;
        }
        npz.add("c", shape, values)?;
        npz.add("degree", &[2], knots.iter().map(|k| k.degree() as f64))?;
        npz.add("closed", &[2], knots.iter().map(|k| f64::from(u8::from(k.is_closed()))))
    };
    match &saved.surface {
        AnySurface::Height(field) => {
            heights(field, &mut spline)?;
            npz.add("axes", &[3, 3], saved.frame.axes.iter().flatten().copied())?;
        }
        AnySurface::Hierarchical(field) => {
            heights(&tensor(field).map_err(std::io::Error::other)?, &mut spline)?;
            npz.add("axes", &[3, 3], saved.frame.axes.iter().flatten().copied())?;
        }
        AnySurface::Parametric(map, _) => {
            let (n, m) = map.coefficients().dim();
            spline(map.knots(), &[n, m, 3], &mut map.coefficients().iter().flatten().copied())?;
        }
    }
    Ok(npz.finish()?.into_inner())
}
