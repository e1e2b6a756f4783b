//! Unknown noise and unknown fairness, estimated with the fit as variance components.
//!
//! ```text
//! Z^2 = |distances|^2 / (g - tr A^-1 A_P)        sigma^2 = |turns|^2 / (2 g - tr A^-1 A_n)
//! lambda = (rank S - lambda tr A^-1 S) / E       S the Gauss-Newton matrix of E
//! ```
//!
//! H. D. Patterson and R. Thompson, *Biometrika* 58 (1971) 545; for lambda S. N. Wood and M. Fasiolo, *Biometrics* 73
//! (2017) 1071. The rank of S is the number of coefficients less the six of a paraboloid, which a change of bending does
//! not see: moves along the surface have no E.

use super::descent::{Descent, ON_THE_WAY, SETTLED, Solver, State};
use super::problem::{Parts, Problem, Weights};
use crate::fit::Signs;
use crate::fit::{FitError, NormalSigma, Objective, SlopeWeights, Smooth};

/// Levels that have moved by less than this share of themselves stand.
const STANDS: f64 = 1e-4;
/// Updates; the map contracts by a half or better.
const MAX_UPDATES: usize = 60;
/// Largest ratio of two updates in a row that is followed to its limit.
const MOST_RATIO: f64 = 0.95;
/// Up to this many unknowns traces are exact, one solve each.
const EXACT_TRACE: usize = 300;
/// Probes of Hutchinson's estimator beyond.
const PROBES: usize = 32;
/// lambda without data to tell it, patch units: bending that changes by 0.2 of 1/half side across the patch costs as
/// much as one contact at one sigma. A ball of noise sd 0.02 on 4 keeps mean S above 0.97 with it.
pub const FAIRNESS: f64 = 30.0;
/// lambda's bounds: no fairness to speak of, and no change of bending to speak of.
const FAIRNESS_RANGE: [f64; 2] = [1e-6, 1e4];
/// Least noise that is believed, patch units and radians: below it the descent's last digits are at odds with the ties.
pub const NO_NOISE: f64 = 1e-4;
/// Levels to begin with: half a percent of the half side, two degrees.
const BEGIN: [f64; 2] = [0.005, 0.035];
/// Coefficients of a paraboloid.
const PARABOLOID: f64 = 6.0;

/// Which levels are estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unknown {
    /// Z and sigma each.
    pub both: bool,
    /// One factor for both, their ratio being given.
    pub common: bool,
    /// lambda.
    pub fairness: bool,
}

impl Unknown {
    /// Anything at all.
    pub fn any(self) -> bool {
        self.both || self.common || self.fairness
    }
}

/// First levels and which of them to estimate. `scale` is the patch's length.
pub fn first(objective: Objective, smooth: Smooth, [slack, tie]: [f64; 2], scale: f64) -> (Weights, Unknown) {
    let (levels, both, common) = match objective {
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => {
            ([z / scale, normal_deg.to_radians()], false, false)
        }
        Objective::Normals(NormalSigma::Auto) | Objective::Auto | Objective::Slopes(SlopeWeights::Auto) => {
            (BEGIN, true, false)
        }
        Objective::Slopes(SlopeWeights::Tangent) => ([0.1, 0.01], false, true),
        Objective::Slopes(SlopeWeights::Position) => ([0.01, 0.1], false, true),
        Objective::Slopes(SlopeWeights::Equal) => ([0.03, 0.03], false, true),
        // the weights apply to lengths as they are; a weight of zero leaves its rows at a millionth
        Objective::Slopes(SlopeWeights::Explicit([z, x, y])) => {
            let (z, n) = (z * scale, x.min(y));
            let largest = z.max(n);
            ([0.01 * largest / z.max(1e-6 * largest), 0.01 * largest / n.max(1e-6 * largest)], false, true)
        }
    };
    let (fairness, estimated) = match smooth {
        Smooth::Auto | Smooth::None => (FAIRNESS, true),
        Smooth::Lambda(lambda) => (lambda, false),
    };
    let weights = Weights { position: levels[0], normal: levels[1], fairness, slack, tie };
    (weights, Unknown { both, common, fairness: estimated })
}

/// Descends, updating the unknown levels in between, until they stand.
///
/// # Errors
/// As [`Solver::descend`].
pub fn descend_with_levels(
    problem: &mut Problem,
    solver: &mut Solver,
    state: &mut State,
    unknown: Unknown,
) -> Result<(Descent, usize), FitError> {
    if !unknown.any() {
        let reached = solver.descend(problem, state, SETTLED)?;
        return Ok((reached, reached.steps));
    }
    let mut reached = solver.descend(problem, state, ON_THE_WAY)?;
    let (mut steps, mut folds) = (reached.steps, reached.folds_refused);
    let mut path = vec![problem.weights];
    for update in 1..=MAX_UPDATES {
        let next = updated(problem, solver, state, &reached, unknown)?;
        path.push(next);
        let last = relative_move(&problem.weights, &next) < STANDS || update == MAX_UPDATES;
        problem.weights = next;
        if let ([before, between, after], false) = (&path[..], last) {
            problem.weights = ahead([before, between, after]);
            path = vec![problem.weights];
        }
        reached = solver.descend(problem, state, if last { SETTLED } else { ON_THE_WAY })?;
        (steps, folds) = (steps + reached.steps, folds + reached.folds_refused);
        if last {
            break;
        }
    }
    reached.folds_refused = folds;
    Ok((reached, steps))
}

