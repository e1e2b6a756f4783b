//! `fit`: contacts or a grid in, an answer out, from which documents and surfaces are made when they are asked for.

use std::time::Instant;

use numpy::{IntoPyArray, PyArray1};
use palpate::cli::embedded::{self, FitAnswer};
use palpate::explore::TouchPlanner;
use palpate::recognition::RecognisedSpline;
use palpate_app::io::Input;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::contacts::{Beside, contacts, grid};
use super::errors::{self, PlannerRefusal};
use super::options::{Keywords, grid_points};
use super::surfaces::{ParametricSurface, Surface, UPRIGHT};

/// The answer of a fit, behind `palpate.Fit`.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct FitCore {
    answer: FitAnswer,
}

#[pymethods]
impl FitCore {
    /// The document of `palpate fit --json` as UTF-8, and the table for people, with lengths in this unit.
    fn document<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        unit: Option<&str>,
    ) -> PyResult<(Bound<'py, PyBytes>, String)> {
        let made = py.detach(|| self.answer.document(name, unit));
        let [json, table] = made.map_err(|error| errors::fit_error(py, &error))?;
        Ok((PyBytes::new(py, &json), String::from_utf8_lossy(&table).into_owned()))
    }

    /// The document that `palpate fit --save` writes as UTF-8: with support and uncertainty at every point.
    fn saved<'py>(&self, py: Python<'py>, unit: Option<&str>) -> PyResult<Bound<'py, PyBytes>> {
        let made = py.detach(|| self.answer.saved(unit)).map_err(|error| errors::fit_error(py, &error))?;
        Ok(PyBytes::new(py, &made))
    }

    /// How far each contact lies off the surface, input units; None of surfaces in space that were named, and of grids.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let found = py.detach(|| self.answer.residuals()).map_err(|error| errors::fit_error(py, &error))?;
        Ok(found.map(|values| values.into_pyarray(py)))
    }

    /// Axes x and y, and the maps over them by name, over the fit's own grid or another: what `palpate fit --out` writes as maps.npz.
    #[pyo3(signature = (grid = None))]
    fn maps<'py>(&self, py: Python<'py>, grid: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyDict>> {
        let points = grid.map(|grid| grid_points(grid)).transpose()?;
        let ([x, y], arrays) = py.detach(|| self.answer.maps(points)).map_err(|error| errors::fit_error(py, &error))?;
        let dict = PyDict::new(py);
        dict.set_item("x", x.into_pyarray(py))?;
        dict.set_item("y", y.into_pyarray(py))?;
        for (name, array) in arrays {
            dict.set_item(name, array.into_pyarray(py))?;
        }
        Ok(dict)
    }

    /// The surface in input units: a Surface, or a ParametricSurface.
    fn surface(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let wrong = |error| errors::fit_error(py, &error);
        if let Some(fit) = self.answer.height_field() {
            let field = fit.input_surface().map_err(wrong)?;
            return Ok(Surface::new_of(field, fit.frame().axes).into_pyobject(py)?.into_any().unbind());
        }
        if let Some(fit) = self.answer.parametric() {
            let surface = fit.input_surface().map_err(wrong)?;
            return Ok(ParametricSurface::new_of(surface).into_pyobject(py)?.into_any().unbind());
        }
        if let Some(spline) = py.detach(|| self.answer.adaptive_spline()) {
            let field = spline.map_err(|what| errors::plain(py, "FitError", what, "TooLarge"))?;
            return Ok(Surface::new_of(field, UPRIGHT).into_pyobject(py)?.into_any().unbind());
        }
        let Some(found) = self.answer.recognition() else { return Ok(py.None()) };
        Ok(match py.detach(|| found.spline()).map_err(wrong)? {
            RecognisedSpline::Height { surface, fit } => {
                Surface::new_of(surface, fit.frame().axes).into_pyobject(py)?.into_any().unbind()
            }
            RecognisedSpline::Parametric { surface, .. } => {
                ParametricSurface::new_of(surface).into_pyobject(py)?.into_any().unbind()
            }
        })
    }
}

