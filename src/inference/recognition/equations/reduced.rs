//! The normal equations of a model and a displacement, reduced to the model's own parameters by one elimination.
//!
//! ```text
//!     [ I + Z'Z   Z'J    Z'y ]   [ U_z  .    .   ]' [ U_z  .    .   ]
//!     [ J'Z       J'J    J'y ] = [      U_j  u   ]  [      U_j  u   ]        c + p + 1 rows
//!     [ y'Z       y'J    y'y ]   [           rss ]  [           1   ]
//! x = -U_j^-1 u       H = U_j' U_j       log det (I + Z'Z) = 2 sum log u_z       rss = what nothing explains
//! ```

use faer::Mat;

use crate::dense;
use palpate_numeric::simd::{Isa, factor_dense};

/// Columns are padded to whole sets of the widest lanes.
const LANES: usize = 8;

/// The equations after elimination.
pub(crate) struct Reduced {
    /// Lower factor of H, p x p.
    pub(crate) lower: Mat<f64>,
    /// The step that solves them.
    pub(crate) x: Vec<f64>,
    pub(crate) rss: f64,
    /// Log determinant of the displacement's precision.
    pub(crate) log_det: f64,
}

/// Which rows and columns of a Gram matrix belong to the equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns {
    /// Column of y; the model's follow.
    pub(crate) y: usize,
    /// Column that is added to y: a displacement that is not for the contacts to choose.
    pub(crate) fixed: Option<usize>,
    /// Parameters of the model.
    pub(crate) unknowns: usize,
    /// First column of the displacement, and how many are used.
    pub(crate) z: (usize, usize),
    /// How many of those are a rough spline's or a smooth departure's; natural departures follow.
    pub(crate) rough: usize,
    /// Factors of the former and of the latter.
    pub(crate) factors: [f64; 2],
}

/// Gram matrices of positions and normals, summed where they are read.
#[derive(Clone, Copy)]
pub(crate) struct Grams<'a> {
    pub(crate) positions: &'a Mat<f64>,
    /// Variance of a position: its rows are divided by it.
    pub(crate) variance: f64,
    pub(crate) normals: Option<&'a Mat<f64>>,
}

impl Grams<'_> {
    /// Rows of a column from `from` on.
    fn read(&self, from: usize, column: usize, out: &mut [f64]) {
        let rows = from..from + out.len();
        let positions = &self.positions.col_as_slice(column)[rows.clone()];
        let by = self.variance.recip();
        match self.normals {
            Some(normals) => {
                let both = positions.iter().zip(&normals.col_as_slice(column)[rows]);
                out.iter_mut().zip(both).for_each(|(out, (p, n))| *out = by * p + n);
            }
            None => out.iter_mut().zip(positions).for_each(|(out, p)| *out = by * p),
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
        let (at, by) = self.source(column);
        self.read_source(grams, (at, by), from, out);
        if let Some(fixed) = self.fixed {
            let y = self.z.1 + self.unknowns;
            if column == y {
                let mut added = vec![0.0; out.len()];
                self.read_source(grams, (fixed, 1.0), from, &mut added);
                out.iter_mut().zip(added).for_each(|(out, added)| *out += added);
            }
        }
    }

    /// The same for one of the columns of the Gram matrix that belong to it.
    fn read_source(&self, grams: &Grams, (at, by): (usize, f64), from: usize, out: &mut [f64]) {
        let count = self.z.1;
        let rough = self.rough.min(count);
        let y = count + self.unknowns;
        for (start, end) in [(0, rough), (rough, count), (count, y), (y, y + 1)] {
            let (start, end) = (start.max(from), end.min(from + out.len()));
            if start >= end {
                continue;
            }
            let (row, factor) = self.source(start);
            let part = &mut out[start - from..end - from];
            grams.read(row, at, part);
            part.iter_mut().for_each(|v| *v *= factor * by);
        }
        if let Some(fixed) = self.fixed.filter(|_| (from..from + out.len()).contains(&y)) {
            let mut added = [0.0];
            grams.read(fixed, at, &mut added);
            out[y - from] += by * added[0];
        }
    }

    /// Entry of y in a row.
    fn target(&self, rows: &Mat<f64>, row: usize) -> f64 {
        rows[(row, self.y)] + self.fixed.map_or(0.0, |fixed| rows[(row, fixed)])
    }
}

