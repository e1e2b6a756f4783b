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
use crate::fit::objective::budget::Budget;
use crate::fit::{FitError, Note};
use palpate_numeric::linalg::Sites;
use palpate_numeric::statistics::VarianceComponent;

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
/// An sd that has vanished: the last step may leave it above the least one by as much as the sds have not converged.
const VANISHED: f64 = 2.0 * NO_NOISE;

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

/// Estimates both sds; `solve_at` fits at given sds. Where the budget is spent, the last trial stands.
///
/// # Errors
/// Those of `solve_at`.
pub(crate) fn variance_components(
    budget: &Budget,
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
        if (converged && trial.moved <= CONVERGED) || budget.is_spent() {
            break;
        }
        sds = secant.after(sds, next);
        let tolerance = if converged { CONVERGED } else { (SHARE * moved).clamp(CONVERGED, ROUGHEST) };
        trial = try_at(sds, Some(&trial.solution.coefficients), tolerance)?;
    }
    if trial.moved > CONVERGED && !budget.is_spent() {
        trial = try_at(sds, Some(&trial.solution.coefficients), CONVERGED)?;
    }
    let vanished = sds.z <= VANISHED || sds.slope <= VANISHED || (0..2).any(|b| rows[b] > 0.0 && dof[b] < LEAST_DOF);
    Ok(Estimate { sds, trial, steps, note: vanished.then_some(Note::NoiseVanished), dof })
}

