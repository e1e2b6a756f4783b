//! How far linear functionals of the coefficients can be off.
//!
//! ```text
//! |D^-1 dc| <= 10 w (kappa + kappa^2 |r| / (|E D| |D^-1 c|)) |D^-1 c|       w backward error, D the columns' inverse norms
//! |g'dc|    <= |D g| |D^-1 dc|
//! |g'dc|    <= v (sqrt(g'A^-1 g) | |E||c| + |r| + |b| |_2 + |A^-1 g|' |E|'|r|)     A = E'E, where A^-1 is at hand;
//!                                                                                     v = w / (1 - 10 w kappa)
//! ```
//!
//! The factor 10 allows for the condition estimator's underestimate. The third line is the same perturbation of the
//! augmented system, `dc = E^+ (db - dE c) + A^-1 dE'r`, taken in the direction that is asked about instead of the
//! worst one: on small problems it promises about two digits more, and v allows for the second order. The smaller bound
//! is used.

use super::backward::Backward;
use super::{Fit, MethodUsed};
use crate::simd::{FORMS, Level, quadratic_forms};

/// Hager's and Higham's estimate is a lower bound, nearly always within a factor 3; two of them are multiplied.
const ESTIMATOR: f64 = 10.0;
/// Unit roundoff 2^-53. Placing data and knots in the patch frame rounds each of them: no backward error is below this.
pub const PLACING: f64 = 0.5 * f64::EPSILON;
/// Unknowns up to which A^-1 is written out: n^3 multiplications against the fit's g n^2.
const INVERTED: usize = 100;
/// Condition up to which A^-1 has digits enough for a bound: had from Cholesky of the normal matrix, and from R of the rows.
const INVERTIBLE: [f64; 2] = [1e6, 1e12];

/// What bounds a linear functional of the coefficients.
pub struct Bound {
    /// D over its largest entry; zero for unsupported coefficients.
    pub inverse: Vec<f64>,
    /// The bound on `|D^-1 dc|` times D's largest entry.
    pub moved: f64,
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

impl Bound {
    /// `None` when no coefficient is held by data.
    pub fn new(fit: &Fit, condition: f64, backward: &Backward) -> Option<Bound> {
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
        let settled = if fit.fitted.settled > 0.0 { fit.fitted.settled.max(PLACING) } else { 0.0 };
        let moved = ESTIMATOR * error * (condition * size + condition * condition * residual / held.sqrt());
        inverse.iter_mut().for_each(|d| *d /= largest);
        let directed = Directed::new(fit, condition, backward, settled);
        Some(Bound { inverse, moved: moved + settled * size, directed })
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
}

/// The worst bounds of three kinds of functionals `g'c / size`, worked out eight at a time.
pub struct Functionals<'a> {
    bound: &'a Bound,
    /// Gradients side by side, where they are asked about in their own direction.
    gradients: Vec<[f64; FORMS]>,
    waiting: Vec<Waiting>,
    worst: [f64; 3],
}

/// All but the directed part of one functional's bound.
struct Waiting {
    kind: usize,
    plain: f64,
    /// `|g|_1`.
    left: f64,
    rounding: f64,
    size: f64,
}

impl Functionals<'_> {
    /// None yet: all bounds zero.
    pub fn new(bound: &Bound) -> Functionals<'_> {
        let order = if bound.directed.is_some() { bound.inverse.len() } else { 0 };
        Functionals { bound, gradients: vec![[0.0; FORMS]; order], waiting: Vec::with_capacity(FORMS), worst: [0.0; 3] }
    }

    /// Takes in `(bound of sum g_u c_u + rounding) / size` of one kind.
    pub fn add(&mut self, kind: usize, gradient: &[(usize, f64)], rounding: f64, size: f64) {
        let slot = self.waiting.len();
        let (mut square, mut left) = (0.0, 0.0);
        for &(u, g) in gradient {
            let scaled = self.bound.inverse[u] * g;
            square += scaled * scaled;
            left += g.abs();
            if let Some(side_by_side) = self.gradients.get_mut(u) {
                side_by_side[slot] = g;
            }
        }
        self.waiting.push(Waiting { kind, plain: self.bound.moved * square.sqrt(), left, rounding, size });
        if self.waiting.len() == FORMS {
            self.settle();
        }
    }

    /// One of this kind can be off by anything.
    pub fn unknown(&mut self, kind: usize) {
        self.worst[kind] = f64::NAN;
    }

    /// The worst of each kind; NaN where one was not finite.
    pub fn finish(mut self) -> [f64; 3] {
        self.settle();
        self.worst
    }

    fn settle(&mut self) {
        let directed = self.bound.directed.as_ref().map(|directed| {
            let [squares, sizes] =
                quadratic_forms(Level::active(), &directed.inverse, &directed.columns, &self.gradients);
            self.gradients.fill([0.0; FORMS]);
            let along = |k: usize| squares[k].max(0.0).sqrt() * directed.rows + sizes[k];
            (directed, std::array::from_fn::<f64, FORMS, _>(|k| directed.backward * along(k)))
        });
        for (k, functional) in self.waiting.drain(..).enumerate() {
            let mut bound = functional.plain;
            if let Some((directed, along)) = &directed {
                bound = bound.min(along[k] + directed.settled * functional.left);
            }
            let worst = &mut self.worst[functional.kind];
            *worst = maximum(*worst, (bound + functional.rounding) / functional.size);
        }
    }
}

/// The larger one, or NaN if there is one.
fn maximum(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
