//! Iterative refinement with the residual from the rows, by whichever factor the solution has.
//!
//! ```text
//! c <- c + (E'E)^-1 (E'(b - E c) - lambda P c)          until the corrections stop shrinking
//! ```

use crate::fit::linear::equations::Equations;
use crate::fit::linear::free_unknowns::Free;
use crate::fit::linear::solution::Solution;

/// Refinement steps at most; each step gains about -log10(condition^2 u) digits, two are nearly always enough.
const MAX_REFINEMENTS: usize = 4;
/// A step that is expected to move no coefficient by more than this share of the largest is left out.
const NOTHING_LEFT: f64 = f64::EPSILON / 64.0;

/// When a solution is refined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refinement {
    /// Always: for a final answer.
    UntilStill,
    /// Only where pivots are in doubt: for an intermediate step, whose last four digits the next step does not need.
    WhereInDoubt,
}

/// Corrections `(E'E)^-1 (E'(b - E c) - lambda P c)` until they stop shrinking.
pub(super) fn refine(equations: &Equations, solution: &mut Solution, free: &Free) {
    let (mut first, mut last) = (0.0, f64::INFINITY);
    for step in 0..MAX_REFINEMENTS {
        let mut correction = equations.descent(&solution.coefficients);
        free.clear(&mut correction);
        solution.factor.solve(&mut correction);
        let size = correction.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if !size.is_finite() || size >= 0.5 * last {
            break;
        }
        solution.coefficients.iter_mut().zip(&correction).for_each(|(c, d)| *c += d);
        solution.refinements = step + 1;
        if step == 0 {
            first = size;
        }
        // the size of the first step says nothing about the contraction
        let contraction = if step == 0 { 1.0 } else { size / last };
        last = size;
        // the next step would be below the last bit of every coefficient that matters
        let largest = solution.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if size * contraction <= NOTHING_LEFT * largest {
            break;
        }
    }
    if solution.refinements > 1 && first > 0.0 {
        solution.refinement_gain = last / first;
    }
}
