//! Explorations of simulated worlds, and next touches for a robot that has its own.
//!
//! ```text
//! arguments of `palpate explore`   ->  palpate.explore/1, columns of contacts
//! FitCore  ->  TouchPlanner        ->  next_touches(candidates (k, 2), n): numbers of candidates, the best first
//! ```

use numpy::ndarray::Ix2;
use numpy::{IntoPyArray, PyArray1};
use palpate::cli::embedded;
use palpate::explore as library;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::arrays::Numbers;
use super::attend::attended;
use super::errors;
use super::fitting::FitCore;
use super::scenes::columns_of;

/// The document of `palpate explore --json` as UTF-8, and the columns of all contacts.
#[pyfunction]
pub(crate) fn explore<'py>(
    py: Python<'py>,
    arguments: Vec<String>,
    text: Option<String>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyDict>)> {
    let found = attended(py, None, progress, move |teller| {
        embedded::explore(arguments, text, &mut |contacts, most| teller.tell(contacts, most))
    })?;
    let (document, contacts) = found.map_err(|message| errors::plain(py, "ExploreError", message, "Explore"))?;
    Ok((PyBytes::new(py, &document), columns_of(py, contacts)?))
}

/// A fit prepared for choosing next touches again and again.
#[pyclass(module = "palpate._native")]
pub(crate) struct TouchPlanner {
    planner: library::TouchPlanner,
}

#[pymethods]
impl TouchPlanner {
    #[new]
    fn new(py: Python<'_>, core: &FitCore, units: Option<(f64, f64)>) -> PyResult<TouchPlanner> {
        let planner = py.detach(|| core.planner()).map_err(|refusal| errors::planner_refusal(py, &refusal))?;
        let Some((of_shape_index, of_curvedness)) = units else { return Ok(TouchPlanner { planner }) };
        if ![of_shape_index, of_curvedness].iter().all(|unit| *unit > 0.0 && unit.is_finite()) {
            return Err(PyValueError::new_err("units: two numbers above zero wanted, of S and of R"));
        }
        Ok(TouchPlanner { planner: planner.with_units(of_shape_index, of_curvedness) })
    }

    /// Numbers of the n candidates (k, 2) to touch next, the best first.
    fn next_touches<'py>(
        &mut self,
        py: Python<'py>,
        candidates: &Bound<'py, PyAny>,
        n: usize,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let numbers = Numbers::of(candidates, "candidates")?;
        let shape = numbers.shape();
        let view = numbers.view().into_dimensionality::<Ix2>().ok().filter(|view| view.ncols() == 2);
        let view = view.ok_or_else(|| {
            PyValueError::new_err(format!("candidates has shape {shape:?}: (candidates, 2) wanted, x and y of each"))
        })?;
        let places: Vec<[f64; 2]> = view.rows().into_iter().map(|row| [row[0], row[1]]).collect();
        let planner = &mut self.planner;
        let chosen =
            py.detach(|| planner.next_touches(&places, n).map(|list| list.iter().map(|k| *k as i64).collect()));
        let chosen: Vec<i64> = chosen.map_err(|error| errors::explore_error(py, &error))?;
        Ok(chosen.into_pyarray(py))
    }

    /// u of S and of R that are expected once the touches chosen last are made.
    #[getter]
    fn expected_u(&self) -> (f64, f64) {
        let [of_shape_index, of_curvedness] = self.planner.expected_u();
        (of_shape_index, of_curvedness)
    }
}
