//! Frontiers of scenes and of contacts, with progress by callback and Ctrl-C between calls that are timed.

use std::sync::atomic::{AtomicUsize, Ordering};

use palpate::cli::embedded;
use palpate::fit::FitError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::attend::{Teller, attended};
use super::contacts::{Beside, contacts};
use super::errors;

/// The document of `palpate frontier --json` as UTF-8.
#[pyfunction]
pub(crate) fn frontier<'py>(
    py: Python<'py>,
    arguments: Vec<String>,
    text: Option<String>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    measured(py, progress, |watch| embedded::frontier(arguments, text, watch))
}

/// The same of contacts, called what the arguments' subject says.
#[pyfunction]
#[pyo3(signature = (x, y, z, normals, slopes, weights, flip_normals, arguments, progress))]
#[expect(clippy::too_many_arguments, reason = "every argument of palpate.frontier, in its order")]
pub(crate) fn frontier_of_contacts<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    slopes: Option<&Bound<'py, PyAny>>,
    weights: [Option<Bound<'py, PyAny>>; 3],
    flip_normals: bool,
    arguments: Vec<String>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let weights = weights.each_ref().map(Option::as_ref);
    let data = contacts([x, y, z], &Beside { normals, slopes, weights, labels: [None; 2], flip_normals })?;
    data.check().map_err(|error| errors::fit_error(py, &FitError::Contacts(error)))?;
    measured(py, progress, |watch| embedded::frontier_of_contacts(arguments, &data, watch))
}

type Watch<'a> = &'a (dyn Fn(usize, usize) -> bool + Sync);

/// A document measured while progress is told.
fn measured<'py>(
    py: Python<'py>,
    progress: Option<&Bound<'py, PyAny>>,
    measure: impl FnOnce(Watch<'_>) -> Result<Vec<u8>, String> + Send,
) -> PyResult<Bound<'py, PyBytes>> {
    let document = attended(py, None, progress, move |teller: &Teller<'_>| {
        // a message wakes the thread that listens, so that one for every call would disturb what is timed
        let told = AtomicUsize::new(usize::MAX);
        measure(&|step, steps| {
            if told.swap(step, Ordering::Relaxed) == step {
                return teller.goes_on();
            }
            teller.tell(step as u64, steps as u64)
        })
    })?;
    let document = document.map_err(|message| errors::plain(py, "FrontierError", message, "Frontier"))?;
    Ok(PyBytes::new(py, &document))
}
