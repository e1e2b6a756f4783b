//! Touches that come one by one, each answered: the loop of `palpate live`.
//!
//! ```text
//! LiveCore(arguments of `palpate live`)  ->  touch(numbers) | hear(line)  ->  (what is said, JSON, words, goal reached)
//! ```
//!
//! The interpreter's lock is released while a touch is answered. Whoever asks from two threads waits for the other.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::IntoPyArray;
use palpate::cli::embedded::{self, LiveAnswer, LiveLoop, LiveReply, check_touch};
use palpate::fit::FitError;
use palpate::{Contacts, Orientation};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use super::errors;
use super::inputs::columns_of;
use super::options::{grid_points, numbers};

/// The touches so far and what is known of them.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct LiveCore {
    // held only where the interpreter's lock is not, so that neither waits for the other
    held: Mutex<LiveLoop>,
}

/// What is said, the line as JSON, the line in words, and whether the goal is reached.
type Reply = (Option<String>, Option<(String, String, bool)>);

fn live_error(py: Python<'_>, message: String) -> PyErr {
    errors::plain(py, "LiveError", message, "Live")
}

fn parts(answer: LiveAnswer) -> (String, String, bool) {
    (answer.json, answer.words, answer.is_reached)
}

fn reply(py: Python<'_>, found: Result<LiveReply, String>) -> PyResult<Reply> {
    let LiveReply { said, answer } = found.map_err(|message| live_error(py, message))?;
    Ok((said, answer.map(parts)))
}

impl LiveCore {
    fn held(&self) -> MutexGuard<'_, LiveLoop> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl LiveCore {
    #[new]
    fn new(py: Python<'_>, arguments: Vec<String>) -> PyResult<LiveCore> {
        let made = py.detach(|| embedded::live(arguments)).map_err(|message| live_error(py, message))?;
        Ok(LiveCore { held: Mutex::new(made) })
    }

    /// One touch; a normal of zeros is one that is not known.
    #[pyo3(signature = (place, normal, finger, station, time))]
    fn touch(
        &self,
        py: Python<'_>,
        place: [f64; 3],
        normal: Option<&Bound<'_, PyAny>>,
        finger: Option<u32>,
        station: Option<u32>,
        time: Option<f64>,
    ) -> PyResult<Reply> {
        let mut touch = Contacts::from_points(&[place]);
        if let Some(normal) = normal {
            let [nx, ny, nz] = numbers::<3>(normal, "normal")?.map(|value| vec![value]);
            touch.orientation = Orientation::Normals { nx, ny, nz };
        }
        touch.finger = finger.map(|finger| vec![finger]);
        touch.station = station.map(|station| vec![station]);
        check_touch(&touch).map_err(|error| errors::fit_error(py, &FitError::Contacts(error)))?;
        reply(py, py.detach(|| self.held().touch(&touch, time)))
    }

    /// A line of a table, its names, or a JSON object.
    fn hear(&self, py: Python<'_>, line: &[u8]) -> PyResult<Reply> {
        reply(py, py.detach(|| self.held().hear(line)))
    }

    /// Looks once more where touches came since the last look.
    fn finish(&self, py: Python<'_>) -> PyResult<Option<(String, String, bool)>> {
        let found = py.detach(|| self.held().finish()).map_err(|message| live_error(py, message))?;
        Ok(found.map(parts))
    }

    /// Writes the file that `palpate live --save` writes.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.held().save(&path)).map_err(|message| live_error(py, message))
    }

    /// Touches that ever came, looks at all of them, lines that were no touch.
    fn counts(&self, py: Python<'_>) -> (u64, u64, u64) {
        py.detach(|| {
            let held = self.held();
            (held.touches(), held.looks(), held.left_out())
        })
    }

    /// The columns of the touches that count.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contacts = py.detach(|| self.held().contacts());
        columns_of(py, contacts)
    }

    /// The document of `palpate fit --save` of the last look as UTF-8.
    fn document<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let found = py.detach(|| self.held().document()).map_err(|message| live_error(py, message))?;
        Ok(found.map(|json| PyBytes::new(py, &json)))
    }

    /// The axes and the maps of the last look.
    #[pyo3(signature = (grid = None))]
    fn maps<'py>(&self, py: Python<'py>, grid: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let points = grid.map(grid_points).transpose()?;
        let found = py.detach(|| self.held().maps(points)).map_err(|message| live_error(py, message))?;
        let Some(([x, y], arrays)) = found else { return Ok(None) };
        let dict = PyDict::new(py);
        dict.set_item("x", x.into_pyarray(py))?;
        dict.set_item("y", y.into_pyarray(py))?;
        for (name, array) in arrays {
            dict.set_item(name, array.into_pyarray(py))?;
        }
        Ok(Some(dict))
    }
}
