//! Levenberg-Marquardt on the objective, where every trial has its own feet and none may fold.
//!
//! ```text
//! (A + mu diag A) dc = -1/2 grad F,   mu / 10 after a step that goes down, mu * 10 after one that does not or folds
//! ```
//!
//! A trial folds when `Q_u x Q_v` at a Gauss point or a foot makes an obtuse angle with its direction before the step.

use super::cells::Row;
use super::foot_point::Feet;
use super::parallel;
use super::problem::{Parts, Problem, Sums};
use super::vector::{Vector, dot};
use crate::fit::FitError;
use palpate_numeric::levenberg_marquardt::{self, ResidualModel, Settings};
use palpate_numeric::linalg::{self, BlockMatrix};
use palpate_numeric::solve::{BlockCholesky, SolveError};

/// The descent ends when all coefficients are within this distance of the minimum, patch units.
pub(super) const TOLERANCE: f64 = 1e-10;
/// The same while noise sds are still being estimated.
pub(super) const COARSE_TOLERANCE: f64 = 1e-6;
/// Largest ratio of two successive steps from which the remaining distance is estimated, as of a geometric series.
const GEOMETRIC: f64 = 0.5;
/// Most steps of one descent. From the starts used here it takes 5 to 40, and up to 150 on rings that oscillate.
const MAX_STEPS: usize = 300;
/// The same while noise sds are still being estimated.
const MAX_COARSE_STEPS: usize = 30;
/// With a damping of 1e-14 a step is undamped, with 1e8 it has practically no length. F is rounded to about 1e-15 of itself,
/// so the last step may not lower it visibly.
const SETTINGS: Settings = Settings {
    first: 1e-6,
    most: 1e8,
    fall: |damping| (damping / 10.0).max(1e-14),
    rounding: 1e-14,
    steps: MAX_STEPS,
    trials: usize::MAX,
};

/// Largest damping at which the ratio of two successive steps is that of the series and not of a change of damping.
const FREE: f64 = 1e-5;
/// Least cosine between two steps that are taken as one series.
const PARALLEL: f64 = 0.9;
/// Ratios of the series that are summed; with smaller ones the next step is enough.
const RATIOS: [f64; 2] = [0.2, 0.998];

/// The state of the descent: a surface and the feet of the contacts on it.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Distinct coefficients.
    pub coefficients: Vec<Vector>,
    /// Feet of the contacts on it.
    pub feet: Feet,
}

/// The result of a descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    /// Parts of F.
    pub sums: Sums,
    /// Steps taken.
    pub steps: usize,
    /// Trials refused because they folded.
    pub folds_refused: usize,
    /// Whether the last step was below the tolerance, or no damping finds a lower value.
    pub settled: bool,
}

/// Work space of the descent.
#[derive(Clone, Debug)]
pub(super) struct Solver {
    /// Gauss-Newton matrix.
    pub matrix: BlockMatrix,
    /// Its factor.
    pub factor: BlockCholesky,
}

impl Solver {
    /// Plans for the numbering of the coefficients of `problem`.
    ///
    /// # Errors
    /// No memory.
    pub(super) fn new(problem: &Problem) -> Result<Solver, FitError> {
        let matrix = BlockMatrix::zeros(problem.cells.shape());
        let factor = BlockCholesky::plan(&matrix).map_err(|source| FitError::Solve { source })?;
        Ok(Solver { matrix, factor })
    }

    /// Minimises F from `state` until all coefficients are within `near` of the minimum.
    ///
    /// # Errors
    /// A start without a tangent plane; a matrix that has no factor even when damped.
    pub(super) fn descend(&mut self, problem: &Problem, state: &mut State, near: f64) -> Result<Descent, FitError> {
        state.feet = state.feet.moved(problem.cells, problem.contacts, &state.coefficients);
        let (value, sums) = problem.value(&state.coefficients, &state.feet).ok_or(FitError::Degenerate)?;
        let mut reached = ReachedSurface { state: state.clone(), value, sums };
        let rhs = vec![0.0; self.matrix.order()];
        let mut model = Trials { problem, solver: self, rhs, near, last: Vec::new(), before: None, folds_refused: 0 };
        let steps = if near > TOLERANCE { MAX_COARSE_STEPS } else { MAX_STEPS };
        let settings = Settings { steps, ..SETTINGS };
        let found = levenberg_marquardt::descend(&mut model, &mut reached, &mut SETTINGS.first.clone(), &settings);
        let folds_refused = model.folds_refused;
        let ReachedSurface { state: last, sums, .. } = reached;
        *state = last;
        let levenberg_marquardt::DescentEnd { steps, is_settled: settled } =
            found.map_err(|source| FitError::Solve { source })?;
        Ok(Descent { sums, steps, folds_refused, settled })
    }
}

