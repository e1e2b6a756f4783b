//! Digits that an answer is promised to have, before anyone knows the truth.
//!
//! ```text
//! |D^-1 dc| <= 10 w (kappa + kappa^2 |r| / (|E D| |D^-1 c|)) |D^-1 c|       w backward error, D the columns' inverse norms
//! |g'dc|    <= |D g| |D^-1 dc|
//! |g'dc|    <= v (sqrt(g'A^-1 g) | |E||c| + |r| + |b| |_2 + |A^-1 g|' |E|'|r|)     A = E'E, where A^-1 is at hand;
//!                                                                                     v = w / (1 - 10 w kappa)
//! |dS| <= |g'dc| of S's gradient + rounding of the derivatives that S is made of    R likewise, relative
//! ```
//!
//! The factor 10 allows for the condition estimator's underestimate. The third line is the same perturbation of the
//! augmented system, `dc = E^+ (db - dE c) + A^-1 dE'r`, taken in the direction that is asked about instead of the
//! worst one: on small problems it promises about two digits more, and v allows for the second order. The smaller bound
//! is used. Promised digits are `-log10` of the worst bound.

use super::backward::Backward;
use super::{Fit, MethodUsed};
use crate::bspline::BasisRow;
use crate::curvature::{Principal, principal_curvatures};
use crate::shape::{ShapeGrid, shape_gradient};
use crate::surface::HeightField;

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Hager's and Higham's estimate is a lower bound, nearly always within a factor 3; two of them are multiplied.
const ESTIMATOR: f64 = 10.0;
/// Placing data and knots in the patch frame rounds each of them: no backward error is below this.
const PLACING: f64 = UNIT;
/// Derivatives are sums over the tensor basis; each term is rounded about this often.
const TERM: f64 = 8.0 * UNIT;
/// Unknowns up to which A^-1 is written out: n^3 multiplications against the fit's g n^2.
const INVERTED: usize = 100;
/// Condition up to which A^-1 has digits enough for a bound: had from Cholesky of the normal matrix, and from R of the rows.
const INVERTIBLE: [f64; 2] = [1e6, 1e12];

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

/// What bounds a linear functional of the coefficients.
struct Bound {
    /// D over its largest entry; zero for unsupported coefficients.
    inverse: Vec<f64>,
    /// The bound on `|D^-1 dc|` times D's largest entry.
    moved: f64,
    directed: Option<Directed>,
}

/// The bound in the direction asked about.
struct Directed {
    /// A^-1, row by row.
    inverse: Vec<f64>,
    rows: f64,
    columns: Vec<f64>,
    backward: f64,
    settled: f64,
}

/// Digits from the condition and the backward error.
pub fn promise(fit: &Fit, condition: f64, backward: &Backward) -> Promise {
    let c = &fit.fitted.solution.coefficients;
    let Some(bound) = Bound::new(fit, condition, backward) else { return Promise::default() };
    let frame = fit.frame();
    let origin = if frame.keeps_axes() { frame.origin[2] } else { frame.turn(frame.origin)[2] };
    let largest = c.iter().fold(0.0_f64, |m, v| m.max((origin / frame.scale + v).abs()));
    let worst = (0..c.len()).fold(0.0_f64, |m, u| maximum(m, bound.of(&[(u, 1.0)])));
    let [shape_index, curvedness] = shape_moves(fit, &bound);
    Promise {
        coefficients: digits(if largest > 0.0 { worst / largest } else { 0.0 }),
        shape_index: digits(shape_index),
        curvedness: digits(curvedness),
    }
}

/// `-log10` of a bound and one last rounding, between 0 and 15.95. NaN promises nothing.
fn digits(bound: f64) -> f64 {
    if bound.is_nan() { 0.0 } else { (-(bound + UNIT).log10()).max(0.0) }
}

impl Bound {
    /// `None` when no coefficient is held by data.
    fn new(fit: &Fit, condition: f64, backward: &Backward) -> Option<Bound> {
        let solution = &fit.fitted.solution;
        let c = &solution.coefficients;
        let mut inverse = backward.norms.clone();
        inverse.iter_mut().for_each(|n| *n = if *n > 0.0 { 1.0 / n.sqrt() } else { 0.0 });
        solution.unsupported.iter().for_each(|&u| inverse[u] = 0.0);
        let largest = inverse.iter().fold(0.0_f64, |m, d| m.max(*d));
        if largest == 0.0 {
            return None;
        }
        let scaled = c.iter().zip(&inverse).filter(|(_, d)| **d > 0.0).map(|(c, d)| c / d * largest);
        let size = scaled.fold(0.0_f64, |s, v| s + v * v).sqrt();
        let held = inverse.iter().filter(|d| **d > 0.0).count() as f64;
        let error = backward.error.max(PLACING);
        let residual = largest * backward.residual;
        // what a contraction by half leaves after the last step
        let settled = if fit.fitted.settled > 0.0 { fit.fitted.settled.max(UNIT) } else { 0.0 };
        let moved = ESTIMATOR * error * (condition * size + condition * condition * residual / held.sqrt());
        inverse.iter_mut().for_each(|d| *d /= largest);
        let directed = Directed::new(fit, condition, backward, settled);
        Some(Bound { inverse, moved: moved + settled * size, directed })
    }

    /// Bound on the move of `sum g_u c_u`; infinite sums come out as NaN.
    fn of(&self, gradient: &[(usize, f64)]) -> f64 {
        let square: f64 = gradient.iter().map(|(u, g)| (self.inverse[*u] * g).powi(2)).sum();
        let plain = self.moved * square.sqrt();
        match &self.directed {
            Some(directed) => plain.min(directed.of(gradient)),
            None => plain,
        }
    }
}

