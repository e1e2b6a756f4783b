//! The answer of one linear problem: coefficients, the factor they came from, and the record of how.

use std::sync::Arc;

use crate::fit::linear::equations::Equations;
use crate::fit::linear::reasons::Reason;
use crate::fit::options::method::MethodUsed;
use palpate_numeric::solve::Factor;

/// Condition of the rows beyond which a Cholesky factor, of whose matrix it is the root of the condition, may be rounding: the
/// estimate can then be too small by any factor.
pub(crate) const BEYOND_CHOLESKY: f64 = 1e7;

/// Coefficients with the factor and the record of how they came about.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Coefficients in the patch frame, number `i m + j`.
    pub coefficients: Vec<f64>,
    /// Factor of the problem solved.
    pub factor: Arc<dyn Factor>,
    /// Method that gave the answer.
    pub method: MethodUsed,
    /// Every decision on the way.
    pub reasons: Vec<Reason>,
    /// Numerical rank.
    pub rank: usize,
    /// Coefficients that the data leave free or nearly free, ascending.
    pub unsupported: Vec<usize>,
    /// Without height rows: the coefficient that the factor holds in place of the constant.
    pub pinned: Option<usize>,
    /// Refinement steps taken.
    pub refinements: usize,
    /// Size of the last refinement step over that of the first.
    pub refinement_gain: f64,
    /// Turns in which coefficients without data and the others settled.
    pub turns: usize,
    /// What coefficients without data and their neighbours may still have to move, relative to the largest coefficient.
    pub unsettled: f64,
    /// By how much the coefficients without data enlarge what the others are off by; 1 where the two settle by turns.
    pub enlarged: f64,
    /// What rounding in the coefficients without data can move the rows by, `|E_F dc_F|_2`.
    pub filled: f64,
}

impl Solution {
    /// What a factor of all equations gives, before anything is refined.
    pub(crate) fn unrefined(
        coefficients: Vec<f64>,
        factor: impl Factor + 'static,
        method: MethodUsed,
        reasons: Vec<Reason>,
        rank: usize,
    ) -> Solution {
        Solution {
            coefficients,
            factor: Arc::new(factor),
            method,
            reasons,
            rank,
            unsupported: Vec::new(),
            pinned: None,
            refinements: 0,
            refinement_gain: 1.0,
            turns: 0,
            unsettled: 0.0,
            enlarged: 1.0,
            filled: 0.0,
        }
    }

    /// Inverse norms of E's columns, where the factor has them: Cholesky's equilibration of a matrix that is E'E and
    /// nothing else. Those of unsupported unknowns mean nothing.
    pub fn column_scales(&self, equations: &Equations) -> Option<&[f64]> {
        let is_normal_matrix = equations.roughness.is_none() && self.pinned.is_none();
        if is_normal_matrix { self.factor.column_scales() } else { None }
    }

    /// Whether unknown `u` is not determined by the data: unsupported, or pinned in place of the constant.
    pub fn is_free(&self, u: usize) -> bool {
        self.unsupported.binary_search(&u).is_ok() || self.pinned == Some(u)
    }

    /// Sets the entries of free unknowns to zero.
    pub fn clear_free(&self, v: &mut [f64]) {
        self.unsupported.iter().chain(&self.pinned).for_each(|&u| v[u] = 0.0);
    }
}
