//! The answer of one linear problem: coefficients, the factor they came from, and the record of how.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::reasons::{MethodUsed, Reason};
use crate::linalg::StencilMatrix;
use crate::solve::{Cholesky, GridSolver, PivotedQr, TriangularFactor};

/// A factor of the final problem, kept for covariance, condition and further right-hand sides.
#[derive(Clone, Debug)]
pub enum Factor {
    /// Cholesky of the normal matrix, the rows and columns of free unknowns masked.
    Cholesky(Box<Cholesky>),
    /// R of the rows.
    Triangular(Box<TriangularFactor>),
    /// Rank-revealing R.
    Pivoted(Box<PivotedQr>),
    /// Fast diagonalisation, direct or as preconditioner.
    Grid(Box<GridSolver>),
}

impl Factor {
    /// `v <- (E'E)^-1 v` over the determined unknowns.
    pub fn solve(&self, v: &mut [f64]) {
        match self {
            Factor::Cholesky(factor) => factor.solve(v),
            Factor::Triangular(factor) => factor.solve(v),
            Factor::Pivoted(factor) => factor.solve(v),
            Factor::Grid(solver) => {
                solver.solve(v);
            }
        }
    }

    /// `tr (E'E)^-1 B` over the unknowns for which `out` is false; `None` where the factor would have to solve for each.
    pub fn inverse_trace(&self, b: &StencilMatrix, out: impl Fn(usize) -> bool) -> Option<f64> {
        match self {
            Factor::Cholesky(factor) => factor.inverse_trace(b, out),
            _ => None,
        }
    }

    /// Writes `(E'E)^-1` row by row; `out` holds the square of the order.
    pub fn write_inverse(&self, out: &mut [f64]) {
        if let Factor::Cholesky(factor) = self
            && factor.write_inverse(out)
        {
            return;
        }
        let order = out.len().isqrt();
        out.fill(0.0);
        for (u, row) in out.chunks_exact_mut(order.max(1)).enumerate() {
            row[u] = 1.0;
            self.solve(row);
        }
    }

    /// 1-norm condition estimate of the equilibrated rows.
    pub fn condition(&self) -> f64 {
        match self {
            Factor::Cholesky(factor) => factor.condition(),
            Factor::Triangular(factor) => factor.condition(),
            Factor::Pivoted(factor) => factor.condition(),
            Factor::Grid(solver) => solver.condition(),
        }
    }
}

/// Coefficients with the factor and the record of how they came about.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Coefficients in the patch frame, number `i m + j`.
    pub coefficients: Vec<f64>,
    /// Factor of the problem solved.
    pub factor: Factor,
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
}

impl Solution {
    /// Inverse norms of E's columns, where the factor has them: Cholesky's equilibration of a matrix that is E'E and
    /// nothing else. Those of unsupported unknowns mean nothing.
    pub fn column_scales(&self, equations: &Equations) -> Option<&[f64]> {
        match &self.factor {
            Factor::Cholesky(factor) if equations.roughness.is_none() && self.pinned.is_none() => Some(factor.scale()),
            _ => None,
        }
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