impl Directed {
    /// `None` where A^-1 is dear, not to be trusted, or not the inverse of E'E.
    fn new(fit: &Fit, condition: f64, backward: &Backward, settled: f64) -> Option<Directed> {
        let (equations, solution) = (&fit.fitted.equations, &fit.fitted.solution);
        let order = equations.unknowns();
        let whole = solution.unsupported.is_empty() && solution.pinned.is_none() && equations.roughness.is_none();
        let invertible = INVERTIBLE[usize::from(solution.method != MethodUsed::Cholesky)];
        if order > INVERTED || !whole || solution.rank < order || condition > invertible {
            return None;
        }
        let mut inverse = vec![0.0; order * order];
        for (u, row) in inverse.chunks_exact_mut(order).enumerate() {
            row[u] = 1.0;
            solution.factor.solve(row);
        }
        let largest = solution.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let error = backward.error.max(PLACING);
        let second_order = 1.0 - ESTIMATOR * error * condition;
        (second_order > 0.5).then_some(Directed {
            inverse,
            rows: backward.rows,
            columns: backward.columns.clone(),
            backward: error / second_order,
            settled: settled * largest,
        })
    }

    fn of(&self, gradient: &[(usize, f64)]) -> f64 {
        let order = self.columns.len();
        let (mut by_rows, mut by_columns) = (0.0, 0.0);
        let mut space = [0.0; INVERTED];
        let v = &mut space[..order];
        for (u, g) in gradient {
            v.iter_mut().zip(&self.inverse[u * order..]).for_each(|(v, a)| *v += g * a);
        }
        gradient.iter().for_each(|(u, g)| by_rows += g * v[*u]);
        v.iter().zip(&self.columns).for_each(|(v, t)| by_columns += v.abs() * t);
        let left: f64 = gradient.iter().map(|(_, g)| g.abs()).sum();
        self.backward * (by_rows.max(0.0).sqrt() * self.rows + by_columns) + self.settled * left
    }
}

/// Bounds on `|dS|` and `|dR| / R` at the worst supported point of the shape grid.
fn shape_moves(fit: &Fit, bound: &Bound) -> [f64; 2] {
    let surface = fit.surface();
    let domain = [surface.knots()[0].domain(), surface.knots()[1].domain()];
    let grid = ShapeGrid::over(domain, fit.options().grid, fit.options().inset);
    let maps = &fit.shape().maps;
    let rows = |axis: usize, at: &[f64]| at.iter().map(|v| surface.knots()[axis].basis(*v)).collect::<Vec<_>>();
    let (along_x, along_y) = (rows(0, &grid.x), rows(1, &grid.y));
    let mut worst = [0.0_f64; 2];
    for (i, bx) in along_x.iter().enumerate() {
        for (j, by) in along_y.iter().enumerate() {
            if maps.shape_index_at(i, j).is_some() {
                let [s, r] = point_moves(surface, [bx, by], bound);
                worst = [maximum(worst[0], s), maximum(worst[1], r)];
            }
        }
    }
    worst
}

/// The larger one, or NaN if there is one.
fn maximum(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn point_moves(surface: &HeightField, [bx, by]: [&BasisRow; 2], bound: &Bound) -> [f64; 2] {
    let point = surface.with_rows(bx, by);
    let Some(principal) = principal_curvatures(&point.derivatives()) else { return [f64::NAN; 2] };
    let (by_s, by_r) = shape_gradient(&point);
    if by_s == [0.0; 5] && principal.curvedness() > 0.0 {
        // curvatures whose squares overflow or vanish: the gradient is not there to be relied on
        return [f64::NAN; 2];
    }
    let columns = surface.coefficients().ncols();
    let alive = bx.derivative(0).len() * by.derivative(0).len();
    let (mut of_s, mut of_r) = (Vec::with_capacity(alive), Vec::with_capacity(alive));
    let (mut spread, mut terms) = ([0.0; 5], [0.0; 5]);
    for a in 0..bx.derivative(0).len() {
        for b in 0..by.derivative(0).len() {
            let unknown = (bx.first + a) * columns + by.first + b;
            let row = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].map(|(k, l)| bx.derivative(k)[a] * by.derivative(l)[b]);
            let dot = |g: &[f64; 5]| (0..5).map(|k| g[k] * row[k]).sum::<f64>();
            of_s.push((unknown, dot(&by_s)));
            of_r.push((unknown, dot(&by_r)));
            let d = bound.inverse[unknown];
            let c = surface.coefficients()[[bx.first + a, by.first + b]].abs();
            (0..5).for_each(|k| spread[k] += (row[k] * d).powi(2));
            (0..5).for_each(|k| terms[k] += c * row[k].abs());
        }
    }
    let rounding = |g: &[f64; 5]| (0..5).map(|k| g[k].abs() * TERM * terms[k]).sum::<f64>();
    let off: [f64; 5] = std::array::from_fn(|k| bound.moved * spread[k].sqrt() + TERM * terms[k]);
    let s = bound.of(&of_s) + rounding(&by_s) + kink(principal, &off) + TERM;
    [s, (bound.of(&of_r) + rounding(&by_r)) / principal.curvedness() + TERM]
}

/// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
fn kink(p: Principal, off: &[f64; 5]) -> f64 {
    let bend = p.k1.abs().max(p.k2.abs());
    let gap = 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
    if p.difference > gap { 0.0 } else { std::f64::consts::FRAC_2_PI * gap / (2.0 * p.curvedness()) }
}