/// A surface, F and its parts.
struct ReachedSurface {
    state: State,
    value: f64,
    sums: Sums,
}

/// A step of all coefficients, `factor * by`.
struct Move {
    by: Vec<f64>,
    factor: f64,
}

impl Move {
    fn size(&self) -> f64 {
        self.factor * self.by.iter().fold(0.0_f64, |m, v| m.max(v.abs()))
    }
}

/// The objective as a residual model whose trials find their own feet.
struct Trials<'a, 'b> {
    problem: &'a Problem<'b>,
    solver: &'a mut Solver,
    rhs: Vec<f64>,
    near: f64,
    /// The last step that was taken, where the next one may go on with its series.
    last: Vec<f64>,
    /// Size of the step before.
    before: Option<f64>,
    folds_refused: usize,
}

impl ResidualModel for Trials<'_, '_> {
    type Point = ReachedSurface;
    type Step = Move;
    type Error = SolveError;

    fn linearise(&mut self, at: &ReachedSurface) -> f64 {
        self.solver.matrix.clear();
        self.rhs.fill(0.0);
        let State { coefficients, feet } = &at.state;
        self.problem.assemble(coefficients, feet, Parts::ALL, &mut self.solver.matrix, &mut self.rhs);
        at.value
    }

    fn solve(&mut self, damping: f64) -> Result<Move, SolveError> {
        self.solver.factor.factor(&self.solver.matrix, damping)?;
        let mut by = self.rhs.clone();
        self.solver.factor.solve(&mut by);
        Ok(Move { by, factor: 1.0 })
    }

    fn moved(&mut self, from: &ReachedSurface, step: &Move) -> Option<(ReachedSurface, f64)> {
        let (problem, state) = (self.problem, &from.state);
        let along = step.by.as_chunks::<3>().0;
        let moved = |(c, m): (&Vector, &Vector)| [0, 1, 2].map(|d| c[d] + step.factor * m[d]);
        let next: Vec<Vector> = state.coefficients.iter().zip(along).map(moved).collect();
        if folds(problem, state, &next) {
            self.folds_refused += 1;
            return None;
        }
        let feet = state.feet.moved(problem.cells, problem.contacts, &next);
        let (value, sums) = problem.value(&next, &feet)?;
        Some((ReachedSurface { state: State { coefficients: next, feet }, value, sums }, value))
    }

    fn extrapolated(&mut self, step: &Move, damping: f64) -> Option<Move> {
        let factor = if damping <= FREE { stretch(&self.last, &step.by) } else { 1.0 };
        (factor != 1.0).then(|| Move { by: step.by.clone(), factor })
    }

    fn decided(&mut self, taken: Option<levenberg_marquardt::TakenStep<'_, Move>>) {
        self.last.clear();
        if let Some(taken) = taken.filter(|taken| !taken.is_extrapolated) {
            self.last.extend_from_slice(&taken.step.by);
        }
    }

    fn gives_up(&self, step: &Move, _: f64, _: Option<f64>) -> bool {
        step.size() <= self.near
    }

    fn is_settled(&mut self, step: &Move, _: f64, _: f64) -> bool {
        let size = step.size();
        let left = self.before.filter(|b| size <= GEOMETRIC * b).map_or(size, |b| size * size / (b - size));
        self.before = Some(size);
        left <= self.near
    }
}

/// `1/(1 - q)`, the sum of the whole series, where two successive steps are like those of a geometric series with ratio q,
/// else 1. Gauss-Newton leaves out the second derivatives of the residuals, so along one direction it may converge slowly
/// or oscillate.
fn stretch(last: &[f64], now: &[f64]) -> f64 {
    let (both, before, after) = (linalg::dot(last, now), linalg::dot(last, last), linalg::dot(now, now));
    let ratio = both / before;
    let parallel = both.abs() > PARALLEL * (before * after).sqrt();
    if parallel && RATIOS[0] < ratio.abs() && ratio.abs() < RATIOS[1] { 1.0 / (1.0 - ratio) } else { 1.0 }
}

/// Whether the surface folds somewhere between `state` and `next`.
fn folds(problem: &Problem, state: &State, next: &[Vector]) -> bool {
    let cells = problem.cells;
    let flipped = |row: &Row| dot(cells.area(row, &state.coefficients), cells.area(row, next)) <= 0.0;
    let places = &state.feet.places;
    parallel::any(problem.gauss.len(), |k| flipped(&problem.gauss[k].row))
        || parallel::any(places.len(), |r| flipped(&cells.row(places[r][0], places[r][1], 1)))
}
