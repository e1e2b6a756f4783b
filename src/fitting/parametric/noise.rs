//! Unknown noise sds and an unknown weight of fairness, estimated with the fit as variance components.
//!
//! ```text
//! Z^2 = |distances|^2 / (g - tr A^-1 A_P)        sigma^2 = |n - n^|^2 / (2 g - tr A^-1 A_n)
//! lambda = (rank S - lambda tr A^-1 S) / E       S the Gauss-Newton matrix of E
//! ```
//!
//! H. D. Patterson and R. Thompson, *Biometrika* 58 (1971) 545; for lambda S. N. Wood and M. Fasiolo, *Biometrics* 73
//! (2017) 1071. The rank of S is the number of coefficients less the six of a paraboloid, whose bending does not change;
//! moves of the coefficients along the surface do not change E.

use super::descent::{COARSE_TOLERANCE, Descent, Solver, State, TOLERANCE};
use super::foot_point::Feet;
use super::problem::{Parts, Problem, Weights};
use super::start::start;
use super::vector::Vector;
use crate::fit::{FitError, NormalSigma, Objective, Signs, SlopeWeights, Smooth};
use palpate_numeric::statistics::VarianceComponent;

/// How far a fit goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Until {
    /// Coefficients within this distance of the minimum, patch units.
    pub near: f64,
    /// No estimate moves by more than this share of itself.
    pub smallest_move: f64,
    /// Most updates of the estimates.
    pub updates: usize,
}

impl Until {
    /// A fit that is the answer.
    pub(super) const SETTLED: Until = Until { near: TOLERANCE, smallest_move: 1e-4, updates: MAX_UPDATES };
    /// A fit that starts another one, in which the sds are estimated again. Fairness known to 1 % is known well enough;
    /// where it creeps, the contacts hardly feel it, and each update takes some ten steps.
    pub(super) const STARTED: Until = Until { near: COARSE_TOLERANCE, smallest_move: 1e-2, updates: 12 };
}
/// Most updates. Each halves the distance to the estimate or better.
const MAX_UPDATES: usize = 60;
/// Largest ratio of two updates in a row that is followed to its limit.
const MOST_RATIO: f64 = 0.95;
/// Up to this many unknowns traces are exact, by one solve per unknown.
const EXACT_TRACE: usize = 300;
/// Probes of Hutchinson's estimator, which serves larger problems.
const PROBES: usize = 32;
/// lambda where the data do not determine it, patch units: bending that changes by 0.2 of 1/half side across the patch costs as
/// much as one contact at one sigma. A ball of noise sd 0.02 on 4 keeps mean S above 0.97 with it.
pub(super) const FAIRNESS: f64 = 30.0;
/// Bounds of lambda: practically no fairness, and practically no change of bending.
const FAIRNESS_RANGE: [f64; 2] = [1e-6, 1e4];
/// Least noise sd, patch units and radians: with less the rounding of the descent is as large as the pull of the ties.
pub(super) const NO_NOISE: f64 = 1e-4;
/// First sds: half a percent of the half side, two degrees.
const BEGIN: [f64; 2] = [0.005, 0.035];
/// Coefficients of a paraboloid.
const PARABOLOID: f64 = 6.0;

/// Which of the noise sds and weights are estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unknown {
    /// Z and sigma, each of its own.
    pub both: bool,
    /// One factor for both, where their ratio is given.
    pub common: bool,
    /// lambda.
    pub fairness: bool,
}

impl Unknown {
    /// Everything is declared.
    pub(super) const NOTHING: Unknown = Unknown { both: false, common: false, fairness: false };

    /// Whether anything is unknown.
    pub(super) fn any(self) -> bool {
        self.both || self.common || self.fairness
    }
}

/// First noise sds and weights, and which of them to estimate. `scale` is the length of the patch unit.
pub(super) fn first(objective: Objective, smooth: Smooth, [slack, tie]: [f64; 2], scale: f64) -> (Weights, Unknown) {
    let (sds, both, common) = match objective {
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => {
            ([z / scale, normal_deg.to_radians()], false, false)
        }
        Objective::Normals(NormalSigma::Auto) | Objective::Auto | Objective::Slopes(SlopeWeights::Auto) => {
            (BEGIN, true, false)
        }
        Objective::Slopes(SlopeWeights::Tangent) => ([0.1, 0.01], false, true),
        Objective::Slopes(SlopeWeights::Position) => ([0.01, 0.1], false, true),
        Objective::Slopes(SlopeWeights::Equal) => ([0.03, 0.03], false, true),
        // these weights apply to input lengths; a weight of zero keeps a millionth of the larger one
        Objective::Slopes(SlopeWeights::Explicit([z, x, y])) => {
            let (z, n) = (z * scale, x.min(y));
            let largest = z.max(n);
            ([0.01 * largest / z.max(1e-6 * largest), 0.01 * largest / n.max(1e-6 * largest)], false, true)
        }
    };
    let (fairness, estimated) = match smooth {
        Smooth::Auto | Smooth::None => (FAIRNESS, true),
        Smooth::Lambda(lambda) | Smooth::Third(lambda) | Smooth::Stretched { lambda, .. } => (lambda, false),
    };
    let weights = Weights { position: sds[0], normal: sds[1], fairness, slack, tie };
    (weights, Unknown { both, common, fairness: estimated })
}

