//! Surfaces for Python, with SciPy's habits.
//!
//! ```text
//! s(x, y, dx, dy)       on the grid of two axes, as scipy.interpolate.RectBivariateSpline has it
//! s.ev(x, y, dx, dy)    at places
//! s.tck, s.t, s.c, s.k  what bisplev and NdBSpline take
//! ```

use numpy::ndarray::{Array2, ArrayD, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn};
use palpate::geometry::{Principal, ShapeGrid};
use palpate::spline::{HeightField, Knots, Parametric};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{Numbers, columns, numpy_module};
use super::errors;
use super::evaluate::Tensor;
use super::options::pair;

/// Most values that one call gives, 4 GB: more is a slip of the pen.
const MOST_VALUES: usize = 1 << 29;

/// A height field z = S(x, y): a tensor-product B-spline.
///
/// Surface(t, c, k): full knot vectors (tx, ty) in input units, coefficients (n, m), degrees (kx, ky).
/// Errors: SurfaceError for knots and coefficients that do not go together, TypeError and ValueError by the argument's name.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct Surface {
    tensor: Tensor,
    axes: [[f64; 3]; 3],
}

/// A surface in space (x, y, z) = Q(u, v): a tensor-product B-spline of points; u and v are lengths in input units.
#[pyclass(frozen, module = "palpate._native")]
pub(crate) struct ParametricSurface {
    tensor: Tensor,
}

pub(crate) const UPRIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

type Values<'py> = Bound<'py, PyArrayDyn<f64>>;

impl Surface {
    pub(crate) fn new_of(field: HeightField, axes: [[f64; 3]; 3]) -> Surface {
        let coefficients = field.coefficients().iter().copied().collect();
        Surface { tensor: Tensor { knots: field.knots().clone(), coefficients, components: 1 }, axes }
    }
}

impl ParametricSurface {
    pub(crate) fn new_of(surface: Parametric) -> ParametricSurface {
        let coefficients = surface.coefficients().iter().flatten().copied().collect();
        ParametricSurface { tensor: Tensor { knots: surface.knots().clone(), coefficients, components: 3 } }
    }
}

#[pymethods]
impl Surface {
    #[new]
    #[pyo3(signature = (t, c, k, axes = None))]
    fn new(
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        c: &Bound<'_, PyAny>,
        k: &Bound<'_, PyAny>,
        axes: Option<[[f64; 3]; 3]>,
    ) -> PyResult<Surface> {
        let knots = open_knots(py, t, k)?;
        let coefficients = Numbers::of(c, "c")?;
        let shape = coefficients.shape();
        let sizes = knots.each_ref().map(Knots::n_basis);
        let flat: Vec<f64> = coefficients.view().iter().copied().collect();
        let fits = shape == sizes || shape == [sizes[0] * sizes[1]];
        let made = (fits.then_some(flat)).and_then(|flat| Array2::from_shape_vec((sizes[0], sizes[1]), flat).ok());
        let array = made.ok_or_else(|| {
            PyValueError::new_err(format!("c has shape {shape:?}: the knots make {} x {}", sizes[0], sizes[1]))
        })?;
        let field = HeightField::new(knots, array).map_err(|error| errors::surface_error(py, &error))?;
        Ok(Surface::new_of(field, axes.unwrap_or(UPRIGHT)))
    }

