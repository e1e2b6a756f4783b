//! Studies and parts of studies, with progress by callback and Ctrl-C between chunks.
//!
//! ```text
//! StudyPlan(arguments of `palpate study`)  ->  run(range)  ->  StudyRun: document, part
//! ```

use std::path::PathBuf;

use numpy::IntoPyArray;
use palpate::cli::embedded;
use palpate::montecarlo::Progress;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::attend::attended;
use super::errors;

/// Everything that decides the numbers of a study.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct StudyPlan {
    plan: embedded::StudyPlan,
}

/// What replicates came to.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct StudyRun {
    /// The document of `palpate study --json` as UTF-8.
    document: Vec<u8>,
    /// The bytes of the file that `palpate study --part` writes.
    part: Vec<u8>,
    values: Vec<(String, Vec<f64>)>,
}

fn study_error(py: Python<'_>, message: String) -> PyErr {
    errors::plain(py, "StudyError", message, "Study")
}

#[pymethods]
impl StudyPlan {
    #[new]
    fn new(py: Python<'_>, arguments: Vec<String>, text: Option<String>) -> PyResult<StudyPlan> {
        let plan = py.detach(|| embedded::StudyPlan::new(arguments, text));
        Ok(StudyPlan { plan: plan.map_err(|message| study_error(py, message))? })
    }

    /// Replicates of the whole run.
    #[getter]
    fn replicates(&self) -> u64 {
        self.plan.replicates()
    }

    /// Runs replicates range[0] to range[1], or all of them, and calls progress(done, of) after every chunk.
    #[pyo3(signature = (range, threads, keep_values, describe, progress))]
    fn run(
        &self,
        py: Python<'_>,
        range: Option<(u64, u64)>,
        threads: Option<usize>,
        keep_values: bool,
        describe: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<StudyRun> {
        let range = range.map(|(from, to)| [from, to]);
        let names = if keep_values { self.plan.quantities() } else { Vec::new() };
        let mut values: Vec<(String, Vec<f64>)> = names.into_iter().map(|name| (name, Vec::new())).collect();
        let kept = &mut values;
        let outcome = attended(py, threads, progress, move |teller| {
            let run = self.plan.run(range, &mut |now: &Progress<'_>| {
                for ((_, kept), column) in kept.iter_mut().zip(now.columns) {
                    kept.extend_from_slice(column);
                }
                teller.tell(now.state.done(), now.end - now.state.from)
            })?;
            let document = if describe { self.plan.document(&run) } else { Vec::new() };
            Ok((document, self.plan.part(&run)))
        })?;
        let (document, part) = outcome.map_err(|message: String| study_error(py, message))?;
        Ok(StudyRun { document, part, values })
    }
}

#[pymethods]
impl StudyRun {
    /// The document of `palpate study --json` as UTF-8.
    #[getter]
    fn document<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.document)
    }

    /// The bytes of the file that `palpate study --part` writes.
    #[getter]
    fn part<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.part)
    }

    /// Every quantity of every replicate, where they were kept.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, column) in &self.values {
            dict.set_item(name, column.clone().into_pyarray(py))?;
        }
        Ok(dict)
    }
}

/// The document of `palpate merge --json` as UTF-8.
#[pyfunction]
pub(crate) fn merge_parts<'py>(py: Python<'py>, parts: Vec<PathBuf>) -> PyResult<Bound<'py, PyBytes>> {
    let document = py.detach(|| embedded::merge(&parts)).map_err(|message| study_error(py, message))?;
    Ok(PyBytes::new(py, &document))
}
