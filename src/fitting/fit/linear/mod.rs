//! Step 3b: one linear problem to coefficients, the cheapest safe way first, every decision on record.
//!
//! ```text
//! Cholesky of D(E'E)D  ->  refined from the rows  ->  QR of the rows, refined (corrected semi-normal equations)
//!                      ->  rank-revealing QR, the undetermined part of least roughness
//! ```

mod cholesky;
pub(super) mod equations;
pub(super) mod free_unknowns;
mod grid;
mod minimum_roughness;
mod pivoted;
mod qr;
pub(super) mod reasons;
mod refinement;
pub(super) mod solution;

use crate::fit::{FitError, Method};
use equations::Equations;
use free_unknowns::Free;
use grid::GridMethod;
use palpate_numeric::linalg::{Sites, StencilMatrix};
use palpate_numeric::solve::SolveError;
use reasons::Reason;
use refinement::Refinement;
use solution::Solution;

/// The condition of the normal matrix beyond which Cholesky loses more than half the digits: 1/sqrt(2^-53), rounded.
const HALF_THE_DIGITS: f64 = 1e8;

/// Solves the problem by the method asked for.
///
/// # Errors
/// Where the method does not apply, or no method gives an answer.
pub(super) fn solve(equations: &Equations, method: Method) -> Result<Solution, FitError> {
    solve_refined(equations, method, Refinement::UntilStill)
}

/// Solves a problem whose answer only starts the next one: refinement is left out where the pivots are sound.
///
/// # Errors
/// As [`solve`].
pub(super) fn solve_intermediate(equations: &Equations, method: Method) -> Result<Solution, FitError> {
    solve_refined(equations, method, Refinement::WhereInDoubt)
}

fn solve_refined(equations: &Equations, method: Method, refinement: Refinement) -> Result<Solution, FitError> {
    let matrix = equations.normal_matrix();
    let mut free = Free::find(&matrix, equations.roughness.is_some());
    let [heights, _] = equations.row_weights.row_counts(equations.sites.len());
    if heights == 0 {
        free = free.pin_constant(&matrix);
    }
    let mut solution = match method {
        Method::Auto => by_cheapest(equations, &matrix, &free, refinement),
        Method::Cholesky => by_cholesky(equations, &matrix, &free, refinement),
        Method::Qr => qr::by_qr(equations, &matrix, &free, vec![Reason::Requested]),
        Method::Kronecker => grid::solve(equations, matrix, &free, GridMethod::Direct),
        Method::Pcg => grid::solve(equations, matrix, &free, GridMethod::Iterative),
    }?;
    if heights == 0 {
        solution.reasons.push(Reason::NoHeights);
        minimum_roughness::centre_heights(equations, &mut solution.coefficients);
    }
    Ok(solution)
}

/// Cholesky as the user asked for it, whatever the condition.
fn by_cholesky(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: &Free,
    refinement: Refinement,
) -> Result<Solution, FitError> {
    let factor = cholesky::factor(matrix, free).map_err(|source| FitError::Solve { source })?;
    Ok(factor.solve(equations, free, vec![Reason::Requested], refinement)?)
}

/// Cholesky where it keeps half the digits, else QR.
fn by_cheapest(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: &Free,
    refinement: Refinement,
) -> Result<Solution, FitError> {
    let factor = match cholesky::factor(matrix, free) {
        Ok(factor) => factor,
        Err(SolveError::NotPositiveDefinite { unknown }) => {
            return qr::by_qr(equations, matrix, free, vec![Reason::CholeskyBroke { unknown }]);
        }
        Err(source) => return Err(FitError::Solve { source }),
    };
    let reasons = match factor.doubtful_condition {
        Some(condition) if condition * condition > HALF_THE_DIGITS => {
            return qr::by_qr(equations, matrix, free, vec![Reason::ConditionPoor { condition }]);
        }
        Some(_) => Vec::new(),
        None => vec![Reason::PivotsSound],
    };
    factor
        .solve(equations, free, reasons, refinement)
        .or_else(|_| qr::by_qr(equations, matrix, free, vec![Reason::GapUnfilled { coefficients: free.count() }]))
}
