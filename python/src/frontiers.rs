//! Frontiers, with progress by callback and Ctrl-C between calls that are timed.

use std::sync::atomic::{AtomicUsize, Ordering};

use palpate::cli::embedded;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::attend::attended;
use super::errors;

/// The document of `palpate frontier --json` as UTF-8.
#[pyfunction]
pub(crate) fn frontier<'py>(
    py: Python<'py>,
    arguments: Vec<String>,
    text: Option<String>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let document = attended(py, None, progress, move |teller| {
        // a message wakes the thread that listens, so that one for every call would disturb what is timed
        let told = AtomicUsize::new(usize::MAX);
        embedded::frontier(arguments, text, &|step, steps| {
            if told.swap(step, Ordering::Relaxed) == step {
                return teller.goes_on();
            }
            teller.tell(step as u64, steps as u64)
        })
    })?;
    let document = document.map_err(|message| errors::plain(py, "FrontierError", message, "Frontier"))?;
    Ok(PyBytes::new(py, &document))
}
