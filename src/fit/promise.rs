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
use crate::bspline::{BasisRow, MAX_DEGREE};
use crate::simd::{
    BoundTerms, CellGradients, CellPoints, CurveLanes, Level, ORDERS, OfKinds, POINTS, PointLanes, PointShapes,
    cell_curves, functional_bounds, shape_gradients,
};

/// Unit roundoff 2^-53.
const UNIT: f64 = PLACING;
/// Derivatives are sums over the tensor basis; each term is rounded about this often.
const TERM: f64 = 8.0 * UNIT;

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
    let (mut at, mut worst) = (Points::new(fit, bound), [0.0; 2]);
    let mut start = 0;
    for rows in along_y.chunk_by(|a, b| a.first == b.first).flat_map(|run| run.chunks(POINTS)) {
        at.turn_to(rows);
        for (i, bx) in along_x.iter().enumerate() {
            let found = at.bounds(bx);
            if exceeds(&found, worst) {
                worst = raised(worst, &found, rows.len(), |l| maps.shape_index_at(i, start + l).is_some());
            }
        }
        start += rows.len();
    }
    worst
}

/// Whether a bound is not below the worst so far; few rows have one, and only those ask where S is defined and supported.
fn exceeds(found: &OfKinds, worst: [f64; 2]) -> bool {
    let mut any = false;
    for (found, worst) in found.iter().zip(worst) {
        for bound in found {
            let is_below = *bound <= worst;
            any |= !is_below;
        }
    }
    any
}

/// The worst bounds with those of the first `count` points in it that are asked for; NaN is the worst of all.
fn raised(mut worst: [f64; 2], found: &OfKinds, count: usize, is_asked: impl Fn(usize) -> bool) -> [f64; 2] {
    for l in (0..count).filter(|l| is_asked(*l)) {
        (0..2).for_each(|k| worst[k] = maximum(worst[k], found[k][l]));
    }
    worst
}

/// Up to eight neighbours of the grid's y axis in one segment, one a lane, and bounds at them for one x after the other.
struct Points<'a> {
    level: Level,
    coefficients: &'a [f64],
    /// Basis functions in y.
    columns: usize,
    bound: &'a Bound,
    terms: BoundTerms<'a>,
    /// Basis functions alive in a cell, in x and in y.
    width: [usize; 2],
    /// First basis function in y, and in x of the cell that the curves belong to.
    first_y: usize,
    first_x: Option<usize>,
    /// M, M', M'' one after the other; the curves; dS/dc; dR/dc.
    lanes: Vec<PointLanes>,
    /// Largest 2-norms of M, M', M'' over the basis functions.
    lengths: [f64; 3],
    /// First unknown of the cell in every row of coefficients.
    runs: [usize; MAX_DEGREE + 1],
    found: PointShapes,
}

/// The parts of [`Points::lanes`].
struct Room<'a> {
    y: [&'a [PointLanes]; 3],
    curves: &'a mut [CurveLanes],
    entries: [&'a mut [PointLanes]; 2],
}

impl<'a> Room<'a> {
    fn of(lanes: &'a mut [PointLanes], [p, q]: [usize; 2]) -> Room<'a> {
        let (y, rest) = lanes.split_at_mut(3 * q);
        let (curves, entries) = rest.split_at_mut(6 * p);
        let (y, (of_s, of_r)) = (&*y, entries.split_at_mut(p * q));
        Room { y: [&y[..q], &y[q..2 * q], &y[2 * q..]], curves: curves.as_chunks_mut().0, entries: [of_s, of_r] }
    }
}

impl Points<'_> {
    fn new<'a>(fit: &'a Fit, bound: &'a Bound) -> Points<'a> {
        let width = fit.options().degree.map(|d| d + 1);
        Points {
            level: Level::active(),
            coefficients: &fit.fitted.solution.coefficients,
            columns: fit.surface().coefficients().ncols(),
            bound,
            terms: bound.terms(),
            width,
            first_y: 0,
            first_x: None,
            lanes: vec![[0.0; POINTS]; 3 * width[1] + 6 * width[0] + 2 * width[0] * width[1]],
            lengths: [0.0; 3],
            runs: [0; MAX_DEGREE + 1],
            found: PointShapes::default(),
        }
    }

    /// Goes to these neighbours; the last one fills up.
    fn turn_to(&mut self, rows: &[BasisRow]) {
        let (first, last) = (&rows[0], rows.len() - 1);
        (self.first_y, self.first_x) = (first.first, None);
        for (k, values) in self.lanes.chunks_exact_mut(self.width[1]).take(3).enumerate() {
            let mut squares = [0.0; POINTS];
            for (l, square) in squares.iter_mut().enumerate() {
                for (lanes, v) in values.iter_mut().zip(rows[l.min(last)].derivative(k)) {
                    lanes[l] = *v;
                    *square += v * v;
                }
            }
            self.lengths[k] = squares.iter().copied().fold(0.0, f64::max).sqrt();
        }
    }

    /// Bounds of `|dS|` and of `|dR| / R`; NaN where curvatures are so large or small that their squares are lost.
    fn bounds(&mut self, bx: &BasisRow) -> OfKinds {
        let Room { y, curves, entries: [of_s, of_r] } = Room::of(&mut self.lanes, self.width);
        let runs = &mut self.runs[..self.width[0]];
        if self.first_x != Some(bx.first) {
            self.first_x = Some(bx.first);
            runs.iter_mut().enumerate().for_each(|(a, run)| *run = (bx.first + a) * self.columns + self.first_y);
            cell_curves(self.level, self.coefficients, runs, y, curves);
        }
        let x = [bx.derivative(0), bx.derivative(1), bx.derivative(2)];
        let (lengths, moved) = (self.lengths, self.bound.moved);
        let points = CellPoints { x, y, curves, lengths, moved, rounding: TERM };
        shape_gradients(self.level, &points, [&mut *of_s, &mut *of_r], &mut self.found);
        if self.found.near != [0.0; POINTS] {
            self.add_kinks(bx);
        }
        let Room { entries: [of_s, of_r], .. } = Room::of(&mut self.lanes, self.width);
        let gradients = CellGradients { runs: &self.runs[..self.width[0]], entries: [of_s, of_r] };
        functional_bounds(self.level, &self.terms, &gradients, &self.found.roundings, &self.found.sizes)
    }

    /// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
    #[cold]
    fn add_kinks(&mut self, bx: &BasisRow) {
        for l in 0..POINTS {
            let off = [0, 1, 2, 3, 4]
                .map(|k| self.bound.moved * self.spread(bx, ORDERS[k], l) + TERM * self.found.terms[k][l]);
            let found = &mut self.found;
            let bend = 0.5 * (found.sum[l].abs() + found.difference[l]);
            let gap = 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
            let is_apart = found.difference[l] > gap;
            if !is_apart {
                found.roundings[0][l] += std::f64::consts::FRAC_2_PI * gap / (2.0 * found.sizes[1][l]);
            }
        }
    }

    /// `|D g|_2` of the derivative of these orders in x and y at one point.
    fn spread(&self, bx: &BasisRow, (i, j): (usize, usize), lane: usize) -> f64 {
        let y = &self.lanes[j * self.width[1]..(j + 1) * self.width[1]];
        let mut spread = 0.0;
        for (n, &start) in bx.derivative(i).iter().zip(&self.runs) {
            for (m, d) in y.iter().zip(&self.bound.inverse[start..]) {
                spread += (n * m[lane] * d).powi(2);
            }
        }
        spread.sqrt()
    }
}
