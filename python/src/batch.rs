//! `fit_many`: one fit a patch, on all threads, into columns.
//!
//! ```text
//! equal      x, y (g) or (b, g)   z (b, g)   normals (b, g, 3)          patch k is row k
//! grids      x (n)  y (m)         z (b, n, m)                           patch k is image k
//! ragged     x, y, z (all)        offsets (b + 1)                       patch k is offsets[k] .. offsets[k + 1]
//! ```
//!
//! A patch that cannot be fitted leaves NaN in its columns and its reason in a list; the others do not notice. Patches
//! are fitted in chunks, and each chunk's columns stand at once, so that the memory is that of the answer.

use numpy::IntoPyArray;
use numpy::ndarray::{Array2, ArrayViewD, Axis, Ix2, Slice};
use palpate::cli::embedded::{AskedSurface, FitAnswer, FitRefusal};
use palpate::fit::{FitOptions, Statistic};
use palpate::parametric::FittedSurface;
use palpate::{Contacts, Grid, Orientation, fit_grid};
use palpate_app::io::Input;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use super::arrays::Numbers;
use super::attend::{Teller, attended};
use super::options::Keywords;

/// Patches between two looks at the clock and at Ctrl-C: some milliseconds of work on a thread.
const CHUNK: usize = 512;

/// What is kept of a patch.
#[derive(Clone, Copy)]
struct Row {
    values: [f64; COLUMNS.len()],
    class: i8,
}

const COLUMNS: [&str; 10] = [
    "shape_index",
    "shape_index_sd",
    "shape_index_u",
    "curvedness",
    "curvedness_sd",
    "curvedness_u",
    "k1",
    "k2",
    "radius",
    "direction_deg",
];

const MISSING: Row = Row { values: [f64::NAN; COLUMNS.len()], class: -1 };

/// The nine classes in the order of S, and the plane; a class is its place here.
const CLASSES: [&str; 10] =
    ["cup", "trough", "rut", "saddle rut", "saddle", "saddle ridge", "ridge", "dome", "cap", "plane"];

/// Where the numbers of the patches lie.
struct Batch<'a> {
    x: ArrayViewD<'a, f64>,
    y: ArrayViewD<'a, f64>,
    z: ArrayViewD<'a, f64>,
    normals: Option<ArrayViewD<'a, f64>>,
    slopes: Option<ArrayViewD<'a, f64>>,
    offsets: Option<Vec<usize>>,
}

impl Batch<'_> {
    fn len(&self) -> usize {
        self.offsets.as_ref().map_or(self.z.shape()[0], |offsets| offsets.len() - 1)
    }

    /// The patch's own part of a column, or of vectors as columns.
    fn column(&self, of: &ArrayViewD<'_, f64>, k: usize) -> Vec<f64> {
        let part = match &self.offsets {
            Some(offsets) => of.slice_axis(Axis(0), Slice::from(offsets[k]..offsets[k + 1])),
            None if of.ndim() == 1 => of.view(),
            None => of.index_axis(Axis(0), k),
        };
        part.as_slice().map_or_else(|| part.iter().copied().collect(), <[f64]>::to_vec)
    }

    fn vectors<const N: usize>(&self, of: &ArrayViewD<'_, f64>, k: usize) -> [Vec<f64>; N] {
        let last = Axis(of.ndim() - 1);
        std::array::from_fn(|c| self.column(&of.index_axis(last, c), k))
    }

    fn input(&self, k: usize) -> Input {
        if self.offsets.is_none() && self.z.ndim() == 3 {
            let z = self.z.index_axis(Axis(0), k).into_dimensionality::<Ix2>();
            // it has three dimensions, so that one less leaves two
            let z = z.map_or_else(|_| Array2::zeros((0, 0)), |z| z.to_owned());
            return Input::Grid(Grid::new(self.column(&self.x, k), self.column(&self.y, k), z));
        }
        let orientation = match (&self.normals, &self.slopes) {
            (Some(normals), _) => {
                let [nx, ny, nz] = self.vectors(normals, k);
                Orientation::Normals { nx, ny, nz }
            }
            (None, Some(slopes)) => {
                let [zx, zy] = self.vectors(slopes, k);
                Orientation::Slopes { zx, zy }
            }
            (None, None) => Orientation::None,
        };
        let [x, y, z] = [&self.x, &self.y, &self.z].map(|column| self.column(column, k));
        Input::Contacts(Contacts { orientation, ..Contacts::from_positions(x, y, z) })
    }
}