/// Eliminates the displacement and then the parameters by one factor; y is a row below it. `None` unless positive definite.
pub(crate) fn reduced(columns: Columns, grams: Grams) -> Option<Reduced> {
    let (p, count) = (columns.unknowns, columns.z.1);
    let m = count + p;
    let mut joint = Bordered::new(m, 1);
    for j in 0..m {
        let column = &mut joint.column_mut(j)[j..=m];
        columns.read(&grams, j, j, column);
        if j < count {
            column[0] += 1.0;
        }
    }
    let mut square = [0.0];
    columns.read(&grams, m, m, &mut square);
    joint.factor()?;
    let square_left = square[0] - (0..m).map(|j| joint.at(m, j).powi(2)).sum::<f64>();
    let lower = Mat::from_fn(p, p, |i, j| if j <= i { joint.at(count + i, count + j) } else { 0.0 });
    let mut x: Vec<f64> = (count..m).map(|j| -joint.at(m, j)).collect();
    dense::backward(&lower, &mut x);
    Some(Reduced { lower, x, rss: square_left, log_det: joint.log_det(count) })
}

/// The equations in the order parameters, displacement: their precision's lower triangle and right-hand side.
pub(crate) fn joint(columns: Columns, grams: Grams) -> (Mat<f64>, Vec<f64>) {
    let (p, count) = (columns.unknowns, columns.z.1);
    let m = p + count;
    let place = |i: usize| if i < count { p + i } else { i - count };
    let (mut precision, mut right) = (Mat::<f64>::zeros(m, m), vec![0.0; m]);
    let mut column = vec![0.0; m];
    for j in 0..=m {
        columns.read(&grams, j, 0, &mut column);
        let sorted = if j < m { precision.col_as_slice_mut(place(j)) } else { &mut right[..] };
        column.iter().enumerate().for_each(|(i, v)| sorted[place(i)] = *v);
    }
    (0..count).for_each(|i| precision[(p + i, p + i)] += 1.0);
    right.iter_mut().for_each(|v| *v = -*v);
    (precision, right)
}

/// As [`reduced`] from rows of positions alone, in the space of the cells, which are fewer than the displacement's columns:
///
/// ```text
/// M = I + Z Z' = L L'     B = L^-1 [J y]     H = B_J' B_J     x = -H^-1 B_J' b_y     rss = b_y' b_y - x' H x     log det M
/// ```
///
/// `products` are Z Z' of the columns with the first and with the second factor, before the factors.
pub(crate) fn reduced_in_cells(
    columns: Columns,
    rows: &Mat<f64>,
    variance: f64,
    products: [Option<&Mat<f64>>; 2],
) -> Option<Reduced> {
    let (n, p) = (rows.nrows(), columns.unknowns);
    let mut joint = Bordered::new(n, p + 1);
    for j in 0..n {
        let column = joint.column_mut(j);
        for (factor, product) in columns.factors.iter().zip(products) {
            let Some(product) = product else { continue };
            let by = factor * factor / variance;
            column[j..n].iter_mut().zip(&product.col_as_slice(j)[j..]).for_each(|(out, v)| *out += by * v);
        }
        column[j] += 1.0;
        // the parameters, then y
        let sources = (1..=p).map(|k| rows[(j, columns.y + k)]).chain([columns.target(rows, j)]);
        let by = variance.sqrt().recip();
        column[n..].iter_mut().zip(sources).for_each(|(out, v)| *out = by * v);
    }
    joint.factor()?;
    let (mut normal, mut square) = (Bordered::new(p, 1), 0.0);
    for j in 0..n {
        let b = &joint.values[j * joint.stride + n..][..=p];
        for k in 0..p {
            normal.column_mut(k)[k..=p].iter_mut().zip(&b[k..]).for_each(|(sum, other)| *sum += b[k] * other);
        }
        square += b[p] * b[p];
    }
    normal.factor()?;
    let rss = square - (0..p).map(|j| normal.at(p, j).powi(2)).sum::<f64>();
    let lower = Mat::from_fn(p, p, |i, j| if j <= i { normal.at(i, j) } else { 0.0 });
    let mut x: Vec<f64> = (0..p).map(|j| -normal.at(p, j)).collect();
    dense::backward(&lower, &mut x);
    Some(Reduced { lower, x, rss, log_det: joint.log_det(n) })
}

/// The lower triangle of a symmetric matrix by columns, with more rows below it, which the factor divides, too.
struct Bordered {
    order: usize,
    stride: usize,
    values: Vec<f64>,
}

