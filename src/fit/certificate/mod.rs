//! How far to trust the numbers of a fit.
//!
//! ```text
//! condition        |E D|_1 |(E D)^+|_1, D the columns' inverse norms; root of the estimate for D E'E D, or R's
//! backward error   of the coefficients as an answer to the written problem                    backward.rs
//! promise          digits of the coefficients, of S and of R, from the two                    promise.rs
//! ```

pub(super) mod backward;
pub(super) mod bounds;
pub(super) mod guaranteed_digits;
pub(super) mod row_passes;

use crate::fit::certificate::backward::backward;
use crate::fit::certificate::guaranteed_digits::{Promise, promise};
use crate::fit::{Fit, MethodUsed, Reason};

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
    /// Digits that the answer has at least.
    pub promise: Promise,
    /// Coefficients (number `i m + j`) that the data leave free.
    pub unsupported: Vec<usize>,
    /// Refinement steps taken.
    pub refinements: usize,
    /// Size of the last refinement over the first.
    pub refinement_gain: f64,
}

/// Computes everything that the fit itself did not need.
pub fn certify(fit: &Fit) -> Certificate {
    let solution = &fit.fitted.solution;
    let condition = fit.condition();
    let backward = backward(fit, condition);
    Certificate {
        method: solution.method,
        reasons: solution.reasons.clone(),
        equations: fit.fitted.equations.count(),
        unknowns: fit.fitted.equations.unknowns(),
        rank: solution.rank,
        condition,
        backward_error: backward.error,
        promise: promise(fit, condition, &backward),
        unsupported: solution.unsupported.clone(),
        refinements: solution.refinements,
        refinement_gain: solution.refinement_gain,
    }
}
