//! Unknown noise: heights and slopes (or normals) are two variance components, estimated with the fit.
//!
//! ```text
//! sigma_b^2 = |residuals of block b|^2 / (rows_b - trace H_b),    H_b = E_b (E'WE)^-1 E_b' W_b
//! ```
//!
//! iterated until both move by less than 1e-6 of themselves. H. D. Patterson and R. Thompson, Biometrika 58 (1971);
//! normals count two rows each. The surface sees only the levels' ratio, so the iteration is one of a single number
//!
//! ```text
//! t = ln(sigma_z / sigma_slope), h(t) after a step         t <- t + (h(t) - t) / (1 - rho),  rho = dh/dt by differences
//! ```
//!
//! which is the secant method; in between, fits are only as exact as the levels have come to be.

pub(super) mod probes;

use crate::fit::linear::Solution;
use crate::fit::noise::probes::Signs;
use crate::fit::objective::equations::{Block, Equations, data_normal_matrix, only};
use crate::fit::objective::normals::{Levels, SETTLED};
use crate::fit::{FitError, Note};
use crate::linalg::{Sites, StencilMatrix};

/// Relative move below which the levels stand.
const STANDS: f64 = 1e-6;
/// The iteration contracts by the blocks' overlap, at worst slowly; 300 steps reach 1e-6 from a contraction of 0.95.
const MAX_STEPS: usize = 300;
/// Fits between move in their last step by at most this share of the levels' last move; what is left to move is smaller
/// by another factor, the contraction of Gauss-Newton, and does not mislead the secant.
const SHARE: f64 = 0.2;
/// A last step that large is no fit yet.
const ROUGHEST: f64 = 1e-2;
/// Extrapolation beyond ten steps trusts two differences too far.
const STEEPEST: f64 = 0.9;
/// Traces come from the inverse's entries within the band. Where another factor gives none, they take one solve per unknown
/// up to so many of them; both are exact. Beyond (nested dissection, QR, conjugate gradients) they are probed, with an
/// error below sqrt(2 n / 64).
const UNIT_VECTORS: usize = 400;
/// Probes of Hutchinson's estimator: its sd is then 18 % of sqrt(n), against rows that outnumber n.
const PROBES: usize = 64;
/// Residuals below this in the patch frame (where data are of size 1) are rounding, not noise.
const NO_NOISE: f64 = 1e-13;

/// One solve at given levels: the problem, its solution, and the squares of its weighted residuals per block.
pub struct Trial {
    /// Linear (or linearised) problem.
    pub equations: Equations,
    /// Solution.
    pub solution: Solution,
    /// `[heights, slopes]`, weighted.
    pub squares: [f64; 2],
    /// What the last step moved, relative to the largest coefficient; 0 where the problem is linear.
    pub moved: f64,
}

/// Traces of both blocks' hat matrices.
pub fn hat_traces(equations: &Equations, solution: &Solution) -> [f64; 2] {
    let heights = data_normal_matrix(&equations.sites, &only(&equations.row_weights, Block::Heights));
    let of_heights = trace(solution, &heights);
    if equations.roughness.is_none() {
        return [of_heights, solution.rank as f64 - of_heights];
    }
    let slopes = data_normal_matrix(&equations.sites, &only(&equations.row_weights, Block::Slopes));
    [of_heights, trace(solution, &slopes)]
}

/// `trace(A^-1 B)` over the unknowns that the data hold.
fn trace(solution: &Solution, b: &StencilMatrix) -> f64 {
    let exact = solution.factor.inverse_trace(b, |u| is_free(solution, u));
    exact.unwrap_or_else(
        || {
            if b.order() <= UNIT_VECTORS { by_unit_vectors(solution, b) } else { by_probes(solution, b) }
        },
    )
}

fn is_free(solution: &Solution, u: usize) -> bool {
    solution.unsupported.binary_search(&u).is_ok() || solution.pinned == Some(u)
}

fn by_unit_vectors(solution: &Solution, b: &StencilMatrix) -> f64 {
    let order = b.order();
    let mut product = vec![0.0; order];
    let mut unit = vec![0.0; order];
    let mut sum = 0.0;
    for u in (0..order).filter(|&u| !is_free(solution, u)) {
        unit.fill(0.0);
        unit[u] = 1.0;
        b.multiply(&unit, &mut product);
        solution.clear_free(&mut product);
        solution.factor.solve(&mut product);
        sum += product[u];
    }
    sum
}

fn by_probes(solution: &Solution, b: &StencilMatrix) -> f64 {
    let order = b.order();
    let mut product = vec![0.0; order];
    let mut probe = vec![0.0; order];
    let mut signs = Signs::new();
    let mut sum = 0.0;
    for _ in 0..PROBES {
        for (u, p) in probe.iter_mut().enumerate() {
            let sign = signs.sign();
            *p = if is_free(solution, u) { 0.0 } else { sign };
        }
        b.multiply(&probe, &mut product);
        solution.clear_free(&mut product);
        solution.factor.solve(&mut product);
        sum += probe.iter().zip(&product).map(|(p, v)| p * v).sum::<f64>();
    }
    sum / PROBES as f64
}

/// What a trial is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Noise levels.
    pub levels: Levels,
    /// Coefficients of the fit before.
    pub start: Option<&'a [f64]>,
    /// What the last step may move, relative to the largest coefficient.
    pub within: f64,
}

