//! Robust losses by reweighting: the weights of positions and normals follow from their residuals, and the fit is
//! repeated until the coefficients no longer move.
//!
//! ```text
//! rows times sqrt w(t) of Huber or Tukey, t = |r| over its own median scale         [`palpate_numeric::statistics::Loss`]
//! no scale is smaller than the rounding of the numbers
//! ```

use super::descent::{Descent, Solver, State, TOLERANCE};
use super::noise::NO_NOISE;
use super::patch_contacts::PatchContacts;
use super::problem::Problem;
use super::vector::{minus, norm};
use crate::fit::{FitError, Robust};
use palpate_numeric::statistics::{Loss, MAD_TO_SD, upper_median};

/// Most reweightings of a robust fit.
const REWEIGHTINGS: usize = 20;
/// The reweighting ends when no coefficient moves by more, patch units.
const SMALLEST_MOVE: f64 = 1e-9;
/// `RAYLEIGH_TO_SD` to four digits, by which these fits have always been scaled; the next digits would move them all.
const RAYLEIGH: f64 = 0.849_3;

/// Reweights and refits; the weights are left in `weighted`.
///
/// # Errors
/// As [`Solver::descend`].
pub(super) fn reweight(
    robust: Robust,
    problem: &Problem,
    weighted: &mut PatchContacts,
    solver: &mut Solver,
    state: &mut State,
    reached: &mut Descent,
) -> Result<(), FitError> {
    for _ in 0..REWEIGHTINGS {
        let Some([p, n]) = robust_weights(robust, problem, state) else { break };
        *weighted = problem.contacts.clone();
        weighted.position_weight.iter_mut().zip(p).for_each(|(w, v)| *w *= v);
        weighted.normal_weight.iter_mut().zip(n).for_each(|(w, v)| *w *= v);
        let before = state.coefficients.clone();
        let again = Problem::new(problem.cells, weighted, problem.flattened, problem.gauss, problem.weights);
        let next = solver.descend(&again, state, TOLERANCE)?;
        *reached = Descent { steps: reached.steps + next.steps, ..next };
        let moved = before.iter().zip(&state.coefficients).map(|(a, b)| norm(minus(*a, *b)));
        if moved.fold(0.0, f64::max) < SMALLEST_MOVE {
            break;
        }
    }
    Ok(())
}

/// Robust weights of positions and normals at the present residuals.
fn robust_weights(robust: Robust, problem: &Problem, state: &State) -> Option<[Vec<f64>; 2]> {
    let loss = match robust {
        Robust::None => return None,
        Robust::Huber => Loss::Huber,
        Robust::Tukey => Loss::Tukey,
    };
    let residuals = problem.residuals(&state.coefficients, &state.feet);
    let scale = |k: usize, to_sd: f64| {
        let sizes: Vec<f64> = residuals.iter().map(|r| r[k].abs()).collect();
        (upper_median(sizes).unwrap_or(0.0) * to_sd).max(NO_NOISE).max(problem.contacts.rounding[k])
    };
    let scales = [scale(0, MAD_TO_SD), scale(1, RAYLEIGH)];
    Some([0, 1].map(|k| residuals.iter().map(|r| loss.root_weight((r[k] / scales[k]).abs())).collect()))
}
