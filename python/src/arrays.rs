//! Arrays in: what a caller may hand over, and what is refused by the argument's name.
//!
//! ```text
//! ndarray of f8, native and aligned     read where it lies, whatever its strides
//! f4, integers, bools, f8 otherwise     converted by NumPy into an array of f8, which is then read
//! list, tuple, Series, scalar           numpy.asarray, then as above
//! object, complex, text, masked entries TypeError or ValueError that names the argument
//! ```

use numpy::ndarray::{ArrayViewD, Ix2};
use numpy::{
    PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();

/// The module numpy.
pub(crate) fn numpy_module(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    Ok(NUMPY.get_or_try_init(py, || PyModule::import(py, "numpy").map(Bound::unbind))?.bind(py))
}

/// An argument as an array of doubles of any number of dimensions.
pub(crate) struct Numbers<'py> {
    held: PyReadonlyArrayDyn<'py, f64>,
    name: &'static str,
}

impl<'py> Numbers<'py> {
    /// Reads the argument called `name`.
    pub(crate) fn of(argument: &Bound<'py, PyAny>, name: &'static str) -> PyResult<Numbers<'py>> {
        let py = argument.py();
        if let Ok(array) = argument.cast_exact::<PyArrayDyn<f64>>()
            && is_plain(array.as_untyped(), array.data() as usize)
        {
            return Numbers::held(array.clone(), name);
        }
        let array = match argument.cast::<PyUntypedArray>() {
            Ok(array) => array.clone(),
            Err(_) => {
                let made = numpy_module(py)?.call_method1(intern!(py, "asarray"), (argument,));
                let made = made.map_err(|error| named(py, name, &error))?;
                made.cast_into::<PyUntypedArray>()
                    .map_err(|_| wrong_type(name, "numpy.asarray makes no array of it"))?
            }
        };
        refuse_masked(&array, name)?;
        let kind = array.dtype().kind();
        if !b"fiub".contains(&kind) {
            let dtype = array.dtype().str()?;
            return Err(wrong_type(name, &format!("an array of {dtype} has no real numbers in it")));
        }
        // one conversion by NumPy, which also puts bytes in order and aligns them
        let options = PyDict::new(py);
        options.set_item(intern!(py, "dtype"), numpy::dtype::<f64>(py))?;
        options.set_item(intern!(py, "requirements"), intern!(py, "A"))?;
        let made = numpy_module(py)?.call_method(intern!(py, "require"), (&array,), Some(&options));
        let made = made.map_err(|error| named(py, name, &error))?;
        let plain = made.cast_into::<PyArrayDyn<f64>>().map_err(|_| wrong_type(name, "it is no array of numbers"))?;
        Numbers::held(plain, name)
    }

    fn held(array: Bound<'py, PyArrayDyn<f64>>, name: &'static str) -> PyResult<Numbers<'py>> {
        let held = array.try_into_readonly();
        let held = held.map_err(|_| PyValueError::new_err(format!("{name}: the array is being written elsewhere")))?;
        Ok(Numbers { held, name })
    }

    /// The entries where they lie.
    pub(crate) fn view(&self) -> ArrayViewD<'_, f64> {
        self.held.as_array()
    }

    /// The entries, if they lie one after the other.
    pub(crate) fn slice(&self) -> Option<&[f64]> {
        self.held.as_slice().ok()
    }

    pub(crate) fn shape(&self) -> Vec<usize> {
        self.held.shape().to_vec()
    }

    /// Refuses another number of dimensions.
    pub(crate) fn of_dimensions(self, wanted: usize) -> PyResult<Numbers<'py>> {
        if self.held.ndim() == wanted {
            return Ok(self);
        }
        let shape = self.shape();
        let words = ["a number", "one dimension", "two dimensions", "three dimensions"];
        let words = words.get(wanted).copied().unwrap_or("another number of dimensions");
        Err(PyValueError::new_err(format!("{} has shape {shape:?}: {words} wanted", self.name)))
    }

    /// A column of its own: the crate's `Contacts` own their columns, so this is the one copy that a fit makes.
    pub(crate) fn column(self) -> PyResult<Vec<f64>> {
        let one = self.of_dimensions(1)?;
        Ok(one.slice().map_or_else(|| one.view().iter().copied().collect(), <[f64]>::to_vec))
    }
}

