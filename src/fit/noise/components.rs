//! Variance components: the noise sds of heights and of slopes (or normals), estimated with the fit.
//!
//! ```text
//! sigma_b^2 = |residuals of kind b|^2 / (rows_b - trace H_b),    H_b = E_b (E'WE)^-1 E_b' W_b
//! ```
//!
//! iterated until both move by less than 1e-6 of themselves. H. D. Patterson and R. Thompson, Biometrika 58 (1971);
//! normals count two rows each. The surface depends only on the ratio of the sds, so the iteration is one of a single number
//!
//! ```text
//! t = ln(sigma_z / sigma_slope), h(t) after a step         t <- t + (h(t) - t) / (1 - rho),  rho = dh/dt by differences
//! ```
//!
//! which is the secant method. Until the sds have converged, each fit is only as exact as they are.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::sds::RowSds;
use crate::fit::noise::traces::hat_traces;
use crate::fit::{FitError, Note};
use crate::linalg::Sites;

/// A move below this share of the largest coefficient ends a nonlinear fit.
pub(crate) const CONVERGED: f64 = 1e-10;
/// Relative move of the sds below which they have converged.
const SDS_CONVERGED: f64 = 1e-6;
/// Steps at most. The iteration is slow where both kinds of rows determine the same part of the surface; 300 steps reach
/// 1e-6 where each leaves 0.95 of the error.
const MAX_STEPS: usize = 300;
/// An intermediate fit may end with a step of this share of the sds' last move; what it leaves is smaller by the
/// contraction of Gauss-Newton again, and does not mislead the secant.
const SHARE: f64 = 0.2;
/// The largest last step that any intermediate fit may end with.
const ROUGHEST: f64 = 1e-2;
/// Largest contraction that is extrapolated, ten steps ahead: beyond, two differences would be trusted too far.
const STEEPEST: f64 = 0.9;
/// Residuals below this in the patch frame (where data are of size 1) are rounding, not noise.
const NO_NOISE: f64 = 1e-13;

/// Fewer degrees of freedom than this tell no sd: the surface goes through those rows, and the sd falls as long as it may.
const LEAST_DOF: f64 = 0.5;

/// Sds of data without noise: the largest power of two below that, so that rows divided by it keep every bit.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;

/// One fit at given sds.
pub(crate) struct Trial {
    /// Linear (or linearised) problem.
    pub equations: Equations,
    /// Solution.
    pub solution: Solution,
    /// Sums of squares of the weighted residuals, `[heights, slopes]`.
    pub squares: [f64; 2],
    /// What the last step moved, relative to the largest coefficient; 0 where the problem is linear.
    pub moved: f64,
    /// Gauss-Newton steps taken; 0 where the problem is linear.
    pub steps: usize,
}

/// The estimated sds, and the fit at them.
pub(crate) struct Estimate {
    /// The sds.
    pub sds: RowSds,
    /// The fit at these sds.
    pub trial: Trial,
    /// Gauss-Newton steps of all trials.
    pub steps: usize,
    /// A remark, where an sd could not be estimated.
    pub note: Option<Note>,
    /// Degrees of freedom of both sds.
    pub dof: [f64; 2],
}

/// What the next trial has to do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrialRequest<'a> {
    /// Noise sds.
    pub sds: RowSds,
    /// Coefficients of the trial before.
    pub start: Option<&'a [f64]>,
    /// The last step may move the coefficients by this share of the largest.
    pub tolerance: f64,
}