/// Fits from the linear start to the minimum, and estimates what is unknown on the way. The steps of all descents are
/// counted.
///
/// # Errors
/// As [`Solver::descend`]; a start whose matrix has no factor.
pub(super) fn fit(
    problem: &mut Problem,
    solver: &mut Solver,
    unknown: Unknown,
    until: Until,
) -> Result<(State, Descent), FitError> {
    let places = problem.flattened;
    let coefficients = start(problem, solver, places)?;
    let mut state = State { coefficients, feet: Feet { places: places.to_vec() } };
    let weights = problem.weights;
    let mut before = 0;
    if unknown.any() || weights.fairness < FAIRNESS {
        // the first descent has fairness, because a long descent from a rough start may end in a fold
        problem.weights.fairness = weights.fairness.max(FAIRNESS);
        before = solver.descend(problem, &mut state, COARSE_TOLERANCE)?.steps;
        problem.weights = weights;
    }
    let (mut reached, steps) = descend_and_estimate(problem, solver, &mut state, unknown, until)?;
    reached.steps = before + steps;
    Ok((state, reached))
}

/// Fits from a surface near the minimum and the noise sds and weights of `problem`. The sds are estimated again once, which
/// leaves a share of 1/g of their last change; the fairness stays, because it depends on the surface and not on the number
/// of contacts.
///
/// # Errors
/// As [`Solver::descend`].
pub(super) fn finish(
    problem: &mut Problem,
    solver: &mut Solver,
    coefficients: Vec<Vector>,
    unknown: Unknown,
) -> Result<(State, Descent), FitError> {
    let mut state = State { coefficients, feet: Feet { places: problem.flattened.to_vec() } };
    let mut reached = solver.descend(problem, &mut state, COARSE_TOLERANCE)?;
    let unknown = Unknown { fairness: false, ..unknown };
    if unknown.any() {
        let before = reached;
        problem.weights = updated(problem, solver, &state, &reached, unknown)?;
        reached = solver.descend(problem, &mut state, COARSE_TOLERANCE)?;
        reached.steps += before.steps;
        reached.folds_refused += before.folds_refused;
    }
    Ok((state, reached))
}

/// Descends and updates the unknown noise sds and weights in turn, until they have converged.
///
/// # Errors
/// As [`Solver::descend`].
fn descend_and_estimate(
    problem: &mut Problem,
    solver: &mut Solver,
    state: &mut State,
    unknown: Unknown,
    until: Until,
) -> Result<(Descent, usize), FitError> {
    if !unknown.any() {
        let reached = solver.descend(problem, state, until.near)?;
        return Ok((reached, reached.steps));
    }
    let mut reached = solver.descend(problem, state, COARSE_TOLERANCE)?;
    let (mut steps, mut folds) = (reached.steps, reached.folds_refused);
    let mut path = vec![problem.weights];
    for update in 1..=until.updates {
        let next = updated(problem, solver, state, &reached, unknown)?;
        path.push(next);
        let last = relative_move(&problem.weights, &next) < until.smallest_move || update == until.updates;
        problem.weights = next;
        if let ([before, between, after], false) = (&path[..], last) {
            problem.weights = ahead([before, between, after]);
            path = vec![problem.weights];
        }
        reached = solver.descend(problem, state, if last { until.near } else { COARSE_TOLERANCE })?;
        (steps, folds) = (steps + reached.steps, folds + reached.folds_refused);
        if last {
            break;
        }
    }
    reached.folds_refused = folds;
    Ok((reached, steps))
}

/// Limits of three successive estimates, each taken as a geometric series of logarithms (A. C. Aitken, *Proc. R. Soc.
/// Edinburgh* 46 (1926) 289), because the plain iteration is slow where few contacts determine many coefficients.
fn ahead([before, between, after]: [&Weights; 3]) -> Weights {
    let limit = |a: f64, b: f64, c: f64| {
        let (first, second) = ((b / a).ln(), (c / b).ln());
        let ratio = second / first;
        // a ratio near 1 does not converge yet; no extrapolation goes beyond a factor of e^2
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

/// Largest relative change of an estimate.
fn relative_move(a: &Weights, b: &Weights) -> f64 {
    let part = |a: f64, b: f64| if a == b { 0.0 } else { (b / a - 1.0).abs() };
    part(a.position, b.position).max(part(a.normal, b.normal)).max(part(a.fairness, b.fairness))
}

/// Fewer degrees of freedom than this tell no sd.
const LEAST_DOF: f64 = 0.5;

/// The next estimates, from the sums of squares and the traces at the present ones.
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
    let rows = [count(&problem.contacts.position_weight), 2.0 * count(&problem.contacts.normal_weight)];
    let sums = [reached.sums.position, reached.sums.normal];
    let kinds =
        [(0, position), (1, normal)].map(|(k, trace)| VarianceComponent { squares: sums[k], rows: rows[k], trace });
    let free = kinds.map(VarianceComponent::freedom);
    if unknown.both {
        let sd = |k: usize, old: f64| kinds[k].sd(LEAST_DOF).map_or(old, |sd| sd.max(NO_NOISE));
        (next.position, next.normal) = (sd(0, next.position), sd(1, next.normal));
    }
    if unknown.common && free[0] + free[1] > LEAST_DOF {
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