fn fit_one(input: Input, keywords: &Keywords) -> Result<Row, String> {
    let Keywords { options, named, viewpoint, bare, .. } = keywords;
    let asked = keywords.asked();
    let said = |refusal: FitRefusal| match refusal {
        FitRefusal::Fit(error) => error.to_string(),
        FitRefusal::Shape(message) => message,
    };
    if let (AskedSurface::Spline, Input::Grid(grid)) = (&asked, &input) {
        return fit_grid(grid, options).map(|fit| row_of(&fit, *bare)).map_err(|error| error.to_string());
    }
    if let (AskedSurface::Spline, Input::Contacts(contacts)) = (&asked, &input) {
        let (found, _) = fit_named(contacts, options)?;
        return Ok(match found {
            FittedSurface::Height(fit) => row_of(&fit, *bare),
            FittedSurface::Parametric(fit) => {
                let shape = fit.shape();
                let numbers = [shape.k1.mean, shape.k2.mean, shape.radius, None];
                row([&shape.shape_index, &shape.curvedness], numbers, shape.class.name())
            }
        });
    }
    let answer = FitAnswer::new(input, asked, options, *viewpoint, *named && *bare).map_err(said)?;
    if let Some(fit) = answer.height_field() {
        return Ok(row_of(fit, false));
    }
    if let Some(shape) = answer.adaptive_shape() {
        let numbers = [shape.k1.mean, shape.k2.mean, shape.radius, None];
        return Ok(row([&shape.shape_index, &shape.curvedness], numbers, shape.class.name()));
    }
    let Some(found) = answer.recognition() else { return Ok(MISSING) };
    let direction = found.direction.map(on_the_map);
    let estimate =
        |mean: f64, sd: f64, u: f64| Statistic { mean: Some(mean), sd: Some(sd), u: Some(u), ..Statistic::default() };
    let s = found.shape_index.map_or(Statistic::default(), |s| estimate(s.mean, s.sd, s.u));
    let r = estimate(found.curvedness.mean, found.curvedness.sd, found.curvedness.u);
    Ok(row([&s, &r], [Some(found.k1), Some(found.k2), found.radius, direction], found.class.name()))
}

/// A direction in space as degrees from +x towards +y, in [0, 180).
fn on_the_map([x, y, _]: [f64; 3]) -> f64 {
    y.atan2(x).to_degrees().rem_euclid(180.0)
}

fn fit_named(contacts: &Contacts, options: &FitOptions) -> Result<(FittedSurface, String), String> {
    palpate::parametric::FittedSurface::of(contacts, options).map_err(|error| error.to_string())
}

fn row_of(fit: &palpate::Fit, bare: bool) -> Row {
    let shape = if bare { fit.bare_shape() } else { fit.shape() };
    let numbers = [shape.k1.mean, shape.k2.mean, shape.radius, shape.direction_deg];
    row([&shape.shape_index, &shape.curvedness], numbers, shape.class.name())
}

fn row([s, r]: [&Statistic; 2], [k1, k2, radius, direction]: [Option<f64>; 4], class: &str) -> Row {
    let values = [s.mean, s.sd, s.u, r.mean, r.sd, r.u, k1, k2, radius, direction].map(|v| v.unwrap_or(f64::NAN));
    let class = CLASSES.iter().position(|name| *name == class).map_or(-1, |at| at as i8);
    Row { values, class }
}

/// Fits every patch; a dictionary of columns, classes as numbers, their names, and why patches failed.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "every argument of palpate.fit_many, in its order")]
pub(crate) fn fit_batch<'py>(
    py: Python<'py>,
    x: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    z: &Bound<'py, PyAny>,
    normals: Option<&Bound<'py, PyAny>>,
    slopes: Option<&Bound<'py, PyAny>>,
    offsets: Option<&Bound<'py, PyAny>>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = Keywords::read(keywords)?;
    if normals.is_some() && slopes.is_some() {
        return Err(PyValueError::new_err("normals, slopes: give one of them, not both"));
    }
    let [x, y, z] = [Numbers::of(x, "x")?, Numbers::of(y, "y")?, Numbers::of(z, "z")?];
    let normals = normals.map(|n| Numbers::of(n, "normals")).transpose()?;
    let slopes = slopes.map(|s| Numbers::of(s, "slopes")).transpose()?;
    let offsets = offsets.map(read_offsets).transpose()?;
    let batch = Batch {
        x: x.view(),
        y: y.view(),
        z: z.view(),
        normals: normals.as_ref().map(Numbers::view),
        slopes: slopes.as_ref().map(Numbers::view),
        offsets,
    };
    check(&batch)?;
    let (rows, failed) = attended(py, threads, progress, |teller| fit_all(&batch, &keywords, teller))?;
    columns_of(py, &rows, failed)
}

