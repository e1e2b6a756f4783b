//! Robust losses by reweighting: the weights of positions and normals follow from their residuals, and the fit is
//! repeated until the coefficients no longer move.
//!
//! ```text
//! Huber  w^2 = min(1, 1.345/|r|)        Tukey  w = max(0, 1 - (r/4.685)^2)        r over its own median scale
//! ```

use super::descent::{Descent, Solver, State, TOLERANCE};
use super::noise::NO_NOISE;
use super::patch_contacts::PatchContacts;
use super::problem::Problem;
use super::vector::{minus, norm};
use crate::fit::{FitError, Robust};

/// Most reweightings of a robust fit.
const REWEIGHTINGS: usize = 20;
/// The reweighting ends when no coefficient moves by more, patch units.
const SMALLEST_MOVE: f64 = 1e-9;

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
    if robust == Robust::None {
        return None;
    }
    let residuals = problem.residuals(&state.coefficients, &state.feet);
    let scale = |k: usize, to_sd: f64| {
        let mut sizes: Vec<f64> = residuals.iter().map(|r| r[k].abs()).collect();
        sizes.sort_by(f64::total_cmp);
        (sizes[sizes.len() / 2] * to_sd).max(NO_NOISE)
    };
    // medians of a normal distribution's magnitude and of a Rayleigh distribution
    let scales = [scale(0, 1.4826), scale(1, 0.849_3)];
    Some([0, 1].map(|k| residuals.iter().map(|r| loss_weight(robust, r[k] / scales[k])).collect()))
}

/// Square root of the weight of the loss, tuned for 95 % efficiency.
fn loss_weight(robust: Robust, r: f64) -> f64 {
    match robust {
        Robust::None => 1.0,
        Robust::Huber => (1.345 / r.abs().max(1.345)).sqrt(),
        Robust::Tukey => (1.0 - (r / 4.685).powi(2)).max(0.0),
    }
}