    /// Heights, or their derivatives, on the grid of two axes; at places where grid is False.
    ///
    /// x (n,), y (m,), lengths in input units, any order; dx, dy: orders of the derivatives. Returns (n, m), in input
    /// units to the power 1 - dx - dy. Outside the domain the end polynomials go on.
    /// Errors: TypeError and ValueError by the argument's name.
    #[pyo3(signature = (x, y, dx = 0, dy = 0, grid = true))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
        dx: i64,
        dy: i64,
        grid: bool,
    ) -> PyResult<Values<'py>> {
        evaluate(py, &self.tensor, [x, y], orders(["dx", "dy"], [dx, dy])?, grid, ["x", "y"])
    }

    /// Heights, or their derivatives, at places.
    ///
    /// x, y: arrays of shapes that broadcast; returns an array of that shape.
    #[pyo3(signature = (x, y, dx = 0, dy = 0))]
    fn ev<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
        dx: i64,
        dy: i64,
    ) -> PyResult<Values<'py>> {
        evaluate(py, &self.tensor, [x, y], orders(["dx", "dy"], [dx, dy])?, false, ["x", "y"])
    }

    /// z, k1, k2, S and R on the grid of two axes x (n,), y (m,): a dictionary of arrays (n, m), NaN where undefined.
    fn shape<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [x, y] = [finite_axis(x, "x")?, finite_axis(y, "y")?];
        room(&[x.len(), y.len()], 8)?;
        let sizes = self.tensor.knots.each_ref().map(Knots::n_basis);
        let array = Array2::from_shape_vec((sizes[0], sizes[1]), self.tensor.coefficients.clone());
        let array = array.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let field = HeightField::new(self.tensor.knots.clone(), array);
        let field = field.map_err(|error| errors::surface_error(py, &error))?;
        let maps = py.detach(|| field.shape_maps(ShapeGrid { x, y }, &[]));
        let dict = PyDict::new(py);
        dict.set_item("z", maps.points.mapv(|point| point.z).into_pyarray(py))?;
        dict.set_item("k1", maps.k1.into_pyarray(py))?;
        dict.set_item("k2", maps.k2.into_pyarray(py))?;
        dict.set_item("S", maps.shape_index.into_pyarray(py))?;
        dict.set_item("R", maps.curvedness.into_pyarray(py))?;
        Ok(dict)
    }

    /// (tx, ty, c, kx, ky) as scipy.interpolate.bisplev takes them, c of n m entries.
    #[getter]
    fn tck<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let [x, y] = &self.tensor.knots;
        let [tx, ty] = [x, y].map(|axis| axis.as_slice().to_vec().into_pyarray(py));
        let c = self.tensor.coefficients.clone().into_pyarray(py);
        (tx, ty, c, x.degree(), y.degree()).into_pyobject(py)
    }

    /// Knots (tx, ty), as scipy.interpolate.NdBSpline takes them.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        knots_of(py, &self.tensor)
    }

    /// Coefficients (n, m).
    #[getter]
    fn c<'py>(&self, py: Python<'py>) -> PyResult<Values<'py>> {
        coefficients_of(py, &self.tensor)
    }

    /// Degrees (kx, ky).
    #[getter]
    fn k(&self) -> (usize, usize) {
        (self.tensor.knots[0].degree(), self.tensor.knots[1].degree())
    }

    /// (x0, x1, y0, y1), input units.
    #[getter]
    fn domain(&self) -> (f64, f64, f64, f64) {
        domain_of(&self.tensor)
    }

    /// Rows are the directions of x, y and z in the input's frame: the unit matrix unless the patch looks sideways.
    #[getter]
    fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let arguments = (knots_of(py, &self.tensor)?, coefficients_of(py, &self.tensor)?, self.k(), self.axes);
        Ok((py.get_type::<Surface>().into_any(), arguments.into_pyobject(py)?))
    }

    fn __eq__(&self, other: &Surface) -> bool {
        same(&self.tensor, &other.tensor) && self.axes == other.axes
    }

    fn __repr__(&self) -> String {
        describe("Surface", &self.tensor, ["x", "y"])
    }
}