/// Columns of a matrix (g, n), or of a tuple of n columns.
pub(crate) fn columns<const N: usize>(
    argument: &Bound<'_, PyAny>,
    name: &'static str,
    names: [&'static str; N],
) -> PyResult<[Vec<f64>; N]> {
    if let Ok(tuple) = argument.cast::<pyo3::types::PyTuple>()
        && tuple.len() == N
        && !tuple.get_item(0)?.is_instance_of::<pyo3::types::PyFloat>()
        && !tuple.get_item(0)?.is_instance_of::<pyo3::types::PyInt>()
    {
        let mut found: Vec<Vec<f64>> = Vec::with_capacity(N);
        for (k, part) in names.into_iter().enumerate() {
            found.push(Numbers::of(&tuple.get_item(k)?, part)?.column()?);
        }
        return found.try_into().map_err(|_| wrong_type(name, "a column is missing"));
    }
    let numbers = Numbers::of(argument, name)?;
    let shape = numbers.shape();
    if shape.len() != 2 || shape[1] != N {
        let what = format!("{name} has shape {shape:?}: (contacts, {N}) wanted, or a tuple of {N} columns");
        return Err(PyValueError::new_err(what));
    }
    let view = numbers.view().into_dimensionality::<Ix2>();
    let view = view.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    Ok(std::array::from_fn(|k| view.column(k).to_vec()))
}

/// Whole numbers that label contacts.
pub(crate) fn labels(argument: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Vec<u32>> {
    let values = Numbers::of(argument, name)?.column()?;
    let label = |v: f64| (v.fract() == 0.0 && (0.0..4_294_967_296.0).contains(&v)).then_some(v as u32);
    let wrong = || PyValueError::new_err(format!("{name}: whole numbers from 0 wanted"));
    values.into_iter().map(|v| label(v).ok_or_else(wrong)).collect()
}

fn is_plain(array: &Bound<'_, PyUntypedArray>, address: usize) -> bool {
    let size = size_of::<f64>();
    array.dtype().is_native_byteorder() == Some(true)
        && address.is_multiple_of(size)
        && array.strides().iter().all(|stride| stride.unsigned_abs().is_multiple_of(size))
}

fn refuse_masked(array: &Bound<'_, PyUntypedArray>, name: &'static str) -> PyResult<()> {
    let py = array.py();
    if array.is_exact_instance_of::<PyUntypedArray>() || !array.hasattr(intern!(py, "mask"))? {
        return Ok(());
    }
    let any = array.getattr(intern!(py, "mask"))?.call_method0(intern!(py, "any"))?;
    if any.is_truthy()? {
        return Err(PyValueError::new_err(format!(
            "{name} has masked entries: leave those contacts out of every column, as by x[~mask]; in a grid write NaN"
        )));
    }
    Ok(())
}

fn wrong_type(name: &str, why: &str) -> PyErr {
    PyTypeError::new_err(format!("{name}: {why}"))
}

/// NumPy's own complaint, with the name of the argument before it.
fn named(py: Python<'_>, name: &str, error: &PyErr) -> PyErr {
    let message = format!("{name}: {}", error.value(py));
    if error.is_instance_of::<PyTypeError>(py) {
        PyTypeError::new_err(message)
    } else if error.is_instance_of::<PyValueError>(py) || error.is_instance_of::<pyo3::exceptions::PyOverflowError>(py)
    {
        PyValueError::new_err(message)
    } else {
        error.clone_ref(py)
    }
}
