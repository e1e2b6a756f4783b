//! Built-in scenes, and contacts of scenes.

use std::collections::HashMap;

use numpy::IntoPyArray;
use palpate::cli::embedded;
use palpate::{Contacts, Orientation};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::errors;

/// Names of the built-in scenes with a line on each and each as TOML.
#[pyfunction]
pub(crate) fn scene_texts() -> HashMap<String, (String, String)> {
    embedded::scenes().into_iter().map(|[name, line, toml]| (name, (line, toml))).collect()
}

/// The columns of one replicate's contacts.
#[pyfunction]
pub(crate) fn scene_contacts<'py>(
    py: Python<'py>,
    scene: &str,
    text: Option<String>,
    seed: Option<u64>,
    replicate: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let made = py.detach(|| embedded::simulate(scene, text, seed, replicate));
    let (contacts, _) = made.map_err(|message| errors::plain(py, "StudyError", message, "Scene"))?;
    columns_of(py, contacts)
}

/// Contacts as columns by their names.
pub(crate) fn columns_of(py: Python<'_>, contacts: Contacts) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    let put = |name: &str, column: Vec<f64>| dict.set_item(name, column.into_pyarray(py));
    put("x", contacts.x)?;
    put("y", contacts.y)?;
    put("z", contacts.z)?;
    match contacts.orientation {
        Orientation::Normals { nx, ny, nz } => {
            put("nx", nx)?;
            put("ny", ny)?;
            put("nz", nz)?;
        }
        Orientation::Slopes { zx, zy } => {
            put("zx", zx)?;
            put("zy", zy)?;
        }
        Orientation::None => {}
    }
    for (name, labels) in [("finger", contacts.finger), ("station", contacts.station)] {
        if let Some(labels) = labels {
            dict.set_item(name, labels.into_pyarray(py))?;
        }
    }
    Ok(dict)
}
