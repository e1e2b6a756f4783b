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
use palpate_numeric::linalg::{self, BlockMatrix};
use palpate_numeric::solve::BlockCholesky;

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
/// First damping, and its bounds: with 1e-14 a step is undamped, with 1e8 it has practically no length.
const DAMPING: [f64; 3] = [1e-6, 1e-14, 1e8];

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
    /// F.
    pub value: f64,
    /// Its parts.
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
    last: Vec<f64>,
}

impl Solver {
    /// Plans for the numbering of the coefficients of `problem`.
    ///
    /// # Errors
    /// No memory.
    pub(super) fn new(problem: &Problem) -> Result<Solver, FitError> {
        let matrix = BlockMatrix::zeros(problem.cells.shape());
        let factor = BlockCholesky::plan(&matrix).map_err(|source| FitError::Solve { source })?;
        Ok(Solver { matrix, factor, last: Vec::new() })
    }

    /// Minimises F from `state` until all coefficients are within `near` of the minimum.
    ///
    /// # Errors
    /// A start without a tangent plane; a matrix that has no factor even when damped.
    pub(super) fn descend(&mut self, problem: &Problem, state: &mut State, near: f64) -> Result<Descent, FitError> {
        state.feet = state.feet.moved(problem.cells, problem.contacts, &state.coefficients);
        let (value, sums) = problem.value(&state.coefficients, &state.feet).ok_or(FitError::Degenerate)?;
        let mut reached = Descent { value, sums, steps: 0, folds_refused: 0, settled: false };
        let mut damping = DAMPING[0];
        let mut rhs = vec![0.0; self.matrix.order()];
        let mut before: Option<f64> = None;
        self.last.clear();
        let most = if near > TOLERANCE { MAX_COARSE_STEPS } else { MAX_STEPS };
        while reached.steps < most && !reached.settled {
            self.matrix.clear();
            rhs.fill(0.0);
            problem.assemble(&state.coefficients, &state.feet, Parts::ALL, &mut self.matrix, &mut rhs);
            let Some(size) = self.step(problem, state, &rhs, &mut damping, &mut reached, near)? else {
                reached.settled = true;
                break;
            };
            reached.steps += 1;
            let left = before.filter(|b| size <= GEOMETRIC * b).map_or(size, |b| size * size / (b - size));
            reached.settled = left <= near;
            before = Some(size);
        }
        Ok(reached)
    }

    /// Takes one step downwards and returns its size; `None` when no damping finds one.
    fn step(
        &mut self,
        problem: &Problem,
        state: &mut State,
        rhs: &[f64],
        damping: &mut f64,
        reached: &mut Descent,
        near: f64,
    ) -> Result<Option<f64>, FitError> {
        while *damping <= DAMPING[2] {
            if let Err(source) = self.factor.factor(&self.matrix, *damping) {
                *damping *= 10.0;
                if *damping > DAMPING[2] {
                    return Err(FitError::Solve { source });
                }
                continue;
            }
            let mut move_by = rhs.to_vec();
            self.factor.solve(&mut move_by);
            let size = move_by.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let stretch = if *damping <= FREE { stretch(&self.last, &move_by) } else { 1.0 };
            if stretch != 1.0 && accepted(problem, state, &move_by, stretch, reached) {
                self.last.clear();
                return Ok(Some(stretch * size));
            }
            if accepted(problem, state, &move_by, 1.0, reached) {
                *damping = (*damping / 10.0).max(DAMPING[1]);
                self.last = move_by;
                return Ok(Some(size));
            }
            self.last.clear();
            if size <= near {
                return Ok(None);
            }
            *damping *= 10.0;
        }
        *damping = DAMPING[0];
        Ok(None)
    }
}

/// Takes the step `factor * move_by` if it folds nothing and goes down.
fn accepted(problem: &Problem, state: &mut State, move_by: &[f64], factor: f64, reached: &mut Descent) -> bool {
    let along = move_by.as_chunks::<3>().0;
    let moved = |(c, m): (&Vector, &Vector)| [0, 1, 2].map(|d| c[d] + factor * m[d]);
    let next: Vec<Vector> = state.coefficients.iter().zip(along).map(moved).collect();
    if folds(problem, state, &next) {
        reached.folds_refused += 1;
        return false;
    }
    let feet = state.feet.moved(problem.cells, problem.contacts, &next);
    match problem.value(&next, &feet) {
        // F is rounded to about 1e-15 of itself, so the last step may not lower it visibly
        Some((value, sums)) if value <= reached.value * (1.0 + 1e-14) => {
            *state = State { coefficients: next, feet };
            (reached.value, reached.sums) = (value, sums);
            true
        }
        _ => false,
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
