//! Contacts one at a time: `TouchStream` of the crate, with knots and grid made from a domain.
//!
//! ```text
//! touch(x, y, z, normal)  ->  S, R, their u, class       nothing is allocated by the crate after the stream is made
//! ```

use palpate::fit::Statistic;
use palpate::geometry::{ShapeClass, ShapeGrid};
use palpate::plans::{PlanError, TouchStream as Stream};
use palpate::spline::Knots;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::errors;
use super::options::{numbers, pair};

/// The shape after the touches so far.
#[pyclass(frozen, module = "palpate._native", get_all)]
pub(crate) struct StreamShape {
    /// Touches so far.
    contacts: usize,
    /// Mean shape index S over the grid; None where it is defined nowhere.
    shape_index: Option<f64>,
    /// Standard uncertainty of S.
    u_shape_index: f64,
    /// Mean curvedness R over the grid, 1/length.
    curvedness: f64,
    /// Standard uncertainty of R, 1/length.
    u_curvedness: f64,
    /// Class of S, one of nine words.
    class_name: Option<&'static str>,
}

#[pymethods]
impl StreamShape {
    fn __repr__(&self) -> String {
        let class = self.class_name.unwrap_or("undefined");
        let s = self.shape_index.map_or("undefined".into(), |s| format!("{s:.4} +- {:.4}", self.u_shape_index));
        format!("{class} after {} touches: S {s}, R {:.6} +- {:.6}", self.contacts, self.curvedness, self.u_curvedness)
    }
}

/// A fit that grows touch by touch, for control loops.
///
/// domain (x0, x1, y0, y1) input units; sigma (sd of z, sd of dz/dx, sd of dz/dy), all above zero; grid and inset say
/// where S and R are averaged. Slope rows with known noise; touches outside the domain are refused.
/// Errors: PlanError (fields: block, column, index, value), TypeError and ValueError by the argument's name.
#[pyclass(module = "palpate._native")]
pub(crate) struct TouchStream {
    stream: Stream,
    contacts: usize,
}

fn shown(contacts: usize, [s, r]: [Statistic; 2]) -> StreamShape {
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    StreamShape {
        contacts,
        shape_index: s.mean,
        u_shape_index: number(s.u),
        curvedness: number(r.mean),
        u_curvedness: number(r.u),
        class_name: s.mean.map(|s| ShapeClass::of_shape_index(s).name()),
    }
}

#[pymethods]
impl TouchStream {
    #[new]
    #[pyo3(signature = (domain, *, sigma, degree = None, segments = None, grid = None, inset = 0.0))]
    fn new(
        py: Python<'_>,
        domain: &Bound<'_, PyAny>,
        sigma: &Bound<'_, PyAny>,
        degree: Option<&Bound<'_, PyAny>>,
        segments: Option<&Bound<'_, PyAny>>,
        grid: Option<&Bound<'_, PyAny>>,
        inset: f64,
    ) -> PyResult<TouchStream> {
        let [x0, x1, y0, y1] = numbers::<4>(domain, "domain")?;
        let sigma = numbers::<3>(sigma, "sigma")?;
        let both = |value: Option<&Bound<'_, PyAny>>, name, otherwise, most| {
            value.map_or(Ok([otherwise; 2]), |value| pair(value, name, most))
        };
        let (degree, segments) = (both(degree, "degree", 2, 9)?, both(segments, "segments", 1, 64)?);
        let grid = both(grid, "grid", 8, 1000)?;
        if !(0.0..0.5).contains(&inset) {
            return Err(PyValueError::new_err(format!("inset is {inset}: a fraction from 0 to below 0.5")));
        }
        let axis = |name, k: usize, lo, hi| {
            Knots::uniform(degree[k], segments[k], lo, hi).map_err(|error| errors::knot_error(py, name, &error))
        };
        let knots = [axis("x", 0, x0, x1)?, axis("y", 1, y0, y1)?];
        let points = ShapeGrid::over([[x0, x1], [y0, y1]], grid, inset);
        let stream = Stream::new(knots, sigma, [&points.x, &points.y]);
        Ok(TouchStream { stream: stream.map_err(|error| errors::plan_error(py, &error))?, contacts: 0 })
    }

    /// Adds one touch at (x, y) of height z, with its normal (any length, nz > 0) or its slopes.
    ///
    /// Nothing has changed where an error is raised.
    #[pyo3(signature = (x, y, z, normal = None, *, slopes = None))]
    fn push(
        &mut self,
        py: Python<'_>,
        x: f64,
        y: f64,
        z: f64,
        normal: Option<&Bound<'_, PyAny>>,
        slopes: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let slopes = match (normal, slopes) {
            (Some(normal), None) => {
                // a tuple of floats is by far the cheapest to take apart
                let [nx, ny, nz] =
                    normal.extract::<(f64, f64, f64)>().map_or_else(|_| numbers(normal, "normal"), |n| Ok(n.into()))?;
                // NaN goes on, and is refused by the name of its column
                if nz <= 0.0 {
                    return Err(PyValueError::new_err(format!("normal: nz is {nz}, and a height field needs nz > 0")));
                }
                [-nx / nz, -ny / nz]
            }
            (None, Some(slopes)) => {
                slopes.extract::<(f64, f64)>().map_or_else(|_| numbers(slopes, "slopes"), |s| Ok(s.into()))?
            }
            _ => return Err(PyValueError::new_err("normal, slopes: give one of them")),
        };
        self.stream.push([x, y], z, slopes).map_err(|error| errors::plan_error(py, &error))?;
        self.contacts += 1;
        Ok(())
    }

    /// S and R after all touches so far; PlanError while they are too few.
    fn shape(&mut self, py: Python<'_>) -> PyResult<StreamShape> {
        self.stream
            .shape()
            .map(|found| shown(self.stream.contacts(), found))
            .map_err(|error| errors::plan_error(py, &error))
    }

    /// push and shape in one call; None while the touches are too few.
    #[pyo3(signature = (x, y, z, normal = None, *, slopes = None))]
    fn touch(
        &mut self,
        py: Python<'_>,
        x: f64,
        y: f64,
        z: f64,
        normal: Option<&Bound<'_, PyAny>>,
        slopes: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<StreamShape>> {
        self.push(py, x, y, z, normal, slopes)?;
        match self.stream.shape() {
            Ok(found) => Ok(Some(shown(self.stream.contacts(), found))),
            Err(PlanError::Solve(_)) => Ok(None),
            Err(error) => Err(errors::plan_error(py, &error)),
        }
    }

    /// Forgets all touches; the plan stays.
    fn clear(&mut self) {
        self.stream.clear();
        self.contacts = 0;
    }

    /// Touches so far.
    fn __len__(&self) -> usize {
        self.contacts
    }

    fn __repr__(&self) -> String {
        format!("TouchStream({} touches)", self.contacts)
    }
}
