//! All derivatives of a tensor spline along one row of a grid of points, and S and R from them.
//!
//! ```text
//! L_d[j] = sum_a N_a^(d)(x) c[first + a][j]      d = 0, 1, 2: the row's three curves in y
//! on a segment:  L_d(y) = sum_k P_d,k t^k,   P_d,k = sum_v D_k[v] L_d[first_y + v],   t = y - centre
//! S_x = L_1, S_xx = L_2, S_y = L_0', S_xy = L_1', S_yy = L_0''
//! ```
//!
//! One polynomial per segment instead of q + 1 basis values per point: 11 multiply-adds a point for a bicubic instead
//! of 20, and no table of basis values to read.

use std::ops::Range;

use super::lanes::Lanes;
use super::shape_maps::ShapeBatch;
use super::{Isa, dispatch};

/// Points whose S and R are computed together. Their 6 KiB leave room in the first-level cache for the row's curves; a
/// longer batch would not.
const BATCH: usize = 256;

/// The points of a row in runs that lie on one segment each, with the Taylor coefficients of the segment's basis functions.
#[derive(Clone, Debug)]
pub struct RowPieces {
    pub(super) degree: usize,
    /// Basis functions in y.
    pub(super) n_basis: usize,
    /// One past the last point of every run.
    pub(super) ends: Vec<usize>,
    /// First basis function of every run.
    pub(super) first: Vec<usize>,
    /// `taylor[(k (q + 1) + v) padded + run]`: k-th derivative over k! of basis function `first + v` at the centre.
    pub(super) taylor: Vec<f64>,
    pub(super) padded: usize,
    /// `y - centre` of every point, padded by one set of lanes.
    pub(super) offsets: Vec<f64>,
    pub(super) contiguous: bool,
}

/// Buffers of [`curvature_row`]; one for each thread, reusable.
#[derive(Clone, Debug, Default)]
pub struct RowScratch {
    curves: Vec<f64>,
    gathered: Vec<f64>,
    pieces: Vec<f64>,
    out: Vec<f64>,
}

impl RowPieces {
    /// From the runs, each `(points, first basis function, k-th derivative over k! of the q + 1 basis functions at the
    /// segment's centre: k-major)`, and every point's offset from the centre of its segment.
    pub fn new<'a>(
        degree: usize,
        n_basis: usize,
        runs: impl Iterator<Item = (usize, usize, &'a [f64])> + Clone,
        offsets: &[f64],
    ) -> RowPieces {
        let count = runs.clone().count();
        let padded = count.next_multiple_of(8);
        let width = degree + 1;
        let mut made = RowPieces {
            degree,
            n_basis,
            ends: Vec::with_capacity(count),
            first: Vec::with_capacity(count),
            taylor: vec![0.0; width * width * padded],
            padded,
            offsets: offsets.to_vec(),
            contiguous: true,
        };
        made.offsets.resize(offsets.len() + 8, 0.0);
        let mut end = 0;
        for (run, (points, first, taylor)) in runs.enumerate() {
            end += points;
            made.ends.push(end);
            made.first.push(first);
            made.contiguous &= first == made.first[0] + run;
            for (k, value) in taylor.iter().enumerate() {
                made.taylor[k * padded + run] = *value;
            }
        }
        assert_eq!(end, offsets.len(), "the runs cover the points");
        made
    }

    /// Number of points in a row.
    pub fn len(&self) -> usize {
        self.offsets.len() - 8
    }

    /// Multiply-adds of a row: three curves along y of so many rows of coefficients, and six derivatives at every point.
    pub fn multiply_adds(&self, rows: usize) -> usize {
        3 * rows * self.n_basis + 6 * (self.degree + 1) * self.len()
    }

    /// No points at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degree q.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The first basis function of the only segment with points; `None` where there are more.
    pub fn only_segment(&self) -> Option<usize> {
        if let [first] = self.first[..] { Some(first) } else { None }
    }
}

impl RowScratch {
    /// Makes the buffers large enough for `row`.
    fn make_room(&mut self, row: &RowPieces) {
        let width = row.degree + 1;
        let grow = |v: &mut Vec<f64>, n: usize| {
            if v.len() < n {
                v.resize(n, 0.0);
            }
        };
        grow(&mut self.curves, 3 * (row.n_basis + 8));
        grow(&mut self.gathered, if row.contiguous { 0 } else { 3 * width * row.padded });
        grow(&mut self.pieces, 3 * width * row.padded);
        grow(&mut self.out, 6 * (row.len() + 8));
    }
}

