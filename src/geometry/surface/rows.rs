//! S and R of a height field over a whole grid of points, row by row; derivatives stay in the first-level cache.
//!
//! ```text
//! S, S_x, .., S_yy of one x at all y:  sum_b (sum_a c_ab N_a^(k)(x)) M_b^(l)(y),  M_b a Taylor polynomial per segment
//! ```

use std::sync::Mutex;

use super::HeightField;
use palpate_numeric::bspline::Knots;
use palpate_numeric::simd::{Isa, PATCH_POINTS, RowPieces, RowScratch, curvature_row, derivative_row, patch_maps};
use palpate_numeric::work;

/// A grid of points prepared for one pair of knot vectors; coefficients may change from call to call.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use palpate::spline::Knots;
/// use palpate::spline::CurvatureGrid;
///
/// // z = x^2 is a rut along y: S = -1/2
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let points = [-0.5, -0.2, 0.2, 0.5];
/// let mut grid = CurvatureGrid::new(&[axis.clone(), axis], &points, &points);
/// let (mut s, mut r) = ([0.0; 16], [0.0; 16]);
/// grid.maps(&[1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0], &mut s, &mut r);
/// assert!(s.iter().all(|s| (s + 0.5).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CurvatureGrid {
    pieces: RowPieces,
    first: Vec<usize>,
    /// Values, first and second derivatives of the p + 1 basis functions at every x.
    basis: [Vec<f64>; 3],
    width: usize,
    columns: usize,
    /// One for every thread at work, so that each stays in the cache of its thread.
    scratch: Mutex<Vec<RowScratch>>,
}

/// Rows of points of one task: enough to pay for handing it over, few enough to share the work evenly.
const ROWS: usize = 32;

impl Clone for CurvatureGrid {
    /// The same points; the clone makes buffers of its own as it needs them.
    fn clone(&self) -> CurvatureGrid {
        CurvatureGrid {
            pieces: self.pieces.clone(),
            first: self.first.clone(),
            basis: self.basis.clone(),
            width: self.width,
            columns: self.columns,
            scratch: Mutex::default(),
        }
    }
}

impl CurvatureGrid {
    /// Prepares the points `x` by `y` (y ascending) under `knots`.
    pub fn new(knots: &[Knots; 2], x: &[f64], y: &[f64]) -> CurvatureGrid {
        let width = knots[0].degree() + 1;
        let mut basis = [Vec::new(), Vec::new(), Vec::new()];
        let mut first = Vec::with_capacity(x.len());
        for &at in x {
            let row = knots[0].basis(at);
            first.push(row.first);
            for (d, table) in basis.iter_mut().enumerate() {
                table.extend_from_slice(row.derivative(d));
            }
        }
        let columns = knots[1].n_basis();
        CurvatureGrid { pieces: pieces_of(&knots[1], y), first, basis, width, columns, scratch: Mutex::default() }
    }

    /// S and R at every point, row-major; S is NaN where the surface is flat. `coefficients` are n x m, row-major.
    ///
    /// Rows are shared among the threads of the current pool; the bits do not depend on their number.
    ///
    /// # Panics
    /// When an array is shorter than its shape.
    pub fn maps(&mut self, coefficients: &[f64], shape_index: &mut [f64], curvedness: &mut [f64]) {
        if self.on_one_segment(coefficients, shape_index, curvedness) {
            return;
        }
        self.range(0, coefficients, shape_index, curvedness);
    }

