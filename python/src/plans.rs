//! Adaptive fits of places that are measured again and again.

use std::sync::{Mutex, PoisonError};

use palpate::cli::embedded::RepeatedPlaces;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::arrays::Numbers;
use super::contacts::{Beside, contacts};
use super::errors;
use super::fitting::FitCore;
use super::options::Keywords;
use super::surfaces::{Surface, UPRIGHT};

/// Cells, weights and factor of a first measurement.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct PlanCore {
    plan: Mutex<RepeatedPlaces>,
}

/// The first fit, and the plan for others at the same places.
#[pyfunction]
pub(crate) fn plan_adaptive<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    slopes: Option<&Bound<'py, PyAny>>,
    weights: [Option<Bound<'py, PyAny>>; 3],
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<(FitCore, PlanCore)> {
    let keywords = Keywords::read(keywords)?;
    let weights = weights.each_ref().map(Option::as_ref);
    let beside = Beside { normals: None, slopes, weights, labels: [None; 2], flip_normals: false };
    let contacts = contacts([x, y, z], &beside)?;
    let made = py.detach(|| {
        RepeatedPlaces::new(&contacts, keywords.given(), keywords.tuned(), &keywords.options, keywords.bare)
    });
    py.check_signals()?;
    let (answer, plan) = made.map_err(|refusal| errors::refusal(py, &refusal))?;
    Ok((FitCore::new_of(answer), PlanCore { plan: Mutex::new(plan) }))
}

#[pymethods]
impl PlanCore {
    /// The spline through other heights, and the noise of one of them.
    #[pyo3(signature = (z, zx, zy))]
    fn fit<'py>(
        &self,
        py: Python<'py>,
        z: &Bound<'py, PyAny>,
        zx: Option<&Bound<'py, PyAny>>,
        zy: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Surface, f64)> {
        let column = |given: &Bound<'py, PyAny>, name: &'static str| Numbers::of(given, name)?.column();
        let heights = column(z, "z")?;
        let slopes = match (zx, zy) {
            (Some(zx), Some(zy)) => Some([column(zx, "zx")?, column(zy, "zy")?]),
            _ => None,
        };
        let made = py.detach(|| {
            let mut plan = self.plan.lock().unwrap_or_else(PoisonError::into_inner);
            plan.fit(&heights, slopes.as_ref().map(|[zx, zy]| [&zx[..], &zy[..]]))
        });
        let (spline, noise) = made.map_err(|what| errors::plain(py, "FitError", what, "Contacts"))?;
        Ok((Surface::new_of(spline, UPRIGHT), noise))
    }
}
