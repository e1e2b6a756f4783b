//! A spline over the product of two axes, row by row of the grid instead of site by site.
//!
//! ```text
//! L_Aj = sum_b c_(A, f_j + b) M_b(y_j)      L'_Aj with M'_b           once for every basis function A in x and every y_j
//! S_ij = sum_a N_a(x_i) L_(f_i + a, j)      S_x with N'_a      S_y with L'
//! ```
//!
//! These are the sums that a visit of single sites forms, in the same order, so every number has the same bits; but a
//! column's inner sums are formed once for all rows, and the rows are long enough for vector instructions.

use std::ops::Range;

use super::grid_axis::GridAxis;
use super::sites::{RowWeights, SiteWeights};

/// The widest rows whose sums stay in registers: degree 4.
const NARROW: usize = 5;

/// The inner sums of a spline over a grid.
struct Inner<'a> {
    axes: [GridAxis<'a>; 2],
    /// L and L', a row for every basis function in x.
    along: [Vec<f64>; 2],
    /// S, S_x, S_y of the pixels that were asked for last.
    line: [Vec<f64>; 3],
}

impl<'a> Inner<'a> {
    fn new(axes: [GridAxis<'a>; 2], basis: [usize; 2], c: &[f64]) -> Inner<'a> {
        let y = axes[1];
        let pixels = y.first.len();
        let mut along = [vec![0.0; basis[0] * pixels], vec![0.0; basis[0] * pixels]];
        for (k, c) in c.chunks_exact(basis[1]).enumerate() {
            for (j, &first) in y.first.iter().enumerate() {
                let (mut value, mut slope) = (0.0, 0.0);
                let [of_value, of_slope] = y.rows(j);
                for ((c, v), s) in c[first..].iter().zip(of_value).zip(of_slope) {
                    value += c * v;
                    slope += c * s;
                }
                (along[0][k * pixels + j], along[1][k * pixels + j]) = (value, slope);
            }
        }
        let line = std::array::from_fn(|_| vec![0.0; pixels]);
        Inner { axes, along, line }
    }

    /// `S, S_x, S_y` of the pixels `run` of row `i`.
    fn line(&mut self, i: usize, run: Range<usize>) -> [&[f64]; 3] {
        match self.axes[0].width {
            2 => self.line_of::<2>(i, run),
            3 => self.line_of::<3>(i, run),
            4 => self.line_of::<4>(i, run),
            NARROW => self.line_of::<NARROW>(i, run),
            _ => self.long_line(i, run),
        }
    }

    fn line_of<const W: usize>(&mut self, i: usize, run: Range<usize>) -> [&[f64]; 3] {
        let x = self.axes[0];
        let (pixels, count) = (self.axes[1].first.len(), run.len());
        let [n, dn] = x.rows(i).map(|row| std::array::from_fn::<f64, W, _>(|a| row[a]));
        let at = |a: usize| (x.first[i] + a) * pixels + run.start;
        let along: [&[f64]; W] = std::array::from_fn(|a| &self.along[0][at(a)..][..count]);
        let slope: [&[f64]; W] = std::array::from_fn(|a| &self.along[1][at(a)..][..count]);
        let [s, sx, sy] = self.line.each_mut().map(|v| &mut v[..count]);
        for j in 0..count {
            let (mut value, mut by_x, mut by_y) = (0.0, 0.0, 0.0);
            for a in 0..W {
                value += n[a] * along[a][j];
                by_x += dn[a] * along[a][j];
                by_y += n[a] * slope[a][j];
            }
            (s[j], sx[j], sy[j]) = (value, by_x, by_y);
        }
        [s, sx, sy]
    }

    fn long_line(&mut self, i: usize, run: Range<usize>) -> [&[f64]; 3] {
        let x = self.axes[0];
        let (pixels, count) = (self.axes[1].first.len(), run.len());
        let [s, sx, sy] = self.line.each_mut().map(|v| &mut v[..count]);
        s.fill(0.0);
        sx.fill(0.0);
        sy.fill(0.0);
        let [n, dn] = x.rows(i);
        for a in 0..x.width {
            let start = (x.first[i] + a) * pixels + run.start;
            let (along, slope) = (&self.along[0][start..][..count], &self.along[1][start..][..count]);
            for j in 0..count {
                s[j] += n[a] * along[j];
                sx[j] += dn[a] * along[j];
                sy[j] += n[a] * slope[j];
            }
        }
        [s, sx, sy]
    }
}

/// Calls `visit(site, [S, S_x, S_y])` for every pixel, in the order of the knot cells.
pub(super) fn visit_cells(axes: [GridAxis; 2], basis: [usize; 2], c: &[f64], mut visit: impl FnMut(usize, [f64; 3])) {
    let mut inner = Inner::new(axes, basis, c);
    let pixels = axes[1].first.len();
    for x_run in axes[0].runs {
        for y_run in axes[1].runs {
            for i in x_run.clone() {
                let [s, sx, sy] = inner.line(i, y_run.clone());
                let start = i * pixels + y_run.start;
                for (k, ((s, sx), sy)) in s.iter().zip(sx).zip(sy).enumerate() {
                    visit(start + k, [*s, *sx, *sy]);
                }
            }
        }
    }
}

/// Calls `visit(site, [S, S_x, S_y])` for every pixel, row after row of the grid.
pub(super) fn visit_lines(axes: [GridAxis; 2], basis: [usize; 2], c: &[f64], mut visit: impl FnMut(usize, [f64; 3])) {
    let mut inner = Inner::new(axes, basis, c);
    let pixels = axes[1].first.len();
    for i in 0..axes[0].first.len() {
        let [s, sx, sy] = inner.line(i, 0..pixels);
        for (k, ((s, sx), sy)) in s.iter().zip(sx).zip(sy).enumerate() {
            visit(i * pixels + k, [*s, *sx, *sy]);
        }
    }
}

/// The rows of every pixel, from the values of a spline or without one.
pub(super) struct GridRows<'a, F> {
    /// Axes of the grid.
    pub axes: [GridAxis<'a>; 2],
    /// Basis functions in x and in y.
    pub basis: [usize; 2],
    /// Weights of the rows.
    pub row_weights: &'a RowWeights,
    /// The rows of one site, weighted, from its [S, S_x, S_y].
    pub rows: F,
}

impl<F: Fn(usize, [f64; 3]) -> [f64; 3]> GridRows<'_, F> {
    /// `out += E' r` with the rows at the spline `c`; without a spline its values are zeros.
    pub(super) fn add_transposed(&self, c: Option<&[f64]>, out: &mut [f64]) {
        let [x, y] = self.axes;
        let mut inner = c.map(|c| Inner::new(self.axes, self.basis, c));
        let mut cell = vec![0.0; x.width * y.width];
        for x_run in x.runs {
            for y_run in y.runs {
                let first = [x.first[x_run.start], y.first[y_run.start]];
                let home = |a: usize| (first[0] + a) * self.basis[1] + first[1];
                for (a, row) in cell.chunks_exact_mut(y.width).enumerate() {
                    row.copy_from_slice(&out[home(a)..][..y.width]);
                }
                for i in x_run.clone() {
                    let values = inner.as_mut().map(|inner| inner.line(i, y_run.clone()));
                    self.add_line(i, y_run.clone(), values, &mut cell);
                }
                for (a, row) in cell.chunks_exact(y.width).enumerate() {
                    out[home(a)..][..y.width].copy_from_slice(row);
                }
            }
        }
    }

    fn add_line(&self, i: usize, y_run: Range<usize>, values: Option<[&[f64]; 3]>, cell: &mut [f64]) {
        let start = i * self.axes[1].first.len() + y_run.start;
        let line = |k: usize| {
            let value = values.map_or([0.0; 3], |values| values.map(|v| v[k]));
            factors(&self.row_weights.at(start + k), (self.rows)(start + k, value))
        };
        match self.axes.map(|axis| axis.width) {
            [3, 3] => add_line::<3, 3>(self.axes, i, y_run, line, cell),
            [4, 4] => add_line::<4, 4>(self.axes, i, y_run, line, cell),
            [NARROW, NARROW] => add_line::<NARROW, NARROW>(self.axes, i, y_run, line, cell),
            _ => add_long_line(self.axes, i, y_run, line, cell),
        }
    }
}

/// Factors of the values and slopes in x, and of the values in x beside slopes in y.
#[inline(always)]
fn factors(w: &SiteWeights, r: [f64; 3]) -> [f64; 3] {
    [w.z * r[0], w.a * r[1], w.b * r[1] + w.d * r[2]]
}

#[inline(always)]
fn add_line<const P: usize, const Q: usize>(
    axes: [GridAxis; 2],
    i: usize,
    y_run: Range<usize>,
    line: impl Fn(usize) -> [f64; 3],
    cell: &mut [f64],
) {
    let [n, dn] = axes[0].rows(i).map(|row| std::array::from_fn::<f64, P, _>(|a| row[a]));
    let mut sums: [[f64; Q]; P] = std::array::from_fn(|a| std::array::from_fn(|b| cell[a * Q + b]));
    let start = y_run.start;
    for j in y_run {
        let [value, slope_x, slope_y] = line(j - start);
        let [m, dm] = axes[1].rows(j).map(|row| std::array::from_fn::<f64, Q, _>(|b| row[b]));
        for a in 0..P {
            let (along, across) = (value * n[a] + slope_x * dn[a], slope_y * n[a]);
            for b in 0..Q {
                sums[a][b] += along * m[b] + across * dm[b];
            }
        }
    }
    for (row, sums) in cell.chunks_exact_mut(Q).zip(&sums) {
        row.copy_from_slice(sums);
    }
}

fn add_long_line(
    axes: [GridAxis; 2],
    i: usize,
    y_run: Range<usize>,
    line: impl Fn(usize) -> [f64; 3],
    cell: &mut [f64],
) {
    let [n, dn] = axes[0].rows(i);
    let start = y_run.start;
    for j in y_run {
        let [value, slope_x, slope_y] = line(j - start);
        let [m, dm] = axes[1].rows(j);
        for ((row, n), dn) in cell.chunks_exact_mut(axes[1].width).zip(n).zip(dn) {
            let (along, across) = (value * n + slope_x * dn, slope_y * n);
            for ((target, m), dm) in row.iter_mut().zip(m).zip(dm) {
                *target += along * m + across * dm;
            }
        }
    }
}
