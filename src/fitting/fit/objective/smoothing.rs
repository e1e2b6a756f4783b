//! `--smooth auto`: lambda by generalised cross-validation over the weighted rows.
//!
//! ```text
//! G(lambda) = N |b - E c|^2 / (N - trace H)^2,   H = E (E'E + lambda P)^-1 E'
//! ```
//!
//! P. Craven and G. Wahba, Numer. Math. 31 (1979). It is used instead of REML because it needs no model of the surface's own
//! variance. It assumes rows with independent errors; correlated errors (normals from overlapping neighbourhoods) make
//! lambda too small.

use crate::fit::linear;
use crate::fit::noise::traces::hat_traces;
use crate::fit::notes::Note;
use crate::fit::objective::PlainFit;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::fitted::Fitted;
use crate::fit::objective::robust::fit_with_loss;
use crate::fit::placing::Patch;
use crate::fit::{FitError, FitOptions, Method, Smooth};
use crate::observation::Data;

/// The search covers this many decades below and above the ratio of traces, where data and roughness weigh the same.
const DECADES: [i32; 2] = [-14, 4];
/// Golden section steps: each shrinks the bracket to 0.618, 20 leave 1e-4 of a decade.
const GOLDEN_STEPS: usize = 20;

/// Chooses lambda and fits with it.
///
/// # Errors
/// Those of a fit with a given lambda.
pub(super) fn fit_smoothed(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    (plain, budget): (PlainFit, &Budget),
) -> Result<Fitted, FitError> {
    let with = |lambda: f64| FitOptions { smooth: Smooth::Lambda(lambda), ..options.clone() };
    // noise sds and linearisation come from a fit with so little smoothing that it only makes the rank full
    let start = fit_with_loss(patch, data, &with(1e-9), (plain, budget))?;
    let Some((_, penalty)) = start.equations.roughness.clone() else { return Ok(start) };
    let bare = start.equations.with_roughness(None);
    let sum = |diagonal: Vec<f64>| diagonal.iter().sum::<f64>();
    let balance = sum(bare.normal_matrix().diagonal()) / sum(penalty.diagonal());
    let score = |exponent: f64| -> f64 {
        let lambda = balance * 10_f64.powf(exponent);
        let equations = bare.with_roughness(Some((lambda, penalty.clone())));
        let Ok(solution) = linear::solve(&equations, Method::Cholesky) else { return f64::INFINITY };
        budget.take(&equations, &solution);
        let squares: f64 = equations.residual_squares(&solution.coefficients).iter().sum();
        let rows = equations.count() as f64;
        let freedom = rows - hat_traces(&equations, &solution).iter().sum::<f64>();
        if freedom <= 0.0 { f64::INFINITY } else { rows * squares / (freedom * freedom) }
    };
    let best = (DECADES[0]..=DECADES[1])
        .map(|e| (f64::from(e), score(f64::from(e))))
        .fold((f64::from(DECADES[1]), f64::INFINITY), |best, now| if now.1 < best.1 { now } else { best });
    let lambda = balance * 10_f64.powf(golden([best.0 - 1.0, best.0 + 1.0], score, budget));
    let mut fitted = fit_with_loss(patch, data, &with(lambda), (plain, budget))?;
    fitted.notes.push(Note::Smoothed { lambda });
    Ok(fitted)
}

/// Minimum of a function with a single minimum in `[lo, hi]`, by golden section; where the budget is spent, the middle of what is left.
fn golden([mut lo, mut hi]: [f64; 2], f: impl Fn(f64) -> f64, budget: &Budget) -> f64 {
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut left, mut right) = (hi - ratio * (hi - lo), lo + ratio * (hi - lo));
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..GOLDEN_STEPS {
        if budget.is_spent() {
            break;
        }
        if at_left <= at_right {
            (hi, right, at_right) = (right, left, at_left);
            left = hi - ratio * (hi - lo);
            at_left = f(left);
        } else {
            (lo, left, at_left) = (left, right, at_right);
            right = lo + ratio * (hi - lo);
            at_right = f(right);
        }
    }
    0.5 * (lo + hi)
}
