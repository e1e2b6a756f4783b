//! Levenberg-Marquardt on the objective, every trial with its own feet, none that folds.
//!
//! ```text
//! (A + mu diag A) dc = -1/2 grad F,   mu / 10 after a step that goes down, mu * 10 after one that does not or folds
//! ```
//!
//! A trial folds when `Q_u x Q_v` has turned against the measured normal of a contact that it went along with before,
//! or against its own direction at a Gauss point.

use super::cells::Row;
use super::foot::Feet;
use super::parallel;
use super::problem::{Parts, Problem, Sums};
use super::vector::{Vector, dot};
use crate::fit::FitError;
use crate::linalg::BlockMatrix;
use crate::solve::BlockCholesky;

/// Coefficients nearer to the minimum than this, patch units, end the descent.
pub const SETTLED: f64 = 1e-10;
/// The same while noise levels are still to move.
pub const ON_THE_WAY: f64 = 1e-6;
/// Ratio of two steps in a row up to which what is still to come is told from them as from a geometric series.
const GEOMETRIC: f64 = 0.5;
/// Steps of one descent; from the starts here 5 to 40 are taken, on rings that swing up to 150.
const MAX_STEPS: usize = 300;
/// The same while noise levels are still to move: a ring that swings does it with them.
const MAX_ON_THE_WAY: usize = 30;
/// Damping to begin with, and its bounds: 1e-14 is an undamped step, 1e8 one of no length.
const DAMPING: [f64; 3] = [1e-6, 1e-14, 1e8];

/// Damping up to which two steps in a row tell a ratio, and not the damping's change.
const FREE: f64 = 1e-5;
/// Cosine of two steps above which they are one series, and the ratios that are summed: below, the next step does it.
const PARALLEL: f64 = 0.9;
const RATIOS: [f64; 2] = [0.2, 0.998];

/// A surface on its way.
#[derive(Clone, Debug)]
pub struct State {
    /// Distinct coefficients.
    pub coefficients: Vec<Vector>,
    /// Feet of the contacts on it.
    pub feet: Feet,
}

/// What a descent came to.
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    /// F.
    pub value: f64,
    /// Its parts.
    pub sums: Sums,
    /// Steps taken.
    pub steps: usize,
    /// Trials refused because they folded.
    pub folds_refused: usize,
    /// The last step was below the tolerance, or nothing nearby is lower.
    pub settled: bool,
}

/// Work space of the descent.
#[derive(Debug)]
pub struct Solver {
    /// Gauss-Newton matrix.
    pub matrix: BlockMatrix,
    /// Its factor.
    pub factor: BlockCholesky,
    last: Vec<f64>,
}

impl Solver {
    /// For one numbering of coefficients.
    ///
    /// # Errors
    /// No memory.
    pub fn new(problem: &Problem) -> Result<Solver, FitError> {
        let matrix = BlockMatrix::zeros(problem.cells.shape());
        let factor = BlockCholesky::plan(&matrix).map_err(|source| FitError::Solve { source })?;
        Ok(Solver { matrix, factor, last: Vec::new() })
    }

    /// Minimises F from `state` until the coefficients are nearer than `near` to the minimum.
    ///
    /// # Errors
    /// A start without a tangent plane; a matrix without a factor even when damped.
    pub fn descend(&mut self, problem: &Problem, state: &mut State, near: f64) -> Result<Descent, FitError> {
        state.feet = state.feet.moved(problem.cells, problem.touches, &state.coefficients);
        let (value, sums) = problem.value(&state.coefficients, &state.feet).ok_or(FitError::Degenerate)?;
        let mut reached = Descent { value, sums, steps: 0, folds_refused: 0, settled: false };
        let mut damping = DAMPING[0];
        let mut rhs = vec![0.0; self.matrix.order()];
        let mut before: Option<f64> = None;
        self.last.clear();
        let most = if near > SETTLED { MAX_ON_THE_WAY } else { MAX_STEPS };
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

    /// One step downwards: its size, or `None` when no damping finds one.
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
    let feet = state.feet.moved(problem.cells, problem.touches, &next);
    match problem.value(&next, &feet) {
        // F rounds to about 1e-15 of itself: a last step may not see itself go down
        Some((value, sums)) if value <= reached.value * (1.0 + 1e-14) => {
            *state = State { coefficients: next, feet };
            (reached.value, reached.sums) = (value, sums);
            true
        }
        _ => false,
    }
}

/// `1/(1 - q)` where two steps in a row are as those of a geometric series with ratio q, else 1: the sum of what is still
/// to come. Gauss-Newton leaves out the bending of the residuals, so along one direction it may creep, or
/// swing from side to side.
fn stretch(last: &[f64], now: &[f64]) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let (both, before, after) = (product(last, now), product(last, last), product(now, now));
    let ratio = both / before;
    let parallel = both.abs() > PARALLEL * (before * after).sqrt();
    if parallel && RATIOS[0] < ratio.abs() && ratio.abs() < RATIOS[1] { 1.0 / (1.0 - ratio) } else { 1.0 }
}

/// Whether the map turns over somewhere on the way from `state` to `next`.
fn folds(problem: &Problem, state: &State, next: &[Vector]) -> bool {
    let cells = problem.cells;
    let turned = |row: &Row| dot(cells.area(row, &state.coefficients), cells.area(row, next)) <= 0.0;
    let places = &state.feet.places;
    parallel::any(problem.gauss.len(), |k| turned(&problem.gauss[k].row))
        || parallel::any(places.len(), |r| turned(&cells.row(places[r][0], places[r][1], 1)))
}