/// `L_d[j] = sum_a basis[d][a] rows[a m + j]` of the lanes from `j` on, into `curves[d stride + j]`, all three d at once.
#[inline(always)]
fn curves_at<V: Lanes>(weights: &[[V; 10]; 3], width: usize, rows: &[f64], m: usize, j: usize, curves: &mut [f64]) {
    let mut sums = [V::splat(0.0); 3];
    for a in 0..width {
        let line = V::load(&rows[a * m + j..]);
        for d in 0..3 {
            sums[d] = weights[d][a].mul_add(line, sums[d]);
        }
    }
    for d in 0..3 {
        sums[d].store(&mut curves[d * (m + 8) + j..]);
    }
}

/// L_d over the m basis functions in y.
#[inline(always)]
fn curves_of<V: Lanes>(basis: [&[f64]; 3], width: usize, rows: &[f64], m: usize, curves: &mut [f64]) {
    let mut weights = [[V::splat(0.0); 10]; 3];
    for d in 0..3 {
        for a in 0..width {
            weights[d][a] = V::splat(basis[d][a]);
        }
    }
    if m < V::N {
        for j in 0..m {
            for d in 0..3 {
                curves[d * (m + 8) + j] = (0..width).map(|a| basis[d][a] * rows[a * m + j]).sum();
            }
        }
        return;
    }
    for j in (0..m - V::N).step_by(V::N) {
        curves_at(&weights, width, rows, m, j, curves);
    }
    // the last set of lanes overlaps the one before it, so that it does not reach beyond the row
    curves_at(&weights, width, rows, m, m - V::N, curves);
}

/// P_d,k of every run: `pieces[(d (q + 1) + k) padded + run]`.
#[inline(always)]
fn pieces_of<V: Lanes>(row: &RowPieces, q: usize, curves: &[f64], gathered: &mut [f64], pieces: &mut [f64]) {
    let (width, padded, stride) = (q + 1, row.padded, row.n_basis + 8);
    if !row.contiguous {
        for (run, first) in row.first.iter().enumerate() {
            for v in 0..width {
                for d in 0..3 {
                    gathered[(d * width + v) * padded + run] = curves[d * stride + first + v];
                }
            }
        }
    }
    for run in (0..padded).step_by(V::N) {
        let mut values = [[V::splat(0.0); 3]; 10];
        for (v, value) in values[..width].iter_mut().enumerate() {
            for d in 0..3 {
                value[d] = V::load(if row.contiguous {
                    &curves[d * stride + row.first[0] + v + run..]
                } else {
                    &gathered[(d * width + v) * padded + run..]
                });
            }
        }
        for k in 0..width {
            let mut sums = [V::splat(0.0); 3];
            for (v, value) in values[..width].iter().enumerate() {
                let taylor = V::load(&row.taylor[(k * width + v) * padded + run..]);
                for d in 0..3 {
                    sums[d] = taylor.mul_add(value[d], sums[d]);
                }
            }
            for d in 0..3 {
                sums[d].store(&mut pieces[(d * width + k) * padded + run..]);
            }
        }
    }
}

/// The `d`-th derivative of `sum_k c_k t^k`, Horner with the factors k (k - 1) .. folded in.
#[inline(always)]
fn horner<V: Lanes>(c: &[V; 10], q: usize, t: V) -> V {
    let mut sum = c[q];
    for k in (0..q).rev() {
        sum = sum.mul_add(t, c[k]);
    }
    sum
}

/// Calls `point(index, [S, S_x, S_y, S_xx, S_xy, S_yy])` for every set of lanes of the runs that hold `points`, the first
/// of them on `run`; lanes beyond a run's end hold the polynomial's continuation and are overwritten by the next run.
/// Returns the run that the next point is on.
#[inline(always)]
fn walk<V: Lanes>(
    row: &RowPieces,
    q: usize,
    pieces: &[f64],
    points: Range<usize>,
    mut run: usize,
    mut point: impl FnMut(usize, [V; 6]),
) -> usize {
    let (width, padded) = (q + 1, row.padded);
    let zero = V::splat(0.0);
    let mut from = points.start;
    while from < points.end {
        let to = row.ends[run].min(points.end);
        let mut value = [[zero; 10]; 3];
        let mut slope = [[zero; 10]; 2];
        let mut second = [zero; 10];
        for k in 0..width {
            for d in 0..3 {
                value[d][k] = V::splat(pieces[(d * width + k) * padded + run]);
            }
        }
        for k in 1..width {
            for d in 0..2 {
                slope[d][k - 1] = V::splat(k as f64) * value[d][k];
            }
        }
        for k in 1..q {
            second[k - 1] = V::splat(k as f64) * slope[0][k];
        }
        for i in (from..to).step_by(V::N) {
            let t = V::load(&row.offsets[i..]);
            let yy = if q < 2 { zero } else { horner(&second, q - 2, t) };
            let y = horner(&slope[0], q - 1, t);
            let xy = horner(&slope[1], q - 1, t);
            point(i, [horner(&value[0], q, t), horner(&value[1], q, t), y, horner(&value[2], q, t), xy, yy]);
        }
        run += usize::from(to == row.ends[run]);
        from = to;
    }
    run
}

