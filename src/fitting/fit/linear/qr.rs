//! QR of the rows, where Cholesky would lose too many digits; rank-revealing QR where the rank is in question.

use crate::fit::FitError;
use crate::fit::linear::cholesky::{self, NormalFactor};
use crate::fit::linear::equations::Equations;
use crate::fit::linear::free_unknowns::Free;
use crate::fit::linear::pivoted::by_pivoted_qr;
use crate::fit::linear::reasons::Reason;
use crate::fit::linear::refinement::{Refinement, refine};
use crate::fit::linear::solution::{BEYOND_CHOLESKY, Solution};
use crate::fit::options::method::MethodUsed;
use crate::observation::roughness_row_count;
use palpate_numeric::linalg::{Sites, StencilMatrix};
use palpate_numeric::solve::TriangularFactor;

/// Most entries of E that are written out for the dense rank-revealing factor (32 MB).
const DENSE_ENTRIES: usize = 1 << 22;
/// Weights that differ by more than this make the plain QR lose digits of the light rows; sorted rows and pivoted columns
/// keep them, at the price of a dense factor.
const WEIGHTS_DIFFER: f64 = 1e6;

/// Solves by QR of the rows, refined (corrected semi-normal equations); `reasons` are those that led here.
///
/// # Errors
/// [`FitError::Rank`] where the rank is reduced and the rows are too many for the rank-revealing factor.
pub(super) fn by_qr(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: &Free,
    mut reasons: Vec<Reason>,
) -> Result<Solution, FitError> {
    let dense = dense_rows(equations) * equations.unknowns() <= DENSE_ENTRIES;
    let ratio = weight_ratio(equations);
    if dense && ratio > WEIGHTS_DIFFER && equations.roughness.is_none() {
        reasons.push(Reason::WeightsDiffer { ratio });
        return by_pivoted_qr(equations, reasons, free);
    }
    if !free.is_empty() || equations.roughness.is_some() {
        return by_masked_cholesky(equations, matrix, free, reasons, dense);
    }
    let factor =
        TriangularFactor::of_rows(&equations.sites, &equations.row_weights, &equations.targets, &matrix.diagonal())
            .map_err(|source| FitError::Solve { source })?;
    if factor.rank() < equations.unknowns() {
        reasons.push(Reason::RankDeficient { rank: factor.rank() });
        if dense {
            return by_pivoted_qr(equations, reasons, free);
        }
        return Err(FitError::Rank { rank: factor.rank(), unknowns: equations.unknowns() });
    }
    let (coefficients, rank) = (factor.coefficients(), factor.rank());
    let mut solution = Solution::unrefined(coefficients, factor, MethodUsed::Qr, reasons, rank);
    refine(equations, &mut solution, free);
    Ok(solution)
}

/// Rows of the dense factor: those of the data, and those whose squares are the roughness.
fn dense_rows(equations: &Equations) -> usize {
    let of_roughness =
        equations.roughness.as_ref().map_or(0, |rough| roughness_row_count(&equations.sites.knots(), &rough.terms));
    equations.count().saturating_add(of_roughness)
}

/// With gaps or roughness the normal matrix is factored whatever its condition, and refinement from the rows regains the
/// digits; where there is no such answer, or the factor may be rounding, small problems take the rank-revealing QR, with rows for the roughness.
fn by_masked_cholesky(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: &Free,
    reasons: Vec<Reason>,
    dense: bool,
) -> Result<Solution, FitError> {
    let is_rounding = |f: &NormalFactor| f.doubtful_condition.is_some_and(|condition| condition > BEYOND_CHOLESKY);
    let fault = match cholesky::factor(matrix, free) {
        Ok(factor) if dense && is_rounding(&factor) => return by_pivoted_qr(equations, reasons, free),
        Ok(factor) => match factor.solve(equations, free, reasons.clone(), Refinement::UntilStill) {
            Ok(solution) => return Ok(solution),
            Err(gap) => FitError::from(gap),
        },
        Err(source) => FitError::Solve { source },
    };
    if dense { by_pivoted_qr(equations, reasons, free) } else { Err(fault) }
}

/// Largest over smallest weight among the rows that count.
fn weight_ratio(equations: &Equations) -> f64 {
    let (mut lo, mut hi) = (f64::INFINITY, 0.0_f64);
    let mut take = |w: f64| {
        if w != 0.0 {
            (lo, hi) = (lo.min(w.abs()), hi.max(w.abs()));
        }
    };
    for r in 0..equations.sites.len() {
        let m = equations.row_weights.at(r);
        [m.z, m.a, m.d].into_iter().for_each(&mut take);
    }
    if hi == 0.0 { 1.0 } else { hi / lo }
}