#[pymethods]
impl ParametricSurface {
    #[new]
    #[pyo3(signature = (t, c, k, closed = (false, false)))]
    fn new(
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        c: &Bound<'_, PyAny>,
        k: &Bound<'_, PyAny>,
        closed: (bool, bool),
    ) -> PyResult<ParametricSurface> {
        let [tu, tv] = columns_of_knots(t)?;
        let [p, q] = pair(k, "k", 9)?;
        let axis = |name: &str, p: usize, t: Vec<f64>, closed: bool| {
            let made = if closed { Knots::closed_from(p, &t) } else { Knots::new(p, t) };
            made.map_err(|error| errors::knot_error(py, name, &error))
        };
        let knots = [axis("u", p, tu, closed.0)?, axis("v", q, tv, closed.1)?];
        let coefficients = Numbers::of(c, "c")?;
        let (shape, sizes) = (coefficients.shape(), knots.each_ref().map(Knots::n_basis));
        if shape != [sizes[0], sizes[1], 3] {
            let what = format!("c has shape {shape:?}: the knots make {} x {} x 3", sizes[0], sizes[1]);
            return Err(PyValueError::new_err(what));
        }
        let view = coefficients.view();
        let array = Array2::from_shape_fn((sizes[0], sizes[1]), |(i, j)| [0, 1, 2].map(|k| view[IxDyn(&[i, j, k])]));
        let surface = Parametric::new(knots, array).map_err(|error| errors::surface_error(py, &error))?;
        Ok(ParametricSurface::new_of(surface))
    }

    /// Points, or their derivatives, on the grid of two axes: (n, m, 3), input units; at places where grid is False.
    #[pyo3(signature = (u, v, du = 0, dv = 0, grid = true))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        du: i64,
        dv: i64,
        grid: bool,
    ) -> PyResult<Values<'py>> {
        evaluate(py, &self.tensor, [u, v], orders(["du", "dv"], [du, dv])?, grid, ["u", "v"])
    }

    /// k1, k2, S and R on the grid of two axes u (n,), v (m,): a dictionary of arrays (n, m), NaN where undefined.
    fn shape<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [u, v] = [finite_axis(u, "u")?, finite_axis(v, "v")?];
        room(&[u.len(), v.len()], 8)?;
        let sizes = self.tensor.knots.each_ref().map(Knots::n_basis);
        let points = self.tensor.coefficients.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let array = Array2::from_shape_vec((sizes[0], sizes[1]), points);
        let array = array.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let surface = Parametric::new(self.tensor.knots.clone(), array);
        let surface = surface.map_err(|error| errors::surface_error(py, &error))?;
        let places = || Array2::from_shape_fn((u.len(), v.len()), |(i, j)| surface.at(u[i], v[j]).principal());
        let principal = py.detach(places);
        let dict = PyDict::new(py);
        let set = |name: &str, of: fn(&Principal) -> Option<f64>| {
            let values = principal.map(|here| here.as_ref().and_then(of).unwrap_or(f64::NAN));
            dict.set_item(name, values.into_pyarray(py))
        };
        set("k1", |here| Some(here.k1))?;
        set("k2", |here| Some(here.k2))?;
        set("S", Principal::shape_index)?;
        set("R", |here| Some(here.curvedness()))?;
        Ok(dict)
    }

    /// Points, or their derivatives, at places u, v of shapes that broadcast: that shape and 3 more.
    #[pyo3(signature = (u, v, du = 0, dv = 0))]
    fn ev<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        du: i64,
        dv: i64,
    ) -> PyResult<Values<'py>> {
        evaluate(py, &self.tensor, [u, v], orders(["du", "dv"], [du, dv])?, false, ["u", "v"])
    }

    /// Knots (tu, tv); those of a closed direction go on beyond both ends.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        knots_of(py, &self.tensor)
    }

    /// Coefficients (n, m, 3).
    #[getter]
    fn c<'py>(&self, py: Python<'py>) -> PyResult<Values<'py>> {
        coefficients_of(py, &self.tensor)
    }

    /// Degrees (ku, kv).
    #[getter]
    fn k(&self) -> (usize, usize) {
        (self.tensor.knots[0].degree(), self.tensor.knots[1].degree())
    }

    /// Directions that close.
    #[getter]
    fn closed(&self) -> (bool, bool) {
        (self.tensor.knots[0].is_closed(), self.tensor.knots[1].is_closed())
    }

    /// (u0, u1, v0, v1), lengths in input units.
    #[getter]
    fn domain(&self) -> (f64, f64, f64, f64) {
        domain_of(&self.tensor)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let arguments = (knots_of(py, &self.tensor)?, coefficients_of(py, &self.tensor)?, self.k(), self.closed());
        Ok((py.get_type::<ParametricSurface>().into_any(), arguments.into_pyobject(py)?))
    }

    fn __eq__(&self, other: &ParametricSurface) -> bool {
        same(&self.tensor, &other.tensor)
    }

    fn __repr__(&self) -> String {
        describe("ParametricSurface", &self.tensor, ["u", "v"])
    }
}

