//! Arguments of a fit as the crate's `Contacts` and `Grid`.
//!
//! ```text
//! x, y, z (g)      normals (g, 3) | slopes (g, 2)     ->  Contacts
//! x (n), y (m), z (n, m)    slopes ((n, m), (n, m))   ->  Grid
//! ```

use numpy::ndarray::{Array2, Ix2};
use palpate::{ContactWeights, Contacts, Grid, Orientation};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::{Numbers, columns, labels};

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// What stands beside the positions.
pub(crate) struct Beside<'a, 'py> {
    pub(crate) normals: Argument<'a, 'py>,
    pub(crate) slopes: Argument<'a, 'py>,
    /// wz, wx, wy.
    pub(crate) weights: [Argument<'a, 'py>; 3],
    pub(crate) labels: [Argument<'a, 'py>; 2],
    pub(crate) flip_normals: bool,
}

const WEIGHTS: [&str; 3] = ["wz", "wx", "wy"];

pub(crate) fn contacts([x, y, z]: [&Bound<'_, PyAny>; 3], beside: &Beside<'_, '_>) -> PyResult<Contacts> {
    let [x, y, z] = [Numbers::of(x, "x")?, Numbers::of(y, "y")?, Numbers::of(z, "z")?];
    let orientation = match (beside.normals, beside.slopes) {
        (Some(_), Some(_)) => return Err(PyValueError::new_err("normals, slopes: give one of them, not both")),
        (Some(normals), None) => {
            let [nx, ny, nz] = columns(normals, "normals", ["normals[0]", "normals[1]", "normals[2]"])?;
            Orientation::Normals { nx, ny, nz }
        }
        (None, Some(slopes)) => {
            let [zx, zy] = columns(slopes, "slopes", ["slopes[0]", "slopes[1]"])?;
            Orientation::Slopes { zx, zy }
        }
        (None, None) if beside.flip_normals => {
            return Err(PyValueError::new_err("flip_normals: there are no normals to reverse"));
        }
        (None, None) => Orientation::None,
    };
    let weight = |k: usize| beside.weights[k].map(|w| Numbers::of(w, WEIGHTS[k])?.column()).transpose();
    let label = |k: usize, name| beside.labels[k].map(|l| labels(l, name)).transpose();
    let contacts = Contacts {
        x: x.column()?,
        y: y.column()?,
        z: z.column()?,
        orientation,
        finger: label(0, "finger")?,
        station: label(1, "station")?,
        weights: ContactWeights { z: weight(0)?, x: weight(1)?, y: weight(2)? },
    };
    Ok(if beside.flip_normals { contacts.with_flipped_normals() } else { contacts })
}

pub(crate) fn grid([x, y, z]: [&Bound<'_, PyAny>; 3], beside: &Beside<'_, '_>) -> PyResult<Grid> {
    if beside.normals.is_some() || beside.flip_normals {
        return Err(PyValueError::new_err("normals: a grid takes slopes=(zx, zy), each as large as z"));
    }
    if beside.labels.iter().any(Option::is_some) {
        return Err(PyValueError::new_err("finger, station: a grid has none"));
    }
    let mut grid = Grid::new(Numbers::of(x, "x")?.column()?, Numbers::of(y, "y")?.column()?, matrix(z, "z")?);
    if let Some(slopes) = beside.slopes {
        let pair = slopes.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
        let pair = pair.ok_or_else(|| PyValueError::new_err("slopes: a tuple (zx, zy) of two arrays wanted"))?;
        grid.zx = Some(matrix(&pair.get_item(0)?, "slopes[0]")?);
        grid.zy = Some(matrix(&pair.get_item(1)?, "slopes[1]")?);
    }
    let weight = |k: usize| beside.weights[k].map(|w| matrix(w, WEIGHTS[k])).transpose();
    (grid.wz, grid.wx, grid.wy) = (weight(0)?, weight(1)?, weight(2)?);
    Ok(grid)
}

fn matrix(argument: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Array2<f64>> {
    let numbers = Numbers::of(argument, name)?.of_dimensions(2)?;
    let view = numbers.view().into_dimensionality::<Ix2>();
    Ok(view.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?.to_owned())
}
