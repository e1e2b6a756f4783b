//! Contacts as they come: files in every format of the program, and columns by the names of other programs; and parts.

use numpy::IntoPyArray;
use numpy::ndarray::Array2;
use palpate::cli::embedded;
use palpate::{Contacts, Grid, Orientation};
use palpate_app::io::{self, Input, ReadOptions, read_input_bytes};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::contacts::{Beside, contacts};
use super::errors;

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The columns of a file's contacts, or the axes and heights of its grid: x, y, z [nx, ny, nz | zx, zy] [finger, station]
/// [wz, wx, wy].
#[pyfunction]
pub(crate) fn read_contacts<'py>(py: Python<'py>, name: &str, bytes: &[u8]) -> PyResult<Bound<'py, PyDict>> {
    // normals that are not known are for the recognition, which leaves them out
    let options = ReadOptions::default();
    let reading = py.detach(|| read_input_bytes(name, bytes, &options)).map_err(refused)?;
    match reading.input {
        Input::Contacts(contacts) => columns_of(py, contacts),
        Input::Grid(grid) => grid_of(py, grid),
    }
}

/// Contacts as columns by their names, weights too.
pub(crate) fn columns_of(py: Python<'_>, contacts: Contacts) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let mut columns = vec![("x", contacts.x), ("y", contacts.y), ("z", contacts.z)];
    match contacts.orientation {
        Orientation::None => {}
        Orientation::Normals { nx, ny, nz } => columns.extend([("nx", nx), ("ny", ny), ("nz", nz)]),
        Orientation::Slopes { zx, zy } => columns.extend([("zx", zx), ("zy", zy)]),
    }
    let weights = [("wz", contacts.weights.z), ("wx", contacts.weights.x), ("wy", contacts.weights.y)];
    columns.extend(weights.into_iter().filter_map(|(name, weights)| Some((name, weights?))));
    for (name, values) in columns {
        dict.set_item(name, values.into_pyarray(py))?;
    }
    for (name, labels) in [("finger", contacts.finger), ("station", contacts.station)] {
        if let Some(labels) = labels {
            dict.set_item(name, labels.into_pyarray(py))?;
        }
    }
    Ok(dict)
}

fn grid_of(py: Python<'_>, grid: Grid) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("x", grid.x.into_pyarray(py))?;
    dict.set_item("y", grid.y.into_pyarray(py))?;
    dict.set_item("z", grid.z.into_pyarray(py))?;
    let beside: [(&str, Option<Array2<f64>>); 5] =
        [("zx", grid.zx), ("zy", grid.zy), ("wz", grid.wz), ("wx", grid.wx), ("wy", grid.wy)];
    for (name, values) in beside {
        if let Some(values) = values {
            dict.set_item(name, values.into_pyarray(py))?;
        }
    }
    Ok(dict)
}

/// The names of a table's columns in palpate's words; a name that means nothing stays.
#[pyfunction]
pub(crate) fn column_names(names: Vec<String>) -> PyResult<Vec<String>> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    io::column_names("x", &names).map_err(refused)
}

/// What a body is made of: the document of `palpate parts --json` as UTF-8, and the part of every contact, 0 of none.
#[pyfunction]
#[pyo3(signature = (x, y, z, normals, tolerance, viewpoint))]
pub(crate) fn parts_of<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    tolerance: Option<f64>,
    viewpoint: Option<[f64; 3]>,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let (weights, labels) = ([None; 3], [None; 2]);
    let given = contacts([x, y, z], &Beside { normals, slopes: None, weights, labels, flip_normals: false })?;
    let found = py.detach(|| embedded::parts_of(&given, tolerance, viewpoint));
    py.check_signals()?;
    let (json, labels) = found.map_err(|message| errors::plain(py, "PalpateError", message, "Parts"))?;
    Ok((PyBytes::new(py, &json), labels.into_pyarray(py).into_any()))
}
