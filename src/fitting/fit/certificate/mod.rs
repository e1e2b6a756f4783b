//! How far to trust the numbers of a fit.
//!
//! ```text
//! condition        |E D|_1 |(E D)^+|_1, D the columns' inverse norms; root of the estimate for D E'E D, or R's
//! backward error   of the coefficients as an answer to the written problem                    backward.rs
//! guaranteed       digits of the coefficients, of S and of R, from the two                    guaranteed_digits.rs
//! ```

mod backward;
mod bounds;
pub(super) mod guaranteed_digits;
mod row_passes;

use crate::fit::linear::reasons::Reason;
use crate::fit::options::method::MethodUsed;
use crate::fit::solved::Solved;
use backward::backward;
use guaranteed_digits::guaranteed_digits;
use palpate_geometry::shape::{GridGradients, ShapeMaps};

/// The certificate of one fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Method that gave the answer.
    pub method: MethodUsed,
    /// Every decision on the way.
    pub reasons: Vec<Reason>,
    /// Equations with a weight that is not zero.
    pub equations: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Numerical rank.
    pub rank: usize,
    /// Condition of the equilibrated weighted rows.
    pub condition: f64,
    /// Componentwise backward error of the augmented system.
    pub backward_error: f64,
    /// Decimal digits in which the coefficients agree at least with the exact solution of the written problem: in the input's
    /// frame, relative to the largest. Coefficients that the data leave free are left out of both.
    pub digits_of_coefficients: f64,
    /// The same of S at the worst supported grid point, absolute.
    pub digits_of_shape_index: f64,
    /// The same of R at the worst supported grid point, relative.
    pub digits_of_curvedness: f64,
    /// Coefficients (number `i m + j`) that the data leave free.
    pub unsupported: Vec<usize>,
    /// Refinement steps taken.
    pub refinements: usize,
    /// Size of the last refinement over the first.
    pub refinement_gain: f64,
}

/// The certificate of a solved fit and of the S and R it gives; computes what the fit itself did not need.
pub(super) fn certify(solved: &Solved, maps: &ShapeMaps, gradients: &GridGradients) -> Certificate {
    let (equations, solution) = (&solved.fitted.equations, &solved.fitted.solution);
    let backward = backward(solved);
    let [digits_of_coefficients, digits_of_shape_index, digits_of_curvedness] =
        guaranteed_digits(solved, maps, gradients, &backward);
    Certificate {
        method: solution.method,
        reasons: solution.reasons.clone(),
        equations: equations.count(),
        unknowns: equations.unknowns(),
        rank: solution.rank,
        condition: solved.condition(),
        backward_error: backward.error,
        digits_of_coefficients,
        digits_of_shape_index,
        digits_of_curvedness,
        unsupported: solution.unsupported.clone(),
        refinements: solution.refinements,
        refinement_gain: solution.refinement_gain,
    }
}