/// Estimates both sds; `solve_at` fits at given sds.
///
/// # Errors
/// Those of `solve_at`.
pub(crate) fn variance_components(
    mut solve_at: impl FnMut(TrialRequest) -> Result<Trial, FitError>,
) -> Result<Estimate, FitError> {
    let mut steps = 0;
    let mut try_at = |sds: RowSds, start: Option<&[f64]>, tolerance: f64| -> Result<Trial, FitError> {
        let trial = solve_at(TrialRequest { sds, start, tolerance })?;
        steps += trial.steps;
        Ok(trial)
    };
    let mut sds = RowSds { z: 1.0, slope: 1.0 };
    let mut trial = try_at(sds, None, ROUGHEST)?;
    let rows = trial.equations.row_weights.row_counts(trial.equations.sites.len()).map(|r| r as f64);
    let rms = |t: &Trial| [0, 1].map(|b| if rows[b] > 0.0 { (t.squares[b] / rows[b]).sqrt() } else { 0.0 });
    if trial.moved > CONVERGED && rms(&trial).iter().all(|r| *r <= ROUGHEST) {
        // residuals as small as this may be noise, or only what the rough fit has left
        trial = try_at(sds, Some(&trial.solution.coefficients), CONVERGED)?;
    }
    if rms(&trial).iter().all(|r| *r <= NO_NOISE) {
        // unit sds would be stated as noise of the size of the patch
        sds = RowSds { z: ROUNDING, slope: ROUNDING };
        trial = try_at(sds, Some(&trial.solution.coefficients), CONVERGED)?;
        return Ok(Estimate { sds, trial, steps, note: Some(Note::NoNoise), dof: [f64::INFINITY; 2] });
    }
    let mut secant = Secant::default();
    let mut dof = [f64::INFINITY; 2];
    for _ in 0..MAX_STEPS {
        let (next, freedom) = residual_sds(sds, &trial, rows);
        dof = freedom;
        let moved = (next.z / sds.z - 1.0).abs().max((next.slope / sds.slope - 1.0).abs());
        let converged = moved < SDS_CONVERGED;
        if converged && trial.moved <= CONVERGED {
            break;
        }
        sds = secant.after(sds, next);
        let tolerance = if converged { CONVERGED } else { (SHARE * moved).clamp(CONVERGED, ROUGHEST) };
        trial = try_at(sds, Some(&trial.solution.coefficients), tolerance)?;
    }
    if trial.moved > CONVERGED {
        trial = try_at(sds, Some(&trial.solution.coefficients), CONVERGED)?;
    }
    let vanished = sds.z <= NO_NOISE || sds.slope <= NO_NOISE || (0..2).any(|b| rows[b] > 0.0 && dof[b] < LEAST_DOF);
    Ok(Estimate { sds, trial, steps, note: vanished.then_some(Note::NoiseVanished), dof })
}

/// The sds of a trial's residuals with their degrees of freedom; rows of a kind that leave none keep the sd they had.
fn residual_sds(sds: RowSds, trial: &Trial, rows: [f64; 2]) -> (RowSds, [f64; 2]) {
    let traces = hat_traces(&trial.equations, &trial.solution);
    let update = |sd: f64, b: usize| {
        let freedom = rows[b] - traces[b];
        if rows[b] == 0.0 || freedom <= 1e-9 * rows[b] {
            return sd;
        }
        (sd * (trial.squares[b] / freedom).sqrt()).max(NO_NOISE)
    };
    (RowSds { z: update(sds.z, 0), slope: update(sds.slope, 1) }, [0, 1].map(|b| rows[b] - traces[b]))
}

/// The log ratio of the sds before and after the last step.
#[derive(Default)]
struct Secant(Option<[f64; 2]>);

impl Secant {
    /// The next sds after a step from `sds` to `next`: their scale is that of `next`, their ratio is extrapolated.
    fn after(&mut self, sds: RowSds, next: RowSds) -> RowSds {
        let ratio = |s: RowSds| (s.z / s.slope).ln();
        let now = [ratio(sds), ratio(next)];
        let moved = now[1] - now[0];
        let contraction = self.0.map_or(0.0, |before| (now[1] - before[1]) / (now[0] - before[0]));
        self.0 = Some(now);
        // NaN where nothing moved
        let contraction = if contraction.is_finite() { contraction.clamp(-STEEPEST, STEEPEST) } else { 0.0 };
        let beyond = (0.5 * moved * contraction / (1.0 - contraction)).exp();
        RowSds { z: (next.z * beyond).max(NO_NOISE), slope: (next.slope / beyond).max(NO_NOISE) }
    }
}