fn orders(names: [&str; 2], given: [i64; 2]) -> PyResult<[usize; 2]> {
    for (name, order) in names.into_iter().zip(given) {
        if order < 0 {
            return Err(PyValueError::new_err(format!("{name} is {order}: the order of a derivative is 0 or more")));
        }
    }
    // beyond the degree every derivative is zero
    Ok(given.map(|order| usize::try_from(order).unwrap_or(10).min(10)))
}

fn columns_of_knots(t: &Bound<'_, PyAny>) -> PyResult<[Vec<f64>; 2]> {
    match t.cast::<PyTuple>() {
        Ok(_) => columns(t, "t", ["t[0]", "t[1]"]),
        Err(_) => {
            let both: (Bound<'_, PyAny>, Bound<'_, PyAny>) =
                t.extract().map_err(|_| PyValueError::new_err("t: a pair of knot vectors wanted"))?;
            Ok([Numbers::of(&both.0, "t[0]")?.column()?, Numbers::of(&both.1, "t[1]")?.column()?])
        }
    }
}

fn open_knots(py: Python<'_>, t: &Bound<'_, PyAny>, k: &Bound<'_, PyAny>) -> PyResult<[Knots; 2]> {
    let ([tx, ty], [p, q]) = (columns_of_knots(t)?, pair(k, "k", 9)?);
    let axis = |name, p, t| Knots::new(p, t).map_err(|error| errors::knot_error(py, name, &error));
    Ok([axis("x", p, tx)?, axis("y", q, ty)?])
}