impl Bordered {
    fn new(order: usize, border: usize) -> Bordered {
        let stride = (order + border).next_multiple_of(LANES);
        Bordered { order, stride, values: vec![0.0; order * stride] }
    }

    fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.values[column * self.stride..][..self.stride]
    }

    fn at(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.stride + row]
    }

    /// `None` unless positive definite.
    fn factor(&mut self) -> Option<()> {
        factor_dense(Isa::active(), self.order, self.stride, &mut self.values).ok().map(|_| ())
    }

    /// Log determinant of the first `count` columns.
    fn log_det(&self, count: usize) -> f64 {
        2.0 * (0..count).map(|i| self.at(i, i).ln()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Positions at five cells with two parameters, and a displacement of seven rough and two natural columns.
    #[test]
    fn the_space_of_the_cells_and_that_of_the_columns_agree() {
        let rows = Mat::from_fn(5, 12, |i, j| ((7 * i + 3 * j + i * j) as f64).sin());
        let gram = dense::gram(rows.as_ref());
        let columns = Columns { y: 0, fixed: None, unknowns: 2, z: (3, 9), rough: 7, factors: [0.7, 1.9] };
        let variance = 0.3;
        let by_columns = reduced(columns, Grams { positions: &gram, variance, normals: None }).unwrap();
        let of = |first, count| {
            let z = rows.as_ref().subcols(first, count);
            palpate_numeric::linalg::product(z, z.transpose())
        };
        let by_cells = reduced_in_cells(columns, &rows, variance, [Some(&of(3, 7)), Some(&of(10, 2))]).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * a.abs().max(1.0), "{a} {b}");
        near(by_columns.rss, by_cells.rss);
        near(by_columns.log_det, by_cells.log_det);
        (0..2).for_each(|i| near(by_columns.x[i], by_cells.x[i]));
        (0..2).for_each(|i| (0..=i).for_each(|j| near(by_columns.lower[(i, j)], by_cells.lower[(i, j)])));
    }

    /// A displacement that is added to y is the same as one that y already has, whichever way the equations are solved.
    #[test]
    fn a_fixed_column_belongs_to_y() {
        let rows = Mat::from_fn(14, 12, |i, j| ((7 * i + 3 * j + i * j) as f64).sin());
        let added = Mat::from_fn(14, 12, |i, j| if j == 0 { rows[(i, 0)] + rows[(i, 5)] } else { rows[(i, j)] });
        let [gram, other] = [&rows, &added].map(|rows| dense::gram(rows.as_ref()));
        let plain = Columns { y: 0, fixed: None, unknowns: 2, z: (6, 4), rough: 0, factors: [0.7, 1.9] };
        let fixed = Columns { fixed: Some(5), ..plain };
        let variance = 0.3;
        let positions = |gram| Grams { positions: gram, variance, normals: Some(gram) };
        let expected = reduced(plain, positions(&other)).unwrap();
        let found = reduced(fixed, positions(&gram)).unwrap();
        let (_, right) = joint(plain, positions(&other));
        let (_, same) = joint(fixed, positions(&gram));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * a.abs().max(1.0), "{a} {b}");
        near(found.rss, expected.rss);
        (0..2).for_each(|i| near(found.x[i], expected.x[i]));
        same.iter().zip(&right).for_each(|(a, b)| near(*a, *b));
        let z = rows.as_ref().subcols(6, 4);
        let product = palpate_numeric::linalg::product(z, z.transpose());
        let by_cells = |columns, rows| reduced_in_cells(columns, rows, variance, [None, Some(&product)]).unwrap();
        near(by_cells(fixed, &rows).rss, by_cells(plain, &added).rss);
    }

    #[test]
    fn the_joint_equations_have_the_same_solution() {
        let rows = Mat::from_fn(14, 12, |i, j| ((7 * i + 3 * j + i * j) as f64).sin());
        let gram = dense::gram(rows.as_ref());
        let columns = Columns { y: 0, fixed: None, unknowns: 2, z: (3, 9), rough: 7, factors: [0.7, 1.9] };
        let grams = || Grams { positions: &gram, variance: 0.3, normals: Some(&gram) };
        let (precision, mut mean) = joint(columns, grams());
        dense::solve(&dense::cholesky(&precision).unwrap(), &mut mean);
        let expected = reduced(columns, grams()).unwrap();
        (0..2).for_each(|i| assert!((mean[i] - expected.x[i]).abs() < 1e-12));
    }
}