/// The sds of a trial's residuals with their degrees of freedom; rows of a kind that leave none keep the sd they had.
fn residual_sds(sds: RowSds, trial: &Trial, rows: [f64; 2]) -> (RowSds, [f64; 2]) {
    let traces = hat_traces(&trial.equations, &trial.solution);
    let kinds = [0, 1].map(|b| VarianceComponent { squares: trial.squares[b], rows: rows[b], trace: traces[b] });
    let update = |sd: f64, kind: VarianceComponent| {
        let own = kind.sd(1e-9 * kind.rows).filter(|_| kind.rows > 0.0);
        own.map_or(sd, |own| (sd * own).max(NO_NOISE))
    };
    (RowSds { z: update(sds.z, kinds[0]), slope: update(sds.slope, kinds[1]) }, kinds.map(VarianceComponent::freedom))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::options::method::Method;
    use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts, linear};
    use palpate_geometry::contact::{ContactWeights, Contacts};
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::linalg::{RowWeights, SiteWeights};

    /// A saddle touched at `n` x `n` places of [-1, 1]^2, with errors of heights and slopes.
    fn saddle(n: usize, sds: [f64; 2], seed: u64) -> Contacts {
        let mut errors = vec![0.0; 3 * n * n];
        for (block, part) in errors.chunks_mut(48).enumerate() {
            EffectDraws::new(seed, "components").gaussians(0, block as u64, part.len(), part);
        }
        let place = |k: usize| 2.0 * k as f64 / (n as f64 - 1.0) - 1.0;
        let (x, y): (Vec<f64>, Vec<f64>) = (0..n * n).map(|r| (place(r % n), place(r / n))).unzip();
        let z = (0..n * n).map(|r| 0.1 * (x[r] * x[r] - y[r] * y[r]) + sds[0] * errors[r]).collect();
        let zx = (0..n * n).map(|r| 0.2 * x[r] + sds[1] * errors[n * n + r]).collect();
        let zy = (0..n * n).map(|r| -0.2 * y[r] + sds[1] * errors[2 * n * n + r]).collect();
        Contacts::from_positions(x, y, z).with_slopes(zx, zy)
    }

    fn fitted(contacts: &Contacts, weights: SlopeWeights) -> Fit {
        fit_contacts(contacts, &FitOptions::default().with_objective(Objective::Slopes(weights))).unwrap()
    }

    /// The rows of a fit with unit weights, solved at given sds.
    fn solved(fit: &Fit, sds: RowSds) -> Trial {
        let Equations { sites, row_weights, targets, .. } = fit.equations();
        let SiteWeights { z, a, b, d } = row_weights.at(0);
        let by = |w: f64| w / sds.slope;
        let weights = RowWeights::Uniform(SiteWeights { z: z / sds.z, a: by(a), b: by(b), d: by(d) });
        let targets = targets.iter().map(|[z, p, q]| [z / sds.z, by(*p), by(*q)]).collect();
        let equations = Equations::new(sites.clone(), weights, targets, None);
        let solution = linear::solve(&equations, Method::Auto).unwrap();
        let squares = equations.residual_squares(&solution.coefficients);
        Trial { equations, solution, squares, moved: 0.0, steps: 0 }
    }

    #[test]
    fn a_vanished_noise_is_said_of_heights_and_of_slopes_and_of_nothing_else() {
        let says = |contacts: &Contacts, note: Note| fitted(contacts, SlopeWeights::Auto).notes().contains(&note);
        for seed in 0..5 {
            for (sds, vanished) in [([0.01, 0.03], false), ([0.0, 0.03], true), ([0.01, 0.0], true)] {
                assert_eq!(says(&saddle(5, sds, seed), Note::NoiseVanished), vanished, "{sds:?} {seed}");
            }
            // noise that is small has not vanished
            assert!(!says(&saddle(5, [1e-9, 0.1], seed), Note::NoiseVanished));
            assert!(!says(&saddle(5, [0.1, 1e-9], seed), Note::NoiseVanished));
            // there is no noise of heights to vanish
            let weights = ContactWeights { z: Some(vec![0.0; 25]), ..ContactWeights::default() };
            let slopes = Contacts { weights, ..saddle(5, [0.01, 0.03], seed) };
            assert!(says(&slopes, Note::SlopesOnly) && !says(&slopes, Note::NoiseVanished));
        }
        let exact = saddle(5, [0.0, 0.0], 0);
        assert!(says(&exact, Note::NoNoise) && !says(&exact, Note::NoiseVanished));
    }

    /// Rows of a kind that are no more than the unknowns may be met exactly: they leave no degree of freedom, whatever sd the
    /// iteration has come to.
    #[test]
    fn a_kind_of_rows_without_degrees_of_freedom_has_vanished() {
        let mut said = 0;
        for seed in 0..40 {
            let contacts = saddle(3, [0.003, 0.03], seed);
            let fit = fitted(&contacts, SlopeWeights::Auto);
            let vanished = fit.notes().contains(&Note::NoiseVanished);
            let (sds, dof) = (fit.noise(), fit.noise().dof);
            let is_left = |sd: Option<f64>, dof: f64| sd.unwrap() > 1e-12 && dof > 0.5;
            let left = is_left(sds.sigma_z, dof[0]) && is_left(sds.sigma_slope, dof[1]);
            assert_eq!(vanished, !left, "{seed}: {sds:?}");
            said += u32::from(vanished);
        }
        assert!((5..35).contains(&said), "{said}");
    }

    /// Every sd is what its own residuals and degrees of freedom say.
    #[test]
    fn estimated_sds_are_those_of_their_own_residuals() {
        for seed in 0..4 {
            let fit = fitted(&saddle(5, [0.01, 0.03], seed), SlopeWeights::Auto);
            let (equations, solution) = (fit.equations(), fit.solution());
            let squares = equations.residual_squares(&solution.coefficients);
            let traces = hat_traces(equations, solution);
            for (b, rows) in [25.0, 50.0].into_iter().enumerate() {
                assert!((fit.noise().dof[b] - (rows - traces[b])).abs() < 1e-4);
                assert!((squares[b] / (rows - traces[b]) - 1.0).abs() < 1e-5, "{seed} {b}");
            }
            let noise = fit.noise();
            assert!(
                (0.005..0.02).contains(&noise.sigma_z.unwrap()) && (0.02..0.04).contains(&noise.sigma_slope.unwrap())
            );
        }
    }

    /// Linear fits need few of the 300 steps; fits that are as rough as they may be come to rest in the end, and their steps are
    /// counted.
    #[test]
    fn sds_converge_in_a_few_trials() {
        let fit = fitted(&saddle(5, [0.01, 0.03], 1), SlopeWeights::Equal);
        for rough in [0.0, 0.9] {
            let mut asked = Vec::new();
            let estimate = variance_components(&Budget::new(usize::MAX), |request| {
                asked.push(request.tolerance);
                Ok(Trial { moved: rough * request.tolerance, steps: 2, ..solved(&fit, request.sds) })
            })
            .unwrap();
            assert!(asked.len() <= 14, "{asked:?}");
            assert_eq!((estimate.steps, estimate.note.clone()), (2 * asked.len(), None));
            assert!(estimate.trial.moved <= CONVERGED && asked.iter().all(|t| (CONVERGED..=ROUGHEST).contains(t)));
            // the first fit may be as rough as any, and later ones less and less
            assert!(asked[0] == ROUGHEST && asked[2..].windows(2).all(|t| t[1] <= t[0]), "{asked:?}");
            let expected = fitted(&saddle(5, [0.01, 0.03], 1), SlopeWeights::Auto);
            let sd = expected.noise().sigma_z.unwrap();
            assert!((estimate.sds.z / sd - 1.0).abs() < 1e-5, "{} {sd}", estimate.sds.z);
        }
    }

    /// Residuals that are now larger, now smaller never let the sds come to rest; the last fit is as good as any other then.
    #[test]
    fn sds_that_do_not_converge_end_with_a_fit_that_has() {
        let fit = fitted(&saddle(5, [0.01, 0.03], 1), SlopeWeights::Equal);
        let mut asked = Vec::new();
        let estimate = variance_components(&Budget::new(usize::MAX), |request| {
            asked.push(request.tolerance);
            let trial = solved(&fit, request.sds);
            let factor = if asked.len() % 2 == 0 { 4.0 } else { 1.0 };
            Ok(Trial { moved: 0.9 * request.tolerance, squares: trial.squares.map(|s| factor * s), ..trial })
        })
        .unwrap();
        assert_eq!(asked.len(), 1 + MAX_STEPS + 1);
        assert!(asked[MAX_STEPS] > CONVERGED && asked[MAX_STEPS + 1] == CONVERGED && estimate.trial.moved <= CONVERGED);
    }

    #[test]
    fn exact_data_have_sds_of_rounding() {
        let fit = fitted(&saddle(5, [0.0, 0.0], 1), SlopeWeights::Equal);
        let mut asked = Vec::new();
        let estimate = variance_components(&Budget::new(usize::MAX), |request| {
            asked.push((request.tolerance, request.start.is_some()));
            Ok(Trial { moved: 0.9 * request.tolerance, ..solved(&fit, request.sds) })
        });
        let Estimate { sds, note, dof, .. } = estimate.unwrap();
        assert_eq!((sds.z, sds.slope, note, dof), (ROUNDING, ROUNDING, Some(Note::NoNoise), [f64::INFINITY; 2]));
        // small residuals of a rough fit are looked at once more
        assert_eq!(asked, [(ROUGHEST, false), (CONVERGED, true), (CONVERGED, true)]);
        // what counts is the root of the mean square of a kind's rows
        for (rms, is_rounding) in [(0.5 * NO_NOISE, true), (1.5 * NO_NOISE, false)] {
            let squares = [25.0, 50.0].map(|rows| rows * rms * rms);
            let estimate = variance_components(&Budget::new(usize::MAX), |request| {
                Ok(Trial { squares, ..solved(&fit, request.sds) })
            })
            .unwrap();
            assert_eq!(estimate.note == Some(Note::NoNoise), is_rounding, "{rms:e}");
        }
    }

    /// Where a step maps the log ratio t to `a + rho t`, two steps tell where it stays.
    #[test]
    fn the_secant_finds_the_ratio_that_a_linear_step_keeps() {
        let at = |t: f64, scale: f64| RowSds { z: scale * (0.5 * t).exp(), slope: scale * (-0.5 * t).exp() };
        for (rho, reached) in [(0.5, 1.0), (-0.7, 1.0), (0.95, 0.5)] {
            let step = |t: f64| 0.3 * (1.0 - rho) + rho * t;
            let mut secant = Secant::default();
            let first = secant.after(at(2.0, 1.0), at(step(2.0), 3.0));
            let t1 = (first.z / first.slope).ln();
            assert!((t1 - step(2.0)).abs() < 1e-12 && (first.z * first.slope - 9.0).abs() < 1e-12);
            let second = secant.after(first, at(step(t1), 2.0));
            let t2 = (second.z / second.slope).ln();
            // a contraction of 0.95 is taken for 0.9, half of the way
            assert!((t2 - (t1 + reached * (0.3 - t1))).abs() < 1e-12, "{rho}: {t2}");
            assert!((second.z * second.slope - 4.0).abs() < 1e-12);
        }
        let mut secant = Secant::default();
        let still = secant.after(at(1.0, 1.0), at(1.0, 1.0));
        assert!((secant.after(still, still).z - still.z).abs() < 1e-15);
        let none = secant.after(RowSds { z: NO_NOISE, slope: 1.0 }, RowSds { z: 0.1 * NO_NOISE, slope: 1.0 });
        assert_eq!(none.z, NO_NOISE);
    }

    /// A kind without rows, or without degrees of freedom, keeps the sd that it had.
    #[test]
    fn rows_that_leave_nothing_keep_their_sd() {
        let fit = fitted(&saddle(5, [0.01, 0.03], 1), SlopeWeights::Equal);
        let sds = RowSds { z: 0.1, slope: 0.2 };
        let trial = solved(&fit, sds);
        let traces = hat_traces(&trial.equations, &trial.solution);
        let (next, dof) = residual_sds(sds, &trial, [25.0, 50.0]);
        assert_eq!(dof, [25.0 - traces[0], 50.0 - traces[1]]);
        for (b, [sd, was]) in [[next.z, 0.1], [next.slope, 0.2]].into_iter().enumerate() {
            let expected: f64 = was * (trial.squares[b] / dof[b]).sqrt();
            assert!((sd - expected).abs() < 1e-15, "{sd} {expected}");
        }
        let (kept, _) = residual_sds(sds, &trial, [0.0, traces[1] * (1.0 + 1e-10)]);
        assert_eq!((kept.z, kept.slope), (0.1, 0.2));
        let exact = Trial { squares: [0.0; 2], ..trial };
        assert_eq!(residual_sds(sds, &exact, [25.0, 50.0]).0.z, NO_NOISE);
    }
}