/// Values of shape (n, m) on a grid, or of the common shape at places; points in space have three more.
fn evaluate<'py>(
    py: Python<'py>,
    tensor: &Tensor,
    [x, y]: [&Bound<'py, PyAny>; 2],
    order: [usize; 2],
    grid: bool,
    names: [&'static str; 2],
) -> PyResult<Values<'py>> {
    let [x, y] = [Numbers::of(x, names[0])?, Numbers::of(y, names[1])?];
    let (mut shape, values) = if grid {
        let [x, y] = [axis(x)?, axis(y)?];
        let shape = vec![x.len(), y.len()];
        room(&shape, tensor.components)?;
        (shape, py.detach(|| tensor.on_grid(&x, &y, order)))
    } else if let (Some(xs), Some(ys)) = (x.slice(), y.slice())
        && x.shape() == y.shape()
    {
        room(&[xs.len()], tensor.components)?;
        (x.shape(), py.detach(|| tensor.at_places(xs.len(), order, |r| [xs[r], ys[r]])))
    } else {
        let (shape, xs, ys) = broadcast(py, &x, &y, names)?;
        room(&shape, tensor.components)?;
        (shape, py.detach(|| tensor.at_places(xs.len(), order, |r| [xs[r], ys[r]])))
    };
    if tensor.components > 1 {
        shape.push(tensor.components);
    }
    let array = ArrayD::from_shape_vec(IxDyn(&shape), values);
    Ok(array.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

/// The common shape, and the places one after the other.
fn broadcast(
    py: Python<'_>,
    x: &Numbers<'_>,
    y: &Numbers<'_>,
    names: [&str; 2],
) -> PyResult<(Vec<usize>, Vec<f64>, Vec<f64>)> {
    let refused = || {
        let what = format!("{} and {}: shapes {:?} and {:?}", names[0], names[1], x.shape(), y.shape());
        PyValueError::new_err(format!("{what} do not broadcast"))
    };
    let shape: Vec<usize> = numpy_module(py)?
        .call_method1("broadcast_shapes", (PyTuple::new(py, x.shape())?, PyTuple::new(py, y.shape())?))
        .map_err(|_| refused())?
        .extract()?;
    // asked before the places are put one after the other
    room(&shape, 1)?;
    let wide = |numbers: &Numbers<'_>| -> PyResult<Vec<f64>> {
        let view = numbers.view();
        Ok(view.broadcast(IxDyn(&shape)).ok_or_else(refused)?.iter().copied().collect())
    };
    let (xs, ys) = (wide(x)?, wide(y)?);
    Ok((shape, xs, ys))
}

/// The entries of an axis, all of them finite.
fn finite_axis(values: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Vec<f64>> {
    let values = axis(Numbers::of(values, name)?)?;
    if values.iter().all(|v| v.is_finite()) {
        Ok(values)
    } else {
        Err(PyValueError::new_err(format!("{name}: finite numbers wanted")))
    }
}

/// The entries of an axis; a single number is an axis of one point.
fn axis(numbers: Numbers<'_>) -> PyResult<Vec<f64>> {
    if numbers.shape().is_empty() {
        return Ok(numbers.view().iter().copied().collect());
    }
    numbers.column()
}

fn room(shape: &[usize], components: usize) -> PyResult<()> {
    let values = shape.iter().try_fold(components, |product, n| product.checked_mul(*n));
    if values.is_some_and(|values| values <= MOST_VALUES) {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("x, y: {shape:?} values in one call are more than {MOST_VALUES}; take parts")))
}

fn knots_of<'py>(py: Python<'py>, tensor: &Tensor) -> PyResult<Bound<'py, PyTuple>> {
    let [a, b] = tensor.knots.each_ref().map(|axis| axis.as_slice().to_vec().into_pyarray(py));
    (a, b).into_pyobject(py)
}

fn coefficients_of<'py>(py: Python<'py>, tensor: &Tensor) -> PyResult<Values<'py>> {
    let mut shape: Vec<usize> = tensor.knots.iter().map(Knots::n_basis).collect();
    if tensor.components > 1 {
        shape.push(tensor.components);
    }
    let array = ArrayD::from_shape_vec(IxDyn(&shape), tensor.coefficients.clone());
    Ok(array.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

fn domain_of(tensor: &Tensor) -> (f64, f64, f64, f64) {
    let [[a, b], [c, d]] = tensor.knots.each_ref().map(Knots::domain);
    (a, b, c, d)
}

fn same(a: &Tensor, b: &Tensor) -> bool {
    let alike = |(a, b): (&Knots, &Knots)| {
        (a.degree(), a.is_closed(), a.as_slice()) == (b.degree(), b.is_closed(), b.as_slice())
    };
    a.knots.iter().zip(&b.knots).all(alike) && a.coefficients == b.coefficients
}

fn describe(name: &str, tensor: &Tensor, axes: [&str; 2]) -> String {
    let [[a, b], [c, d]] = tensor.knots.each_ref().map(Knots::domain);
    let [x, y] = &tensor.knots;
    let ([p, q], [n, m]) = ([x.degree(), y.degree()], [x.n_segments(), y.n_segments()]);
    let [u, v] = axes;
    format!("{name}(degree {p} x {q}, segments {n} x {m}, {u} in [{a}, {b}], {v} in [{c}, {d}])")
}