/// Estimates both levels; `solve_at` fits at given levels, settled at those that stand and roughly on the way.
///
/// Returns the levels, their trial and what there is to say about them.
pub fn variance_components(
    mut solve_at: impl FnMut(Asked) -> Result<Trial, FitError>,
) -> Result<(Levels, Trial, Option<Note>), FitError> {
    let mut levels = Levels { z: 1.0, slope: 1.0 };
    let mut trial = solve_at(Asked { levels, start: None, within: ROUGHEST })?;
    let rows = trial.equations.row_weights.row_counts(trial.equations.sites.len()).map(|r| r as f64);
    let rms = |t: &Trial| [0, 1].map(|b| if rows[b] > 0.0 { (t.squares[b] / rows[b]).sqrt() } else { 0.0 });
    if trial.moved > SETTLED && rms(&trial).iter().all(|r| *r <= ROUGHEST) {
        // so little may be noise, or what the last step has left
        trial = solve_at(Asked { levels, start: Some(&trial.solution.coefficients), within: SETTLED })?;
    }
    if rms(&trial).iter().all(|r| *r <= NO_NOISE) {
        return Ok((levels, trial, Some(Note::NoNoise)));
    }
    let mut secant = Secant::default();
    for _ in 0..MAX_STEPS {
        let next = step(levels, &trial, rows);
        let moved = (next.z / levels.z - 1.0).abs().max((next.slope / levels.slope - 1.0).abs());
        let stands = moved < STANDS;
        if stands && trial.moved <= SETTLED {
            break;
        }
        levels = secant.after(levels, next);
        let within = if stands { SETTLED } else { (SHARE * moved).clamp(SETTLED, ROUGHEST) };
        trial = solve_at(Asked { levels, start: Some(&trial.solution.coefficients), within })?;
    }
    if trial.moved > SETTLED {
        trial = solve_at(Asked { levels, start: Some(&trial.solution.coefficients), within: SETTLED })?;
    }
    let vanished = levels.z <= NO_NOISE || levels.slope <= NO_NOISE;
    Ok((levels, trial, vanished.then_some(Note::LevelVanished)))
}

/// The levels that the residuals of a trial say; a block without rows or freedom keeps its own.
fn step(levels: Levels, trial: &Trial, rows: [f64; 2]) -> Levels {
    let traces = hat_traces(&trial.equations, &trial.solution);
    let update = |level: f64, b: usize| {
        let freedom = rows[b] - traces[b];
        if rows[b] == 0.0 || freedom <= 1e-9 * rows[b] {
            return level;
        }
        (level * (trial.squares[b] / freedom).sqrt()).max(NO_NOISE)
    };
    Levels { z: update(levels.z, 0), slope: update(levels.slope, 1) }
}

/// The levels' log ratio before and after the last step.
#[derive(Default)]
struct Secant(Option<[f64; 2]>);

impl Secant {
    /// Where to go after a step from `levels` to `next`: their scale is `next`'s, their ratio extrapolated.
    fn after(&mut self, levels: Levels, next: Levels) -> Levels {
        let ratio = |l: Levels| (l.z / l.slope).ln();
        let now = [ratio(levels), ratio(next)];
        let moved = now[1] - now[0];
        let contraction = self.0.map_or(0.0, |before| (now[1] - before[1]) / (now[0] - before[0]));
        self.0 = Some(now);
        // NaN where nothing moved
        let contraction = if contraction.is_finite() { contraction.clamp(-STEEPEST, STEEPEST) } else { 0.0 };
        let beyond = (0.5 * moved * contraction / (1.0 - contraction)).exp();
        Levels { z: (next.z * beyond).max(NO_NOISE), slope: (next.slope / beyond).max(NO_NOISE) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contacts;
    use crate::fit::{FitOptions, Objective, SlopeWeights, fit_contacts};

    #[test]
    fn the_trace_within_the_band_is_that_of_unit_vectors_also_with_free_unknowns() {
        let place = |r: usize| [0.754_877_666, 0.569_840_291].map(|k| (r as f64 * k).fract());
        // a hole leaves coefficients free, slopes alone pin one
        let held = (0..6000).map(place).filter(|[x, y]| (x - 0.4).hypot(y - 0.5) > 0.2);
        let (x, y): (Vec<f64>, Vec<f64>) = held.map(|[x, y]| (x, y)).unzip();
        let z: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (3.0 * x).sin() * y + 0.01 * (1e4 * x * y).sin()).collect();
        let slopes = z.iter().map(|z| 0.3 * z).collect::<Vec<f64>>();
        let contacts = Contacts::from_positions(x, y, z).with_slopes(slopes.clone(), slopes);
        for weights in [[1.0, 0.1, 0.1], [0.0, 1.0, 1.0]] {
            let objective = Objective::Slopes(SlopeWeights::Explicit(weights));
            let options = FitOptions { degree: [3, 2], segments: [22, 21], objective, ..FitOptions::default() };
            let fit = fit_contacts(&contacts, &options).unwrap();
            let (equations, solution) = (&fit.fitted.equations, &fit.fitted.solution);
            assert!(!solution.unsupported.is_empty() && equations.unknowns() > UNIT_VECTORS);
            for block in [Block::Heights, Block::Slopes] {
                let b = data_normal_matrix(&equations.sites, &only(&equations.row_weights, block));
                let (exact, expected) = (trace(solution, &b), by_unit_vectors(solution, &b));
                assert!((exact - expected).abs() <= 1e-9 * expected, "{weights:?} {block:?}: {exact} {expected}");
                // the estimator, where it is still needed, aims at the same number
                let probed = by_probes(solution, &b);
                let sd = (2.0 * equations.unknowns() as f64 / PROBES as f64).sqrt();
                assert!((probed - expected).abs() <= 4.0 * sd, "{weights:?} {block:?}: {probed} {expected}");
            }
        }
    }
}
