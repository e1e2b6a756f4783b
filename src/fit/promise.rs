//! Digits that an answer is promised to have, before anyone knows the truth.
//!
//! ```text
//! |D^-1 dc| <= 10 w (kappa + kappa^2 |r| / (|E D| |D^-1 c|)) |D^-1 c|       w backward error, D the columns' inverse norms
//! |dS| <= |D dS/dc| |D^-1 dc| + rounding of the derivatives that S is made of          R likewise, relative
//! ```
//!
//! The factor 10 allows for the condition estimator's underestimate. Promised digits are `-log10` of the worst bound.

use super::{Fit, Objective};
use crate::linalg::column_norms_squared;
use crate::shape::{ShapeGrid, shape_gradient};
use crate::surface::{HeightField, SurfacePoint};

/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;
/// Hager's and Higham's estimate is a lower bound, nearly always within a factor 3; two of them are multiplied.
const ESTIMATOR: f64 = 10.0;
/// Placing data and knots in the patch frame rounds each of them: no backward error is below this.
const PLACING: f64 = UNIT;
/// Derivatives are sums over the tensor basis; each term is rounded about this often.
const TERM: f64 = 8.0 * UNIT;
/// Gauss-Newton stops when no coefficient moves by more than this share of the largest.
const SETTLED: f64 = 1e-10;

/// Decimal digits promised for a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promise {
    /// Of the coefficients in the input's frame, relative to the largest.
    pub coefficients: f64,
    /// Of S at the worst supported grid point, absolute.
    pub shape_index: f64,
    /// Of R at the worst supported grid point, relative.
    pub curvedness: f64,
}

impl Fit {
    /// How many digits of the answer to trust, as an exact solution of the written problem would have them.
    pub fn promise(&self) -> Promise {
        promise(self)
    }
}

fn promise(fit: &Fit) -> Promise {
    let equations = &fit.fitted.equations;
    let c = &fit.fitted.solution.coefficients;
    let mut inverse = vec![0.0; c.len()];
    column_norms_squared(&equations.sites, &equations.metric, &mut inverse);
    inverse.iter_mut().for_each(|n| *n = if *n > 0.0 { 1.0 / n.sqrt() } else { 0.0 });
    fit.fitted.solution.unsupported.iter().for_each(|&u| inverse[u] = 0.0);
    if inverse.iter().all(|d| *d == 0.0) {
        return Promise { coefficients: 0.0, shape_index: 0.0, curvedness: 0.0 };
    }
    let moved = coefficient_move(fit, &inverse);
    let frame = fit.frame();
    let origin = if frame.keeps_axes() { frame.origin[2] } else { frame.turn(frame.origin)[2] };
    let largest = c.iter().fold(0.0_f64, |m, v| m.max((origin / frame.scale + v).abs()));
    let worst = inverse.iter().fold(0.0_f64, |m, d| m.max(d * moved));
    let [shape_index, curvedness] = shape_moves(fit, &inverse, moved);
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

/// The bound on `|D^-1 dc|`.
fn coefficient_move(fit: &Fit, inverse: &[f64]) -> f64 {
    let equations = &fit.fitted.equations;
    let solution = &fit.fitted.solution;
    let c = &solution.coefficients;
    let scaled = c.iter().zip(inverse).filter(|(_, d)| **d > 0.0).map(|(c, d)| c / d);
    let size = scaled.fold(0.0_f64, f64::hypot);
    let residual = equations.residuals(c).iter().flatten().fold(0.0_f64, |n, v| n.hypot(*v));
    let columns = inverse.iter().filter(|d| **d > 0.0).count() as f64;
    let certificate = fit.certificate();
    let kappa = certificate.condition;
    let backward = certificate.backward_error.max(PLACING);
    let relative = ESTIMATOR * backward * (kappa * size + kappa * kappa * residual / columns.sqrt());
    if matches!(fit.options().objective, Objective::Slopes(_)) { relative } else { relative + SETTLED * size }
}

/// Bounds on `|dS|` and `|dR| / R` at the worst supported point of the shape grid.
fn shape_moves(fit: &Fit, inverse: &[f64], moved: f64) -> [f64; 2] {
    let surface = fit.surface();
    let domain = [surface.knots()[0].domain(), surface.knots()[1].domain()];
    let grid = ShapeGrid::over(domain, fit.options().grid, fit.options().inset);
    let maps = &fit.shape().maps;
    let mut worst = [0.0_f64; 2];
    for (i, &x) in grid.x.iter().enumerate() {
        for (j, &y) in grid.y.iter().enumerate() {
            if maps.shape_index_at(i, j).is_some() {
                let [s, r] = point_moves(surface, [x, y], inverse, moved);
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

fn point_moves(surface: &HeightField, [x, y]: [f64; 2], inverse: &[f64], moved: f64) -> [f64; 2] {
    let point = surface.at(x, y);
    let (by_s, by_r) = shape_gradient(&point);
    let (bx, by) = (surface.knots()[0].basis(x), surface.knots()[1].basis(y));
    let columns = surface.coefficients().ncols();
    let (mut s2, mut r2) = (0.0_f64, 0.0_f64);
    let mut spread = [0.0; 5];
    let mut terms = [0.0; 5];
    for a in 0..bx.derivative(0).len() {
        for b in 0..by.derivative(0).len() {
            let unknown = (bx.first + a) * columns + by.first + b;
            let row = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].map(|(k, l)| bx.derivative(k)[a] * by.derivative(l)[b]);
            let d = inverse[unknown];
            let dot = |g: &[f64; 5]| (0..5).map(|k| g[k] * row[k]).sum::<f64>() * d;
            (s2, r2) = (s2.hypot(dot(&by_s)), r2.hypot(dot(&by_r)));
            let c = surface.coefficients()[[bx.first + a, by.first + b]].abs();
            (0..5).for_each(|k| spread[k] = f64::hypot(spread[k], row[k] * d));
            (0..5).for_each(|k| terms[k] += c * row[k].abs());
        }
    }
    let rounding = |g: &[f64; 5]| (0..5).map(|k| g[k].abs() * TERM * terms[k]).sum::<f64>();
    let off: [f64; 5] = std::array::from_fn(|k| moved * spread[k] + TERM * terms[k]);
    let curvedness = curvedness_of(&point);
    if by_s == [0.0; 5] && curvedness > 0.0 {
        // curvatures whose squares overflow or vanish: the gradient is not there to be relied on
        return [f64::NAN; 2];
    }
    [moved * s2 + rounding(&by_s) + kink(&point, &off) + TERM, (moved * r2 + rounding(&by_r)) / curvedness + TERM]
}

fn curvedness_of(point: &SurfacePoint) -> f64 {
    crate::curvature::principal_curvatures(&point.derivatives()).map_or(0.0, |p| p.curvedness())
}

/// At an umbilic S has a kink that its gradient does not see: a gap within its own error opens by as much.
fn kink(point: &SurfacePoint, off: &[f64; 5]) -> f64 {
    let Some(p) = crate::curvature::principal_curvatures(&point.derivatives()) else { return f64::NAN };
    let bend = p.k1.abs().max(p.k2.abs());
    let gap = 2.0 * (off[2] + 2.0 * off[3] + off[4]) + 4.0 * bend * (off[0] + off[1]);
    if p.difference > gap { 0.0 } else { std::f64::consts::FRAC_2_PI * gap / (2.0 * p.curvedness()) }
}
