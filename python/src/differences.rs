//! Two fits compared: what `palpate diff` tells of their documents.

use palpate::cli::embedded;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::errors;
use super::options::pair;

/// Most points each way at which two surfaces are compared.
const MOST_DIFF_POINTS: usize = 10_000;

/// The document of `palpate diff --json` as UTF-8, and the table that it prints without. a and b: a name and the bytes of a
/// saved surface.
#[pyfunction]
pub(crate) fn diff_documents<'py>(
    py: Python<'py>,
    a: (String, Vec<u8>),
    b: (String, Vec<u8>),
    grid: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, String)> {
    let points = grid.map(|grid| pair(grid, "grid", MOST_DIFF_POINTS)).transpose()?;
    let found = py.detach(|| embedded::diff((&a.0, &a.1), (&b.0, &b.1), points));
    let [json, table] = found.map_err(|message| errors::plain(py, "SurfaceError", message, "NotComparable"))?;
    Ok((PyBytes::new(py, &json), String::from_utf8_lossy(&table).into_owned()))
}
