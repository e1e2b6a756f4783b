//! The normal equations of a model and a displacement, reduced to the model's own parameters by one elimination.
//!
//! ```text
//!     [ I + Z'Z   Z'J    Z'y ]   [ U_z  .    .   ]' [ U_z  .    .   ]
//!     [ J'Z       J'J    J'y ] = [      U_j  u   ]  [      U_j  u   ]        c + p + 1 rows
//!     [ y'Z       y'J    y'y ]   [           rss ]  [           1   ]
//! x = -U_j^-1 u       H = U_j' U_j       log det (I + Z'Z) = 2 sum log u_z       rss = what nothing explains
//! ```

use faer::Mat;

use super::dense;

/// The equations after elimination.
pub(super) struct Reduced {
    /// Lower factor of H, p x p.
    pub(super) lower: Mat<f64>,
    /// The step that solves them.
    pub(super) x: Vec<f64>,
    pub(super) rss: f64,
    /// Log determinant of the displacement's precision.
    pub(super) log_det: f64,
}

/// Which rows and columns of a Gram matrix belong to the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    /// Column of y; the model's follow.
    pub(super) y: usize,
    /// Parameters of the model.
    pub(super) unknowns: usize,
    /// First column of the displacement, and how many are used.
    pub(super) z: (usize, usize),
    /// How many of those are a spline's; natural departures follow.
    pub(super) rough: usize,
    /// Factors of the former and of the latter.
    pub(super) factors: [f64; 2],
}

/// Eliminates the displacement and then the parameters by one factor; `at` is the Gram matrix. `None` unless positive definite.
pub(super) fn reduced(columns: Columns, at: impl Fn(usize, usize) -> f64) -> Option<Reduced> {
    let Columns { y, unknowns: p, z: (first, count), rough, factors } = columns;
    let size = count + p + 1;
    let source = |i: usize| {
        if i < count {
            first + i
        } else if i < count + p {
            y + 1 + i - count
        } else {
            y
        }
    };
    let factor = |i: usize| if i < count { factors[usize::from(i >= rough)] } else { 1.0 };
    let (m, last) = (count + p, size - 1);
    let entry = |i: usize, j: usize| {
        let unit = if i == j && i < count { 1.0 } else { 0.0 };
        factor(i) * factor(j) * at(source(i), source(j)) + unit
    };
    let joint = dense::cholesky(&Mat::from_fn(m, m, |i, j| if j <= i { entry(i, j) } else { 0.0 }))?;
    let mut right: Vec<f64> = (0..m).map(|i| entry(i, last)).collect();
    dense::forward_in_columns(&joint, &mut right);
    let rss = entry(last, last) - right.iter().map(|v| v * v).sum::<f64>();
    let lower = Mat::from_fn(p, p, |i, j| if j <= i { joint[(count + i, count + j)] } else { 0.0 });
    let mut x: Vec<f64> = right[count..].iter().map(|u| -u).collect();
    dense::backward(&lower, &mut x);
    let log_det = 2.0 * (0..count).map(|i| joint[(i, i)].ln()).sum::<f64>();
    Some(Reduced { lower, x, rss, log_det })
}