impl FitCore {
    pub(crate) fn new_of(answer: FitAnswer) -> FitCore {
        FitCore { answer }
    }

    /// A planner of next touches by the fitted height field, or by one with the noise of what was recognised.
    pub(crate) fn planner(&self) -> Result<TouchPlanner, PlannerRefusal> {
        let fit = self.answer.planning_fit().ok_or(PlannerRefusal::Surface)?;
        TouchPlanner::new(&fit).map_err(PlannerRefusal::Explore)
    }
}

/// The Surface of an adaptive fit, from its document.
#[pyfunction]
pub(crate) fn adaptive_surface(py: Python<'_>, document: &[u8]) -> PyResult<Surface> {
    let field = py
        .detach(|| embedded::adaptive_spline_of(document))
        .map_err(|what| errors::plain(py, "FitError", what, "TooLarge"))?;
    Ok(Surface::new_of(field, UPRIGHT))
}

/// A unit of length, where the text is one.
#[pyfunction]
pub(crate) fn unit_name(text: &str) -> PyResult<String> {
    embedded::unit(text).map_err(|expected| PyValueError::new_err(format!("unit is {text:?}: {expected}")))
}

/// Fits contacts.
#[pyfunction]
#[pyo3(signature = (x, y, z, normals, slopes, weights, labels, flip_normals, keywords))]
#[expect(clippy::too_many_arguments, reason = "every argument of palpate.fit, in its order")]
pub(crate) fn fit_contacts<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    slopes: Option<&Bound<'py, PyAny>>,
    weights: [Option<Bound<'py, PyAny>>; 3],
    labels: [Option<Bound<'py, PyAny>>; 2],
    flip_normals: bool,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<FitCore> {
    let keywords = Keywords::read(keywords)?;
    let (weights, labels) = (weights.each_ref().map(Option::as_ref), labels.each_ref().map(Option::as_ref));
    let beside = Beside { normals, slopes, weights, labels, flip_normals };
    let input = Input::Contacts(contacts([x, y, z], &beside)?);
    answer(py, input, &keywords)
}

/// Fits a grid.
#[pyfunction]
pub(crate) fn fit_grid<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    slopes: Option<&Bound<'py, PyAny>>,
    weights: [Option<Bound<'py, PyAny>>; 3],
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<FitCore> {
    let keywords = Keywords::read(keywords)?;
    let weights = weights.each_ref().map(Option::as_ref);
    let beside = Beside { normals: None, slopes, weights, labels: [None; 2], flip_normals: false };
    answer(py, Input::Grid(grid([x, y, z], &beside)?), &keywords)
}

fn answer(py: Python<'_>, input: Input, keywords: &Keywords) -> PyResult<FitCore> {
    let Keywords { options, viewpoint, bare, .. } = keywords;
    let answer = py.detach(|| FitAnswer::new(input, keywords.asked(), options, *viewpoint, *bare));
    // whoever pressed Ctrl-C during a long fit is heard here
    py.check_signals()?;
    Ok(FitCore { answer: answer.map_err(|refusal| errors::refusal(py, &refusal))? })
}

/// Seconds that the same fit takes in Rust alone, each of `times`: for the benches, which compare the two in one run.
#[pyfunction]
pub(crate) fn time_fit<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    keywords: Option<&Bound<'py, PyDict>>,
    times: usize,
) -> PyResult<Vec<f64>> {
    let keywords = Keywords::read(keywords)?;
    let none = [const { None }; 3];
    let beside = Beside { normals, slopes: None, weights: none, labels: [None; 2], flip_normals: false };
    let data = contacts([x, y, z], &beside)?;
    py.detach(|| {
        let one = || {
            let clock = Instant::now();
            let fit = palpate::fit_contacts(&data, &keywords.options);
            let seconds = clock.elapsed().as_secs_f64();
            fit.map(|_| seconds)
        };
        (0..times).map(|_| one()).collect::<Result<Vec<f64>, _>>()
    })
    .map_err(|error| errors::fit_error(py, &error))
}
