//! Digits that an answer is promised to have, before anyone knows the truth.
//!
//! ```text
//! |dc_u|    <= bound of the functional c_u                                                       bounds.rs
//! |dS| <= |g'dc| of S's gradient + rounding of the derivatives that S is made of    R likewise, relative
//! ```
//!
//! Promised digits are `-log10` of the worst bound.

use super::Fit;
use super::backward::Backward;
use super::bounds::{Bound, PLACING, maximum};
use crate::bspline::BasisRow;
use crate::simd::{
    BoundTerms, CellGradients, CellPoints, Level, POINTS, ShapeGradients, functional_bounds, shape_gradients,
};

/// Unit roundoff 2^-53.
const UNIT: f64 = PLACING;
/// Derivatives are sums over the tensor basis; each term is rounded about this often.
const TERM: f64 = 8.0 * UNIT;
/// Orders of the five derivatives in x and in y.
const ORDERS: [(usize, usize); 5] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

/// Decimal digits promised for a fit, as an exact solution of the written problem would have them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Promise {
    /// Of the coefficients in the input's frame, relative to the largest.
    pub coefficients: f64,
    /// Of S at the worst supported grid point, absolute.
    pub shape_index: f64,
    /// Of R at the worst supported grid point, relative.
    pub curvedness: f64,
}

/// Digits from the condition and the backward error.
pub fn promise(fit: &Fit, condition: f64, backward: &Backward) -> Promise {
    let c = &fit.fitted.solution.coefficients;
    let Some(bound) = Bound::new(fit, condition, backward) else { return Promise::default() };
    let frame = fit.frame();
    let origin = if frame.keeps_axes() { frame.origin[2] } else { frame.turn(frame.origin)[2] };
    let largest = c.iter().fold(0.0_f64, |m, v| m.max((origin / frame.scale + v).abs()));
    let coefficients = bound.of_coefficients();
    let [shape_index, curvedness] = at_points(fit, &bound);
    Promise {
        coefficients: digits(if largest > 0.0 { coefficients / largest } else { 0.0 }),
        shape_index: digits(shape_index),
        curvedness: digits(curvedness),
    }
}

/// `-log10` of a bound and one last rounding, between 0 and 15.95. NaN promises nothing.
fn digits(bound: f64) -> f64 {
    if bound.is_nan() { 0.0 } else { (-(bound + UNIT).log10()).max(0.0) }
}

/// The worst bounds on `|dS|` and `|dR| / R` over the supported points of the shape grid, up to eight of a row at once.
fn at_points(fit: &Fit, bound: &Bound) -> [f64; 2] {
    let maps = &fit.shape().maps;
    let [along_x, along_y] = &*maps.rows;
    let pieces = Piece::of(along_y);
    let mut at = Points::new(fit, bound);
    let mut worst = [0.0; 2];
    for (i, bx) in along_x.iter().enumerate() {
        for piece in &pieces {
            let asked: [bool; POINTS] =
                std::array::from_fn(|l| l < piece.count && maps.shape_index_at(i, piece.start + l).is_some());
            if asked == [false; POINTS] {
                continue;
            }
            let found = at.bounds(bx, piece);
            for k in 0..2 {
                for l in 0..POINTS {
                    let is_worse = found[k][l] > worst[k] || found[k][l].is_nan();
                    if asked[l] && is_worse {
                        worst[k] = maximum(worst[k], found[k][l]);
                    }
                }
            }
        }
    }
    worst
}

/// Up to eight neighbours of the grid's y axis in one segment, one a lane; the last one fills up.
struct Piece {
    start: usize,
    count: usize,
    first: usize,
    /// M, M', M'', one after the other.
    values: Vec<[f64; POINTS]>,
    /// Their largest 2-norms over the basis functions.
    lengths: [f64; 3],
}

impl Piece {
    fn of(along_y: &[BasisRow]) -> Vec<Piece> {
        let mut pieces = Vec::with_capacity(along_y.len().div_ceil(POINTS));
        let mut start = 0;
        for rows in along_y.chunk_by(|a, b| a.first == b.first).flat_map(|run| run.chunks(POINTS)) {
            let width = rows[0].derivative(0).len();
            let (mut values, mut lengths) = (vec![[0.0; POINTS]; 3 * width], [0.0_f64; 3]);
            for (k, values) in values.chunks_exact_mut(width).enumerate() {
                for l in 0..POINTS {
                    let row = rows[l.min(rows.len() - 1)].derivative(k);
                    values.iter_mut().zip(row).for_each(|(lanes, v)| lanes[l] = *v);
                    lengths[k] = lengths[k].max(row.iter().map(|v| v * v).sum());
                }
            }
            pieces.push(Piece {
                start,
                count: rows.len(),
                first: rows[0].first,
                values,
                lengths: lengths.map(f64::sqrt),
            });
            start += rows.len();
        }
        pieces
    }