/// End of the batch that begins at point `from` on `run`: the end of the last run that fits, or a point within a run that
/// is longer than a batch.
#[inline(always)]
fn batch_end(row: &RowPieces, run: usize, from: usize) -> usize {
    // room for the lanes beyond the end
    let most = from + BATCH - 8;
    row.ends[run..].iter().copied().take_while(|end| *end <= most).last().unwrap_or(most)
}

/// Runs `$body` with `$q` a literal for the usual degrees, so that the loops over powers unroll.
macro_rules! with_degree {
    ($degree:expr, $q:ident => $body:expr) => {
        match $degree {
            2 => {
                let $q = 2;
                $body
            }
            3 => {
                let $q = 3;
                $body
            }
            4 => {
                let $q = 4;
                $body
            }
            $q => $body,
        }
    };
}

/// L_d over the m basis functions in y, with a width that the compiler knows for the usual degrees, which keeps the weights
/// in registers.
#[inline(always)]
fn curves<V: Lanes>(row: &RowPieces, basis: [&[f64]; 3], rows: &[f64], scratch: &mut RowScratch) {
    with_degree!(basis[0].len() - 1, p => curves_of::<V>(basis, p + 1, rows, row.n_basis, &mut scratch.curves));
}

#[inline(always)]
fn shape<V: Lanes>(
    row: &RowPieces,
    basis: [&[f64]; 3],
    rows: &[f64],
    scratch: &mut RowScratch,
    shape_index: &mut [f64],
    curvedness: &mut [f64],
) {
    let n = row.len();
    curves::<V>(row, basis, rows, scratch);
    with_degree!(row.degree, q => {
        pieces_of::<V>(row, q, &scratch.curves, &mut scratch.gathered, &mut scratch.pieces);
        let mut batch = ShapeBatch::<BATCH>::new();
        let (mut from, mut run) = (0, 0);
        while from < n {
            let to = batch_end(row, run, from);
            run = walk::<V>(row, q, &scratch.pieces, from..to, run, |i, [_, x, y, xx, xy, yy]| {
                batch.put(i - from, [x, y, xx, xy, yy]);
            });
            batch.finish::<V>(&mut shape_index[from..to], &mut curvedness[from..to]);
            from = to;
        }
    });
}

#[inline(always)]
fn derive<V: Lanes>(row: &RowPieces, basis: [&[f64]; 3], rows: &[f64], scratch: &mut RowScratch, out: [&mut [f64]; 6]) {
    let n = row.len();
    let stride = n + 8;
    curves::<V>(row, basis, rows, scratch);
    with_degree!(row.degree, q => {
        pieces_of::<V>(row, q, &scratch.curves, &mut scratch.gathered, &mut scratch.pieces);
        walk::<V>(row, q, &scratch.pieces, 0..n, 0, |i, all| {
            for (k, value) in all.into_iter().enumerate() {
                value.store(&mut scratch.out[k * stride + i..]);
            }
        });
    });
    for (k, target) in out.into_iter().enumerate() {
        target[..n].copy_from_slice(&scratch.out[k * stride..k * stride + n]);
    }
}

/// S and R at the points of `row` for one x. `basis[d]` holds the d-th derivatives of the p + 1 basis functions at x,
/// `rows` their p + 1 rows of coefficients (each `n_basis` long, one after the other). S is NaN where the surface is flat.
///
/// # Panics
/// When an array is shorter than its shape.
pub fn curvature_row(
    isa: Isa,
    row: &RowPieces,
    basis: [&[f64]; 3],
    rows: &[f64],
    scratch: &mut RowScratch,
    shape_index: &mut [f64],
    curvedness: &mut [f64],
) {
    scratch.make_room(row);
    dispatch!(isa, shape [](
        row: &RowPieces, basis: [&[f64]; 3], rows: &[f64], scratch: &mut RowScratch,
        shape_index: &mut [f64], curvedness: &mut [f64]));
}

/// `[S, S_x, S_y, S_xx, S_xy, S_yy]` at the points of `row` for one x; arguments as in [`curvature_row`].
///
/// # Panics
/// When an array is shorter than its shape.
pub fn derivative_row(
    isa: Isa,
    row: &RowPieces,
    basis: [&[f64]; 3],
    rows: &[f64],
    scratch: &mut RowScratch,
    out: [&mut [f64]; 6],
) {
    scratch.make_room(row);
    dispatch!(isa, derive [](
        row: &RowPieces, basis: [&[f64]; 3], rows: &[f64], scratch: &mut RowScratch, out: [&mut [f64]; 6]));
}
