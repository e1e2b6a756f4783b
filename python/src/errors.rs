//! Errors out: the crate's error enums as Python exceptions, with the variant's name as `kind` and its fields.
//!
//! ```text
//! FitError::Outside { index, x, y, domain }   ->   palpate.FitError, kind = "Outside", fields = {"index": ..., ...}
//! ```

use palpate::explore::ExploreError;
use palpate::fit::FitError;
use palpate::plans::PlanError;
use palpate::spline::SplineError;
use palpate::{ContactError, cli::embedded::FitRefusal};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Puts fields of a variant into a dictionary under their own names.
macro_rules! put {
    ($dict:expr, $($field:ident),*) => {{ $($dict.set_item(stringify!($field), $field.clone())?;)* }};
}

/// An exception of the class `class` of `palpate._errors`.
pub(crate) fn exception(py: Python<'_>, class: &str, message: String, kind: &str, fields: Bound<'_, PyDict>) -> PyErr {
    let made = PyModule::import(py, "palpate._errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call1((message, kind, fields)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// The variant's name: what its debug form begins with.
fn kind(error: &impl std::fmt::Debug) -> String {
    format!("{error:?}").chars().take_while(|c| c.is_ascii_alphanumeric()).collect()
}

/// A message with one kind and no fields.
pub(crate) fn plain(py: Python<'_>, class: &str, message: String, kind: &str) -> PyErr {
    exception(py, class, message, kind, PyDict::new(py))
}

pub(crate) fn refusal(py: Python<'_>, refusal: &FitRefusal) -> PyErr {
    match refusal {
        FitRefusal::Fit(error) => fit_error(py, error),
        FitRefusal::Shape(message) => plain(py, "RecognitionError", message.clone(), "Shape"),
    }
}

pub(crate) fn fit_error(py: Python<'_>, error: &FitError) -> PyErr {
    let inner = match error {
        FitError::Contacts(inner) => kind(inner),
        _ => kind(error),
    };
    match fit_fields(py, error) {
        Ok(fields) => exception(py, "FitError", error.to_string(), &inner, fields),
        Err(error) => error,
    }
}

fn fit_fields<'py>(py: Python<'py>, error: &FitError) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    match error {
        FitError::Contacts(inner) => contact_fields(&dict, inner)?,
        FitError::Knots { axis, .. } => put!(dict, axis),
        FitError::Option { option, value, expected } => put!(dict, option, value, expected),
        FitError::TooFew { contacts, equations, unknowns } => put!(dict, contacts, equations, unknowns),
        FitError::Collinear { contacts } | FitError::Inward { contacts } => put!(dict, contacts),
        FitError::Domain { domain } => put!(dict, domain),
        FitError::Outside { index, x, y, domain } => put!(dict, index, x, y, domain),
        FitError::NormalDown { index, nz } | FitError::Steep { index, nz } => put!(dict, index, nz),
        FitError::Objective { objective, needed } => put!(dict, objective, needed),
        FitError::Method { method, why } => put!(dict, method, why),
        FitError::Rank { rank, unknowns } => put!(dict, rank, unknowns),
        FitError::Gap { coefficients, .. } => put!(dict, coefficients),
        FitError::HeightField { option } => put!(dict, option),
        FitError::NotSettled { steps, moved } => put!(dict, steps, moved),
        FitError::StepsSpent { steps } => put!(dict, steps),
        FitError::Sheet { contacts, why } => put!(dict, contacts, why),
        FitError::Closed { why } => put!(dict, why),
        FitError::Runaway { bending, most } => put!(dict, bending, most),
        FitError::Against { against, contacts } => put!(dict, against, contacts),
        _ => {}
    }
    let remedies = PyDict::new(py);
    for (option, value) in error.remedies() {
        remedies.set_item(option, value)?;
    }
    if !remedies.is_empty() {
        dict.set_item("remedies", remedies)?;
    }
    Ok(dict)
}

fn contact_fields(dict: &Bound<'_, PyDict>, error: &ContactError) -> PyResult<()> {
    match error {
        ContactError::Length { column, found, expected } => put!(dict, column, found, expected),
        ContactError::NotFinite { column, index, value } | ContactError::Weight { column, index, value } => {
            put!(dict, column, index, value);
        }
        ContactError::ZeroNormal { index } => put!(dict, index),
        ContactError::AxisOrder { axis, index, before, after } => put!(dict, axis, index, before, after),
        ContactError::Shape { array, found, expected } => put!(dict, array, found, expected),
        ContactError::HalfSlopes { present, missing } => put!(dict, present, missing),
        _ => {}
    }
    Ok(())
}

pub(crate) fn plan_error(py: Python<'_>, error: &PlanError) -> PyErr {
    let dict = PyDict::new(py);
    let filled = (|| {
        match error {
            PlanError::NoiseSd { block, value, expected } => put!(dict, block, value, expected),
            PlanError::NotFinite { column, index, value } => put!(dict, column, index, value),
            PlanError::Outside { axis, index, value, domain } => put!(dict, axis, index, value, domain),
            _ => {}
        }
        PyResult::Ok(())
    })();
    match filled {
        Ok(()) => exception(py, "PlanError", error.to_string(), &kind(error), dict),
        Err(error) => error,
    }
}

pub(crate) fn explore_error(py: Python<'_>, error: &ExploreError) -> PyErr {
    let dict = PyDict::new(py);
    let filled = (|| {
        match error {
            ExploreError::NoCandidate { why } => put!(dict, why),
            ExploreError::NotFinite { index, x, y } => put!(dict, index, x, y),
            ExploreError::Unsupported { coefficients } => put!(dict, coefficients),
            _ => {}
        }
        PyResult::Ok(())
    })();
    match filled {
        Ok(()) => exception(py, "ExploreError", error.to_string(), &kind(error), dict),
        Err(error) => error,
    }
}

/// Why a fit plans no touches.
pub(crate) enum PlannerRefusal {
    /// No height field over x and y.
    Surface,
    Explore(ExploreError),
}

pub(crate) fn planner_refusal(py: Python<'_>, refusal: &PlannerRefusal) -> PyErr {
    match refusal {
        PlannerRefusal::Explore(error) => explore_error(py, error),
        PlannerRefusal::Surface => {
            let what = "touches are planned over x and y, by a height field, and none fits these contacts: \
                        name a model that is one, as degree=2, or plan over a part of them";
            plain(py, "ExploreError", what.into(), "Surface")
        }
    }
}

pub(crate) fn knot_error(py: Python<'_>, axis: &str, error: &SplineError) -> PyErr {
    let dict = PyDict::new(py);
    match dict.set_item("axis", axis) {
        Ok(()) => exception(py, "SurfaceError", format!("knots in {axis}: {error}"), &kind(error), dict),
        Err(error) => error,
    }
}

pub(crate) fn surface_error(py: Python<'_>, error: &SplineError) -> PyErr {
    plain(py, "SurfaceError", error.to_string(), &kind(error))
}
