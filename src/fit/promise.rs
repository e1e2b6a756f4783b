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
use crate::surface::HeightField;

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
    let surface = fit.surface();
    let maps = &fit.shape().maps;
    let [along_x, along_y] = &*maps.rows;
    let pieces = Piece::of(along_y);
    let mut at = Points::new(surface, bound);
    let mut worst = [0.0; 2];
    for (i, bx) in along_x.iter().enumerate() {
        for piece in &pieces {
            let is_asked = |lane: usize| maps.shape_index_at(i, piece.start + lane).is_some();
            if !(0..piece.count).any(is_asked) {
                continue;
            }
            let found = at.bounds(bx, piece);
            for lane in (0..piece.count).filter(|lane| is_asked(*lane)) {
                (0..2).for_each(|k| worst[k] = maximum(worst[k], found[k][lane]));
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
    /// M, M', M''.
    values: [Vec<[f64; POINTS]>; 3],
    /// Their 2-norms over the basis functions.
    lengths: [[f64; POINTS]; 3],
}

impl Piece {
    fn of(along_y: &[BasisRow]) -> Vec<Piece> {
        let mut pieces = Vec::with_capacity(along_y.len().div_ceil(POINTS));
        let mut start = 0;
        for rows in along_y.chunk_by(|a, b| a.first == b.first).flat_map(|run| run.chunks(POINTS)) {
            let lanes = |of: &dyn Fn(&BasisRow) -> f64| std::array::from_fn(|l| of(&rows[l.min(rows.len() - 1)]));
            let width = rows[0].derivative(0).len();
            let values = [0, 1, 2].map(|k| (0..width).map(|b| lanes(&|row| row.derivative(k)[b])).collect());
            let lengths = [0, 1, 2].map(|k| lanes(&|row| length(row.derivative(k))));
            pieces.push(Piece { start, count: rows.len(), first: rows[0].first, values, lengths });
            start += rows.len();
        }
        pieces
    }
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Bounds at eight points, with room for their gradients.
struct Points<'a> {
    level: Level,
    surface: &'a HeightField,
    bound: &'a Bound,
    terms: BoundTerms<'a>,
    gradients: ShapeGradients,
    /// First unknown of the cell in every row of coefficients.
    runs: Vec<usize>,
    curves: Vec<[f64; 3]>,
    curve_sizes: Vec<[f64; 3]>,
}

impl Points<'_> {
    fn new<'a>(surface: &'a HeightField, bound: &'a Bound) -> Points<'a> {
        let width = [0, 1].map(|axis| surface.knots()[axis].degree() + 1);
        Points {
            level: Level::active(),
            surface,
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
        let x = [0, 1, 2].map(|k| bx.derivative(k));
        let y = piece.values.each_ref().map(|values| &values[..]);
        let points = CellPoints { x, y, curves: &self.curves, curve_sizes: &self.curve_sizes };
        shape_gradients(self.level, &points, &mut self.gradients);
        let found = &self.gradients;
        let curvedness: [f64; POINTS] = std::array::from_fn(|l| {
            0.5 * (found.sum[l] * found.sum[l] + found.difference[l] * found.difference[l]).sqrt()
        });
        let kinks = self.kinks(bx, piece, &curvedness);
        let sizes = [[1.0; POINTS], curvedness];
        let mut rounding = [kinks, [0.0; POINTS]];
        for (rounding, (gradient, size)) in rounding.iter_mut().zip(found.roundings.iter().zip(&sizes)) {
            (0..POINTS).for_each(|l| rounding[l] += TERM * (gradient[l] + size[l]));
        }
        let entries = found.by_coefficients.each_ref().map(|entries| &entries[..]);
        let gradients = CellGradients { runs: &self.runs, entries };
        let mut bounds = functional_bounds(self.level, &self.terms, &gradients, &rounding, &sizes);
        for l in 0..POINTS {
            if !curvedness[l].is_finite() || found.reach[l] == 0.0 {
                (0..2).for_each(|k| bounds[k][l] = f64::NAN);
            }
        }
        bounds
    }

    /// The cell's unknowns, and its coefficients summed along x.
    fn enter(&mut self, bx: &BasisRow, piece: &Piece) {
        let coefficients = self.surface.coefficients();
        let (columns, width) = (coefficients.ncols(), self.curves.len());
        self.curves.fill([0.0; 3]);
        self.curve_sizes.fill([0.0; 3]);
        for a in 0..bx.derivative(0).len() {
            let n = [0, 1, 2].map(|k| bx.derivative(k)[a]);
            let row = bx.first + a;
            self.runs[a] = row * columns + piece.first;
            for b in 0..width {
                let c = coefficients[[row, piece.first + b]];
                for k in 0..3 {
                    self.curves[b][k] += n[k] * c;
                    self.curve_sizes[b][k] += (n[k] * c).abs();
                }
            }
        }
    }

    /// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
    fn kinks(&self, bx: &BasisRow, piece: &Piece, curvedness: &[f64; POINTS]) -> [f64; POINTS] {
        let ShapeGradients { sum, difference, terms, .. } = &self.gradients;
        let lengths = [0, 1, 2].map(|k| length(bx.derivative(k)));
        std::array::from_fn(|l| {
            let bend = 0.5 * (sum[l].abs() + difference[l]);
            let opens = |off: [f64; 5]| 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
            // most points are far from umbilic: the derivatives' errors are bounded by norms before they are worked out
            let at_most = opens(std::array::from_fn(|k| {
                let (i, j) = ORDERS[k];
                self.bound.moved * lengths[i] * piece.lengths[j][l] + TERM * terms[k][l]
            }));
            if difference[l] > at_most {
                return 0.0;
            }
            let gap = opens(std::array::from_fn(|k| {
                self.bound.moved * self.spread(bx, piece, ORDERS[k], l) + TERM * terms[k][l]
            }));
            if difference[l] > gap { 0.0 } else { std::f64::consts::FRAC_2_PI * gap / (2.0 * curvedness[l]) }
        })
    }

    /// `|D g|_2` of the derivative of these orders in x and y at one point.
    fn spread(&self, bx: &BasisRow, piece: &Piece, (i, j): (usize, usize), lane: usize) -> f64 {
        let mut spread = 0.0;
        for (n, &start) in bx.derivative(i).iter().zip(&self.runs) {
            for (m, d) in piece.values[j].iter().zip(&self.bound.inverse[start..]) {
                spread += (n * m[lane] * d).powi(2);
            }
        }
        spread.sqrt()
    }
}