    /// M, M', M''.
    fn rows(&self) -> [&[[f64; POINTS]]; 3] {
        let width = self.values.len() / 3;
        [0, 1, 2].map(|k| &self.values[k * width..(k + 1) * width])
    }
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Bounds at eight points, with room for their gradients.
struct Points<'a> {
    level: Level,
    coefficients: &'a [f64],
    /// Basis functions in y.
    columns: usize,
    bound: &'a Bound<'a>,
    terms: BoundTerms<'a>,
    gradients: ShapeGradients,
    /// First unknown of the cell in every row of coefficients.
    runs: Vec<usize>,
    curves: Vec<[f64; 3]>,
    curve_sizes: Vec<[f64; 3]>,
}

impl Points<'_> {
    fn new<'a>(fit: &'a Fit, bound: &'a Bound<'a>) -> Points<'a> {
        let width = fit.options().degree.map(|d| d + 1);
        Points {
            level: Level::active(),
            coefficients: &fit.fitted.solution.coefficients,
            columns: fit.surface().coefficients().ncols(),
            bound,
            terms: bound.terms(),
            gradients: ShapeGradients::new(width[0] * width[1]),
            runs: vec![0; width[0]],
            curves: vec![[0.0; 3]; width[1]],
            curve_sizes: vec![[0.0; 3]; width[1]],
        }
    }

    /// Bounds of `|dS|` and of `|dR| / R`; NaN where curvatures are so large or small that their squares are lost.
    fn bounds(&mut self, bx: &BasisRow, piece: &Piece) -> [[f64; POINTS]; 2] {
        self.enter(bx, piece);
        let x = [bx.derivative(0), bx.derivative(1), bx.derivative(2)];
        // most points are far from umbilic: the derivatives' errors are bounded by norms before they are worked out
        let lengths = [length(x[0]), length(x[1]), length(x[2])];
        let (curves, curve_sizes, rounding) = (&self.curves[..], &self.curve_sizes[..], TERM);
        let off = ORDERS.map(|(i, j)| self.bound.moved * lengths[i] * piece.lengths[j]);
        let points = CellPoints { x, y: piece.rows(), curves, curve_sizes, off, rounding };
        shape_gradients(self.level, &points, &mut self.gradients);
        let found = &self.gradients;
        let mut rounding = found.roundings;
        if found.near != [0.0; POINTS] {
            (0..POINTS).for_each(|l| rounding[0][l] += self.kink(bx, piece, l));
        }
        let [of_shape_index, of_curvedness] = &found.by_coefficients;
        let gradients = CellGradients { runs: &self.runs, entries: [of_shape_index, of_curvedness] };
        functional_bounds(self.level, &self.terms, &gradients, &rounding, &[[1.0; POINTS], found.curvedness])
    }

    /// The cell's unknowns, and its coefficients summed along x.
    fn enter(&mut self, bx: &BasisRow, piece: &Piece) {
        let width = self.curves.len();
        self.curves.fill([0.0; 3]);
        self.curve_sizes.fill([0.0; 3]);
        for (a, run) in self.runs.iter_mut().enumerate() {
            *run = (bx.first + a) * self.columns + piece.first;
            let n = [bx.derivative(0)[a], bx.derivative(1)[a], bx.derivative(2)[a]];
            let sums = self.curves.iter_mut().zip(&mut self.curve_sizes);
            for (c, (curve, size)) in self.coefficients[*run..*run + width].iter().zip(sums) {
                for k in 0..3 {
                    curve[k] += n[k] * c;
                    size[k] += (n[k] * c).abs();
                }
            }
        }
    }

    /// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
    fn kink(&self, bx: &BasisRow, piece: &Piece, lane: usize) -> f64 {
        let found = &self.gradients;
        let bend = 0.5 * (found.sum[lane].abs() + found.difference[lane]);
        let off = [0, 1, 2, 3, 4]
            .map(|k| self.bound.moved * self.spread(bx, piece, ORDERS[k], lane) + TERM * found.terms[k][lane]);
        let gap = 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
        if found.difference[lane] > gap {
            0.0
        } else {
            std::f64::consts::FRAC_2_PI * gap / (2.0 * found.curvedness[lane])
        }
    }

    /// `|D g|_2` of the derivative of these orders in x and y at one point.
    fn spread(&self, bx: &BasisRow, piece: &Piece, (i, j): (usize, usize), lane: usize) -> f64 {
        let mut spread = 0.0;
        for (n, &start) in bx.derivative(i).iter().zip(&self.runs) {
            for (m, d) in piece.rows()[j].iter().zip(&self.bound.inverse[start..]) {
                spread += (n * m[lane] * d).powi(2);
            }
        }
        spread.sqrt()
    }
}