    /// Height and derivatives along every row of points, in order: `row(i, [S, S_x, S_y, S_xx, S_xy, S_yy])`.
    ///
    /// # Panics
    /// When `coefficients` are fewer than the knots' basis functions.
    pub fn derivatives(&mut self, coefficients: &[f64], mut row: impl FnMut(usize, [&[f64]; 6])) {
        let mut scratch = self.take_scratch();
        let isa = Isa::active();
        let mut out: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; self.pieces.len()]);
        for (i, &first) in self.first.iter().enumerate() {
            let basis = self.basis.each_ref().map(|table| &table[i * self.width..(i + 1) * self.width]);
            let lines = &coefficients[first * self.columns..];
            work::add(self.pieces.multiply_adds(basis[0].len()));
            derivative_row(isa, &self.pieces, basis, lines, &mut scratch, out.each_mut().map(|column| &mut column[..]));
            row(i, out.each_ref().map(|column| &column[..]));
        }
        self.put_scratch(scratch);
    }

    fn take_scratch(&self) -> RowScratch {
        self.scratch.lock().ok().and_then(|mut pool| pool.pop()).unwrap_or_default()
    }

    fn put_scratch(&self, scratch: RowScratch) {
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }

    /// Evaluates a small grid on one segment at once; `false` where the grid is not of this kind.
    fn on_one_segment(&self, coefficients: &[f64], shape_index: &mut [f64], curvedness: &mut [f64]) -> bool {
        let points = self.first.len() * self.pieces.len();
        let (Some(&first), Some(column)) = (self.first.first(), self.pieces.only_segment()) else { return false };
        let small = points <= PATCH_POINTS && self.width == self.pieces.degree() + 1;
        if !small || self.first.iter().any(|f| *f != first) {
            return false;
        }
        let basis = self.basis.each_ref().map(|table| &table[..]);
        let coefficients = &coefficients[first * self.columns + column..];
        let (s, r) = (&mut shape_index[..points], &mut curvedness[..points]);
        patch_maps(Isa::active(), &self.pieces, basis, coefficients, s, r)
    }

    /// The maps of a surface over these knots.
    pub fn maps_of(&mut self, surface: &HeightField, shape_index: &mut [f64], curvedness: &mut [f64]) {
        let standard = surface.coefficients().as_standard_layout();
        if let Some(coefficients) = standard.as_slice() {
            self.maps(coefficients, shape_index, curvedness);
        }
    }

    /// Halves the rows until one task is left.
    fn range(&self, from: usize, c: &[f64], s: &mut [f64], r: &mut [f64]) {
        let (m, rows) = (self.pieces.len(), (self.first.len() - from).min(s.len() / self.pieces.len().max(1)));
        if rows > ROWS {
            let half = rows.div_ceil(ROWS) / 2 * ROWS;
            let (s_a, s_b) = s.split_at_mut(half * m);
            let (r_a, r_b) = r.split_at_mut(half * m);
            palpate_numeric::threads::join(|| self.range(from, c, s_a, r_a), || self.range(from + half, c, s_b, r_b));
            return;
        }
        let mut scratch = self.take_scratch();
        let isa = Isa::active();
        for (k, (s, r)) in s.chunks_mut(m).zip(r.chunks_mut(m)).take(rows).enumerate() {
            let values = (from + k) * self.width..(from + k + 1) * self.width;
            let basis = self.basis.each_ref().map(|table| &table[values.clone()]);
            let lines = &c[self.first[from + k] * self.columns..];
            work::add(self.pieces.multiply_adds(basis[0].len()));
            curvature_row(isa, &self.pieces, basis, lines, &mut scratch, s, r);
        }
        self.put_scratch(scratch);
    }
}

/// Runs of points on one segment, each with the segment's Taylor coefficients at its centre.
pub fn pieces_of(knots: &Knots, points: &[f64]) -> RowPieces {
    let width = knots.degree() + 1;
    let segments: Vec<usize> = points.iter().map(|y| knots.segment_of(*y)).collect();
    let centre = |s: usize| 0.5 * (knots.segment(s)[0] + knots.segment(s)[1]);
    let offsets: Vec<f64> = points.iter().zip(&segments).map(|(y, &s)| y - centre(s)).collect();
    let mut tables = Vec::new();
    for run in segments.chunk_by(|a, b| a == b) {
        let mut taylor = vec![0.0; width * width];
        knots.derivatives_on(run[0], centre(run[0]), width - 1, &mut taylor);
        let mut factorial = 1.0;
        for k in 1..width {
            factorial *= k as f64;
            taylor[k * width..(k + 1) * width].iter_mut().for_each(|v| *v /= factorial);
        }
        tables.push((run.len(), knots.first_basis(run[0]), taylor));
    }
    let runs = tables.iter().map(|(points, first, taylor)| (*points, *first, &taylor[..]));
    RowPieces::new(knots.degree(), knots.n_basis(), runs, &offsets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use palpate_numeric::bspline::linspace;

    #[test]
    fn rows_agree_with_points_for_every_degree() {
        for (degree, segments, points) in [
            ([2, 2], [1, 1], 8),
            ([3, 3], [1, 1], 13),
            ([4, 4], [1, 1], 21),
            ([3, 3], [9, 13], 70),
            ([2, 4], [5, 40], 23),
            ([5, 1], [3, 6], 41),
        ] {
            let knots = [
                Knots::uniform(degree[0], segments[0], 0.0, 1.0).unwrap(),
                Knots::uniform(degree[1], segments[1], -1.0, 2.0).unwrap(),
            ];
            let shape = (knots[0].n_basis(), knots[1].n_basis());
            let c = Array2::from_shape_fn(shape, |(i, j)| (i as f64 * 0.9 + j as f64 * 0.4).sin());
            let surface = HeightField::new(knots.clone(), c).unwrap();
            let (x, y) = (linspace(0.0, 1.0, 45), linspace(-1.0, 2.0, points));
            let mut grid = CurvatureGrid::new(&knots, &x, &y);
            let (mut s, mut r) = (vec![0.0; 45 * points], vec![0.0; 45 * points]);
            grid.maps_of(&surface, &mut s, &mut r);
            let largest = r.iter().fold(0.0_f64, |m, v| m.max(*v));
            for i in 0..45 {
                for j in 0..points {
                    let k = surface.at(x[i], y[j]).derivatives().principal().unwrap();
                    let (found, curved) = (s[i * points + j], r[i * points + j]);
                    assert!((curved - k.curvedness()).abs() < 1e-12 * k.curvedness().max(largest / 100.0));
                    if k.curvedness() > largest / 100.0 {
                        assert!((found - k.shape_index().unwrap()).abs() < 1e-11, "{degree:?} ({i}, {j})");
                    }
                }
            }
        }
    }
}
