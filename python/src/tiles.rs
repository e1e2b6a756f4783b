//! Adaptive fits of contacts that lie in parts with many workers: bytes in, bytes out.
//!
//! ```text
//! part_bounds   part_run   run_of_roots   run_slice   merged_runs   contact_tile   tile_answer      what workers do
//! TiledFit(bounds).fit(extents, shown, ask)                                                       what one process does
//! ```

use numpy::{IntoPyArray, PyReadonlyArray1};
use palpate::cli::embedded;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};

use super::contacts::{Beside, contacts};
use super::errors;
use super::fitting::FitCore;
use super::options::Keywords;
use palpate::Contacts;

/// Columns of a part: x, y, z, normals, slopes, (wz, wx, wy).
type Part<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, PyAny>>,
    [Option<Bound<'py, PyAny>>; 3],
);

/// How many contacts a part has, and least and largest x, y and z of them.
type Bounds = (usize, [[f64; 2]; 3]);

fn contacts_of((x, y, z, normals, slopes, weights): &Part<'_>) -> PyResult<Contacts> {
    let beside = Beside {
        normals: normals.as_ref(),
        slopes: slopes.as_ref(),
        weights: weights.each_ref().map(Option::as_ref),
        labels: [None; 2],
        flip_normals: false,
    };
    contacts([x, y, z], &beside)
}

fn wrong(py: Python<'_>, message: String) -> PyErr {
    errors::plain(py, "FitError", message, "Parts")
}

/// Arrays of float64 as lists of numbers.
fn columns_of(arrays: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<f64>>> {
    let arrays: Vec<PyReadonlyArray1<'_, f64>> = arrays.extract()?;
    Ok(arrays.iter().map(|array| array.as_array().to_vec()).collect())
}

/// How many contacts a part has, and least and largest x, y and z of them.
#[pyfunction]
pub(crate) fn part_bounds(py: Python<'_>, part: Part<'_>) -> PyResult<Bounds> {
    let contacts = contacts_of(&part)?;
    py.detach(|| embedded::part_bounds(&contacts)).map_err(|message| wrong(py, message))
}

/// A part in the order of the cells; its contacts in every base cell; the places that the outline of all is drawn by.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "three answers of one task")]
pub(crate) fn part_run<'py>(
    py: Python<'py>,
    part: Part<'py>,
    ground: &[u8],
    first: usize,
    total: usize,
) -> PyResult<(Bound<'py, PyBytes>, Vec<usize>, Vec<[f64; 2]>)> {
    let contacts = contacts_of(&part)?;
    let made = py.detach(|| embedded::part_run(&contacts, ground, first, total));
    let (run, by_root, shown) = made.map_err(|message| wrong(py, message))?;
    Ok((PyBytes::new(py, &run), by_root, shown))
}

/// Those of a run that lie in some base cells.
#[pyfunction]
pub(crate) fn run_of_roots<'py>(py: Python<'py>, run: &[u8], roots: [usize; 2]) -> PyResult<Bound<'py, PyBytes>> {
    let made = py.detach(|| embedded::run_of_roots(run, roots));
    made.map(|bytes| PyBytes::new(py, &bytes)).map_err(|message| wrong(py, message))
}

/// Those of a run from the first to before the second.
#[pyfunction]
pub(crate) fn run_slice<'py>(py: Python<'py>, run: &[u8], range: [usize; 2]) -> PyResult<Bound<'py, PyBytes>> {
    let made = py.detach(|| embedded::run_slice(run, range));
    made.map(|bytes| PyBytes::new(py, &bytes)).map_err(|message| wrong(py, message))
}

/// All contacts of some runs in one.
#[pyfunction]
pub(crate) fn merged_runs<'py>(py: Python<'py>, runs: Vec<Vec<u8>>) -> PyResult<Bound<'py, PyBytes>> {
    let made = py.detach(|| embedded::merged_runs(&runs));
    made.map(|bytes| PyBytes::new(py, &bytes)).map_err(|message| wrong(py, message))
}

/// Where the contacts beside a tile's own are, and how many there are before all of these.
#[pyfunction]
pub(crate) fn tile_sides(counts: Vec<usize>, tile: usize) -> PyResult<embedded::TileSides> {
    if tile >= counts.len() {
        return Err(PyValueError::new_err(format!("tile {tile} of {}", counts.len())));
    }
    Ok(embedded::tile_sides(&counts, tile))
}

/// A tile, and what whoever asks must know of it.
#[pyfunction]
pub(crate) fn contact_tile<'py>(
    py: Python<'py>,
    ground: &[u8],
    roots: [usize; 2],
    own: &[u8],
    sides: [Vec<Vec<u8>>; 2],
    before_and_total: [usize; 2],
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
    let sides = [&sides[0][..], &sides[1][..]];
    let made = py.detach(|| embedded::contact_tile(ground, roots, own, sides, before_and_total));
    let (tile, extent) = made.map_err(|message| wrong(py, message))?;
    Ok((PyBytes::new(py, &tile), PyBytes::new(py, &extent)))
}

/// What a tile answers to a question: float64.
#[pyfunction]
pub(crate) fn tile_answer<'py>(py: Python<'py>, tile: &[u8], question: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let made = py.detach(|| embedded::tile_answer(tile, question));
    made.map(|numbers| numbers.into_pyarray(py).into_any()).map_err(|message| wrong(py, message))
}

/// A fit of contacts that are tiles in other hands.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct TiledFit {
    fit: embedded::TiledFit,
}

#[pymethods]
impl TiledFit {
    /// From the bounds of all parts, and the keywords of an adaptive fit.
    #[new]
    fn new(py: Python<'_>, parts: Vec<Bounds>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<TiledFit> {
        let keywords = Keywords::read(keywords)?;
        let fit = embedded::TiledFit::new(&parts, keywords.given(), keywords.tuned(), &keywords.options, keywords.bare);
        Ok(TiledFit { fit: fit.map_err(|refusal| errors::refusal(py, &refusal))? })
    }

    /// What every worker must have.
    #[getter]
    fn ground<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.fit.ground())
    }

    /// Cells of the base grid.
    #[getter]
    fn roots(&self) -> usize {
        self.fit.roots()
    }

    /// The answer; ask(questions) gives what every tile answers to its own.
    fn fit(
        &self,
        py: Python<'_>,
        extents: Vec<Vec<u8>>,
        shown: Vec<[f64; 2]>,
        ask: &Bound<'_, PyAny>,
    ) -> PyResult<FitCore> {
        let ask = ask.clone().unbind();
        let mut raised = None;
        let made = py.detach(|| {
            let mut asked = |questions: Vec<Vec<u8>>| {
                Python::attach(|py| {
                    let questions = questions.iter().map(|question| PyBytes::new(py, question));
                    let answers = PyList::new(py, questions).and_then(|questions| ask.call1(py, (questions,)));
                    answers.and_then(|answers| columns_of(answers.bind(py))).map_err(|error| {
                        let message = error.to_string();
                        raised = Some(error);
                        message
                    })
                })
            };
            self.fit.fit(&extents, &shown, &mut asked)
        });
        match raised {
            Some(error) => Err(error),
            None => made.map(FitCore::new_of).map_err(|refusal| errors::refusal(py, &refusal)),
        }
    }
}