/// Where three levels in a row are heading, each as a geometric series of logarithms (A. C. Aitken, *Proc. R. Soc.
/// Edinburgh* 46 (1926) 289), for the plain iteration creeps where few contacts hold many coefficients.
fn ahead([before, between, after]: [&Weights; 3]) -> Weights {
    let limit = |a: f64, b: f64, c: f64| {
        let (first, second) = ((b / a).ln(), (c / b).ln());
        let ratio = second / first;
        // a ratio near 1 is no series yet; e^2 is as far as one looks
        let more = if ratio.abs() < MOST_RATIO { second * ratio / (1.0 - ratio) } else { 0.0 };
        c * more.clamp(-2.0, 2.0).exp()
    };
    let fairness = limit(before.fairness, between.fairness, after.fairness);
    Weights {
        position: limit(before.position, between.position, after.position).max(NO_NOISE),
        normal: limit(before.normal, between.normal, after.normal).max(NO_NOISE),
        fairness: fairness.clamp(FAIRNESS_RANGE[0], FAIRNESS_RANGE[1]),
        ..*after
    }
}

fn relative_move(a: &Weights, b: &Weights) -> f64 {
    let part = |a: f64, b: f64| if a == b { 0.0 } else { (b / a - 1.0).abs() };
    part(a.position, b.position).max(part(a.normal, b.normal)).max(part(a.fairness, b.fairness))
}

fn updated(
    problem: &Problem,
    solver: &mut Solver,
    state: &State,
    reached: &Descent,
    unknown: Unknown,
) -> Result<Weights, FitError> {
    let [position, normal, fairness] = traces(problem, solver, state)?;
    let mut next = problem.weights;
    let count = |w: &[f64]| w.iter().filter(|w| **w > 0.0).count() as f64;
    let free =
        [count(&problem.touches.position_weight) - position, 2.0 * count(&problem.touches.normal_weight) - normal];
    let sums = [reached.sums.position, reached.sums.normal];
    if unknown.both {
        let level = |k: usize, old: f64| if free[k] > 0.5 { (sums[k] / free[k]).sqrt().max(NO_NOISE) } else { old };
        (next.position, next.normal) = (level(0, next.position), level(1, next.normal));
    }
    if unknown.common && free[0] + free[1] > 0.5 {
        let chi = sums[0] / next.position.powi(2) + sums[1] / next.normal.powi(2);
        let factor = (chi / (free[0] + free[1])).sqrt();
        (next.position, next.normal) = ((next.position * factor).max(NO_NOISE), (next.normal * factor).max(NO_NOISE));
    }
    if unknown.fairness {
        let rank = (problem.cells.shape().coefficients() as f64 - PARABOLOID).max(1.0);
        let lambda = (rank - fairness).max(1e-3 * rank) / reached.sums.fairness.max(f64::MIN_POSITIVE);
        next.fairness = lambda.clamp(FAIRNESS_RANGE[0], FAIRNESS_RANGE[1]);
    }
    Ok(next)
}

/// `tr A^-1 B` for the parts of positions, normals and fairness (its own weight included).
fn traces(problem: &Problem, solver: &mut Solver, state: &State) -> Result<[f64; 3], FitError> {
    let order = solver.matrix.order();
    let mut unused = vec![0.0; order];
    solver.matrix.clear();
    problem.assemble(&state.coefficients, &state.feet, Parts::ALL, &mut solver.matrix, &mut unused);
    solver.factor.factor(&solver.matrix, 1e-14).map_err(|source| FitError::Solve { source })?;
    let mut signs = Signs::new();
    let mut probe = |_| (0..order).map(|_| signs.sign()).collect();
    let probes: Vec<Vec<f64>> = if order <= EXACT_TRACE { Vec::new() } else { (0..PROBES).map(&mut probe).collect() };
    // the columns of A^-1, or A^-1 times the probes
    let solved: Vec<Vec<f64>> = if order <= EXACT_TRACE {
        (0..order).map(|u| (0..order).map(|k| f64::from(u8::from(k == u))).collect()).collect()
    } else {
        probes.clone()
    };
    let solved: Vec<Vec<f64>> = solved
        .into_iter()
        .map(|mut v| {
            solver.factor.solve(&mut v);
            v
        })
        .collect();
    let mut part = |parts: Parts| {
        solver.matrix.clear();
        problem.assemble(&state.coefficients, &state.feet, parts, &mut solver.matrix, &mut unused);
        if order <= EXACT_TRACE {
            return solver.matrix.contracted(&solved);
        }
        let mut product = vec![0.0; order];
        let of = |(probe, solved): (&Vec<f64>, &Vec<f64>)| {
            solver.matrix.multiply(probe, &mut product);
            product.iter().zip(solved).map(|(p, v)| p * v).sum::<f64>()
        };
        probes.iter().zip(&solved).map(of).sum::<f64>() / PROBES as f64
    };
    Ok([
        part(Parts { position: true, ..Parts::NONE }),
        part(Parts { normal: true, ..Parts::NONE }),
        part(Parts { fairness: true, ..Parts::NONE }),
    ])
}