/// Fits chunk by chunk, and stops where the caller does not want to go on.
fn fit_all(batch: &Batch<'_>, keywords: &Keywords, teller: &Teller<'_>) -> (Vec<Row>, Vec<(usize, String)>) {
    let count = batch.len();
    let (mut rows, mut failed) = (Vec::with_capacity(count), Vec::new());
    let step = CHUNK * rayon::current_num_threads();
    for from in (0..count).step_by(step) {
        let to = count.min(from + step);
        let chunk: Vec<Result<Row, String>> =
            (from..to).into_par_iter().map(|k| fit_one(batch.input(k), keywords)).collect();
        for (k, found) in (from..to).zip(chunk) {
            rows.push(found.as_ref().map_or(MISSING, |row| *row));
            failed.extend(found.err().map(|why| (k, why)));
        }
        if !teller.tell(to as u64, count as u64) {
            break;
        }
    }
    (rows, failed)
}

fn columns_of<'py>(py: Python<'py>, rows: &[Row], failed: Vec<(usize, String)>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (c, name) in COLUMNS.iter().enumerate() {
        let column: Vec<f64> = rows.iter().map(|row| row.values[c]).collect();
        dict.set_item(name, column.into_pyarray(py))?;
    }
    dict.set_item("class", rows.iter().map(|row| row.class).collect::<Vec<i8>>().into_pyarray(py))?;
    dict.set_item("failed", failed)?;
    Ok(dict)
}

fn read_offsets(argument: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    let numbers = Numbers::of(argument, "offsets")?.column()?;
    let whole = numbers.iter().all(|v| v.fract() == 0.0 && (0.0..9e15).contains(v));
    if !whole || numbers.is_empty() || !numbers.is_sorted() || numbers[0] != 0.0 {
        return Err(PyValueError::new_err("offsets: whole numbers that begin at 0 and do not decrease wanted"));
    }
    Ok(numbers.into_iter().map(|v| v as usize).collect())
}

fn check(batch: &Batch<'_>) -> PyResult<()> {
    let wrong = |what: String| Err(PyValueError::new_err(what));
    let (x, y, z) = (batch.x.shape(), batch.y.shape(), batch.z.shape());
    if let Some(offsets) = &batch.offsets {
        if z.len() != 1 || x != z || y != z {
            return wrong(format!(
                "x, y, z have shapes {x:?}, {y:?}, {z:?}: with offsets each has one dimension, as long"
            ));
        }
        if offsets.last() != Some(&z[0]) {
            return wrong(format!("offsets ends at {:?}, but there are {} contacts", offsets.last(), z[0]));
        }
    } else {
        let axes = |axis: &[usize], n: usize| axis == [n] || axis == [z[0], n];
        let fits = match z.len() {
            2 => axes(x, z[1]) && axes(y, z[1]),
            3 => axes(x, z[1]) && axes(y, z[2]),
            _ => return wrong(format!("z has shape {z:?}: (patches, contacts) or (patches, n, m) wanted")),
        };
        if !fits {
            return wrong(format!("x, y have shapes {x:?}, {y:?}: they do not go with z, {z:?}"));
        }
        if z.len() == 3 && (batch.normals.is_some() || batch.slopes.is_some()) {
            return wrong("normals, slopes: images are fitted by their heights alone here".into());
        }
    }
    for (name, of, n) in [("normals", &batch.normals, 3), ("slopes", &batch.slopes, 2)] {
        let wanted: Vec<usize> = z.iter().copied().chain([n]).collect();
        if let Some(of) = of
            && of.shape() != wanted
        {
            return wrong(format!("{name} has shape {:?}: {wanted:?} wanted", of.shape()));
        }
    }
    Ok(())
}

/// The names of the classes, by the numbers in the column `class`.
#[pyfunction]
pub(crate) fn class_names() -> Vec<&'static str> {
    CLASSES.to_vec()
}
