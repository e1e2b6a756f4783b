//! Keeps the surface from bending more than its contacts can have felt, by raising an estimated weight of fairness.
//!
//! ```text
//! while bending > 2.5:  lambda <- max(10 lambda, 1), descend from the start again        at most six times
//! ```

use super::bending::MOST_BENDING;
use super::certificate::{self, GeometryCheck};
use super::descent::{Descent, Solver, State};
use super::flattening::Flattening;
use super::layout;
use super::noise::{self, Unknown, Until};
use super::problem::Problem;
use crate::fit::FitError;

/// Largest share of the contacts whose normals may point to the other side of the fitted surface.
const MOST_AGAINST: f64 = 0.1;
/// How often an estimated fairness is raised tenfold when the surface bends too much.
const MOST_RAISES: usize = 6;

/// The geometry of the final surface, and how often fairness was raised for it.
pub(super) struct Limited {
    /// Folds, sides and bending.
    pub geometry: GeometryCheck,
    /// Number of raises.
    pub raised: usize,
}

/// Checks the surface in `state`, and replaces it by one with more fairness as long as it bends too much.
///
/// # Errors
/// Normals against the surface; too much bending that a declared fairness, or the largest one, does not hold back.
pub(super) fn limit(
    problem: &mut Problem,
    solver: &mut Solver,
    flat: &Flattening,
    unknown: Unknown,
    state: &mut State,
    reached: &mut Descent,
) -> Result<Limited, FitError> {
    let cells = problem.cells;
    let check = |problem: &Problem, state: &State| {
        certificate::check_geometry(problem, state, &layout::support(flat, &state.feet.places, cells.knots()))
    };
    let (mut geometry, mut raised) = (check(problem, state), 0);
    while !geometry.bends_within_limit() && unknown.fairness && raised < MOST_RAISES {
        problem.weights.fairness = (10.0 * problem.weights.fairness).max(1.0);
        raised += 1;
        let (again, descent) = noise::fit(problem, solver, Unknown::NOTHING, Until::SETTLED)?;
        *state = again;
        *reached = Descent { steps: reached.steps + descent.steps, ..descent };
        geometry = check(problem, state);
    }
    let contacts = problem.contacts.len();
    if geometry.against as f64 > MOST_AGAINST * contacts as f64 {
        return Err(FitError::Against { against: geometry.against, contacts });
    }
    if !geometry.bends_within_limit() {
        return Err(FitError::Runaway { bending: geometry.bending, most: MOST_BENDING });
    }
    Ok(Limited { geometry, raised })
}
