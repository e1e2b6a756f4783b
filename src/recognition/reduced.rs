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
    /// How many of those are a rough spline's or a smooth departure's; natural departures follow.
    pub(super) rough: usize,
    /// Factors of the former and of the latter.
    pub(super) factors: [f64; 2],
}

/// Gram matrices of positions and normals, summed where they are read.
#[derive(Clone, Copy)]
pub(super) struct Grams<'a> {
    pub(super) positions: &'a Mat<f64>,
    /// Variance of a position: its rows are divided by it.
    pub(super) variance: f64,
    pub(super) normals: Option<&'a Mat<f64>>,
}

impl Grams<'_> {
    /// Rows of a column from `from` on.
    fn read(&self, from: usize, column: usize, out: &mut [f64]) {
        let rows = from..from + out.len();
        let positions = &self.positions.col_as_slice(column)[rows.clone()];
        match self.normals {
            Some(normals) => {
                let both = positions.iter().zip(&normals.col_as_slice(column)[rows]);
                out.iter_mut().zip(both).for_each(|(out, (p, n))| *out = p / self.variance + n);
            }
            None => out.iter_mut().zip(positions).for_each(|(out, p)| *out = p / self.variance),
        }
    }
}

impl Columns {
    /// Column of the Gram matrix that belongs to the i-th equation, and its factor; the last equation is y.
    fn source(&self, i: usize) -> (usize, f64) {
        let (first, count) = self.z;
        if i < count {
            (first + i, self.factors[usize::from(i >= self.rough)])
        } else if i < count + self.unknowns {
            (self.y + 1 + i - count, 1.0)
        } else {
            (self.y, 1.0)
        }
    }

    /// Writes entries `from..` of a column of the equations: rows that stand together are read together, because the columns of all
    /// candidates for a surface are most of the work beside the factor itself.
    fn read(&self, grams: &Grams, column: usize, from: usize, out: &mut [f64]) {
        let count = self.z.1;
        let (at, by) = self.source(column);
        let rough = self.rough.min(count);
        for (start, end) in [(0, rough), (rough, count), (count, count + self.unknowns)] {
            let (start, end) = (start.max(from), end.min(from + out.len()));
            if start >= end {
                continue;
            }
            let (row, factor) = self.source(start);
            let part = &mut out[start - from..end - from];
            grams.read(row, at, part);
            part.iter_mut().for_each(|v| *v *= factor * by);
        }
    }
}

/// Eliminates the displacement and then the parameters by one factor. `None` unless positive definite.
pub(super) fn reduced(columns: Columns, grams: Grams) -> Option<Reduced> {
    let (p, count) = (columns.unknowns, columns.z.1);
    let m = count + p;
    let mut joint = Mat::<f64>::zeros(m, m);
    for j in 0..m {
        let column = &mut joint.col_as_slice_mut(j)[j..];
        columns.read(&grams, j, j, column);
        if j < count {
            column[0] += 1.0;
        }
    }
    let joint = dense::cholesky(&joint)?;
    let mut right = vec![0.0; m];
    columns.read(&grams, m, 0, &mut right);
    let mut square = [0.0];
    grams.read(columns.y, columns.y, &mut square);
    dense::forward_in_columns(&joint, &mut right);
    let rss = square[0] - right.iter().map(|v| v * v).sum::<f64>();
    let lower = Mat::from_fn(p, p, |i, j| if j <= i { joint[(count + i, count + j)] } else { 0.0 });
    let mut x: Vec<f64> = right[count..].iter().map(|u| -u).collect();
    dense::backward(&lower, &mut x);
    let log_det = 2.0 * (0..count).map(|i| joint[(i, i)].ln()).sum::<f64>();
    Some(Reduced { lower, x, rss, log_det })
}
