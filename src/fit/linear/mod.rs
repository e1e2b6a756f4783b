//! Step 3b: one linear problem to coefficients, the cheapest safe way first, every move on record.
//!
//! ```text
//! Cholesky of D(E'E)D  ->  refined from the rows  ->  QR of the rows, refined (corrected semi-normal equations)
//!                      ->  rank-revealing QR, the undetermined part of least roughness
//! ```

pub(super) mod gaps;
pub(super) mod grid;
pub(super) mod reasons;
pub(super) mod refinement;

use crate::fit::objective::equations::Equations;
use gaps::Free;

use crate::fit::linear::reasons::{MethodUsed, Reason};
use crate::fit::linear::refinement::{Refinement, refine};
use crate::fit::{FitError, Method};
use crate::linalg::{Sites, StencilMatrix};
use crate::observation::{roughness_matrix, to_csr};
use crate::solve::{Cholesky, GridSolver, PivotedQr, SolveError, TriangularFactor};

/// Squared pivots of the equilibrated Cholesky factor below this call for its condition; above it fewer than 4 of 16
/// digits can be gone, and a hot loop pays for nothing more.
const PIVOT_IN_DOUBT: f64 = 1e-4;
/// The condition of the normal matrix beyond which Cholesky loses more than half the digits: 1/sqrt(2^-53), rounded.
const HALF_THE_DIGITS: f64 = 1e8;
/// Most entries of E that are written out for the dense rank-revealing factor (32 MB).
const DENSE_ENTRIES: usize = 1 << 22;

/// A factor of the final problem, kept for covariance, condition and further right-hand sides.
#[derive(Debug)]
pub enum Factor {
    /// Cholesky of the (masked) normal matrix.
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

    /// `tr (E'E)^-1 B` over the unknowns that are not left `out`, where the factor gives it without solving for them.
    pub fn inverse_trace(&self, b: &StencilMatrix, out: impl Fn(usize) -> bool) -> Option<f64> {
        match self {
            Factor::Cholesky(factor) => factor.inverse_trace(b, out),
            _ => None,
        }
    }

    /// `(E'E)^-1`, row by row: the order's square of numbers.
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
#[derive(Debug)]
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
    /// Coefficients that the data leave free or hold by a thread, ascending.
    pub unsupported: Vec<usize>,
    /// Without height rows: the coefficient that the factor holds in place of the constant.
    pub pinned: Option<usize>,
    /// Refinement steps taken.
    pub refinements: usize,
    /// Last step's move over the first's: what refinement gained.
    pub refinement_gain: f64,
}

impl Solution {
    /// Inverse norms of E's columns where the factor has them: those of a matrix that is E'E and nothing else, but for
    /// unknowns that no data hold.
    pub fn column_scales(&self, equations: &Equations) -> Option<&[f64]> {
        match &self.factor {
            Factor::Cholesky(factor) if equations.roughness.is_none() && self.pinned.is_none() => Some(factor.scale()),
            _ => None,
        }
    }

    /// Sets the entries of unknowns that no data hold to zero.
    pub fn clear_free(&self, v: &mut [f64]) {
        self.unsupported.iter().chain(&self.pinned).for_each(|&u| v[u] = 0.0);
    }
}

/// Solves the problem by the method asked for.
pub fn solve(equations: &Equations, method: Method) -> Result<Solution, FitError> {
    solve_refined(equations, method, Refinement::UntilStill)
}

/// Solves a problem that only leads to the next: what refinement would gain where pivots look sound is left out.
pub fn solve_on_the_way(equations: &Equations, method: Method) -> Result<Solution, FitError> {
    solve_refined(equations, method, Refinement::WhereInDoubt)
}

fn solve_refined(equations: &Equations, method: Method, refinement: Refinement) -> Result<Solution, FitError> {
    let matrix = equations.normal_matrix();
    let mut free = gaps::find(&matrix, equations.roughness.is_some());
    let [heights, _] = equations.row_weights.row_counts(equations.sites.len());
    if heights == 0 {
        free = free.pin_constant(&matrix);
    }
    let mut solution = by_method(equations, matrix, free, method, refinement)?;
    if heights == 0 {
        solution.reasons.push(Reason::NoHeights);
        gaps::level(equations, &mut solution.coefficients);
    }
    Ok(solution)
}

fn by_method(
    equations: &Equations,
    matrix: StencilMatrix,
    free: Free,
    method: Method,
    refinement: Refinement,
) -> Result<Solution, FitError> {
    match method {
        Method::Kronecker | Method::Pcg => grid::solve(equations, matrix, &free, method),
        Method::Qr => by_qr(equations, &matrix, free, vec![Reason::Requested]),
        Method::Cholesky => by_cholesky(equations, &matrix, &free, true, refinement).map_err(|broken| match broken {
            Broken::Solve(source) => FitError::Solve { source },
            Broken::Poor(_) => FitError::Rank { rank: 0, unknowns: equations.unknowns() },
        }),
        _ => match by_cholesky(equations, &matrix, &free, false, refinement) {
            Ok(solution) => Ok(solution),
            Err(Broken::Solve(SolveError::NotPositiveDefinite { unknown })) => {
                by_qr(equations, &matrix, free, vec![Reason::CholeskyBroke { unknown }])
            }
            Err(Broken::Solve(source)) => Err(FitError::Solve { source }),
            Err(Broken::Poor(condition)) => by_qr(equations, &matrix, free, vec![Reason::ConditionPoor { condition }]),
        },
    }
}

enum Broken {
    Solve(SolveError),
    Poor(f64),
}

fn by_cholesky(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: &Free,
    requested: bool,
    refinement: Refinement,
) -> Result<Solution, Broken> {
    let mut factor = Cholesky::plan(matrix.shape()).map_err(Broken::Solve)?;
    let masked = free.mask(matrix);
    factor.factor(masked.as_ref().unwrap_or(matrix)).map_err(Broken::Solve)?;
    let mut reasons = if requested { vec![Reason::Requested] } else { Vec::new() };
    let in_doubt = factor.smallest_pivot() < PIVOT_IN_DOUBT;
    if in_doubt {
        let condition = factor.condition();
        if !requested && condition * condition > HALF_THE_DIGITS {
            return Err(Broken::Poor(condition));
        }
        reasons.push(Reason::ConditionSound { condition });
    } else if !requested {
        reasons.push(Reason::PivotsSound);
    }
    let factor = Factor::Cholesky(Box::new(factor));
    let start = vec![0.0; matrix.order()];
    let mut solution = Solution {
        coefficients: start,
        factor,
        method: MethodUsed::Cholesky,
        reasons,
        rank: matrix.order() - free.len(),
        unsupported: free.list(),
        pinned: free.pinned(),
        refinements: 0,
        refinement_gain: 1.0,
    };
    gaps::complete_by_turns(equations, &mut solution, free);
    // where pivots look sound too: without it a backward error of 1e-12 stands (10,000 contacts in one spot)
    if in_doubt || refinement == Refinement::UntilStill {
        refine(equations, &mut solution, free);
    }
    Ok(solution)
}

fn by_qr(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: Free,
    mut reasons: Vec<Reason>,
) -> Result<Solution, FitError> {
    let dense = equations.count() * equations.unknowns() <= DENSE_ENTRIES && equations.roughness.is_none();
    let ratio = weight_ratio(equations);
    if dense && ratio > 1e6 {
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
    let mut solution = Solution {
        coefficients: factor.coefficients(),
        rank: factor.rank(),
        factor: Factor::Triangular(Box::new(factor)),
        method: MethodUsed::Qr,
        reasons,
        unsupported: Vec::new(),
        pinned: None,
        refinements: 0,
        refinement_gain: 1.0,
    };
    refine(equations, &mut solution, &free);
    Ok(solution)
}

/// With gaps or roughness the normal matrix is what is factored; QR's place is taken by refinement from the rows.
fn by_masked_cholesky(
    equations: &Equations,
    matrix: &StencilMatrix,
    free: Free,
    reasons: Vec<Reason>,
    dense: bool,
) -> Result<Solution, FitError> {
    match by_cholesky(equations, matrix, &free, true, Refinement::UntilStill) {
        Ok(mut solution) => {
            solution.reasons = reasons.into_iter().chain(solution.reasons.into_iter().skip(1)).collect();
            Ok(solution)
        }
        Err(_) if dense => by_pivoted_qr(equations, reasons, free),
        Err(Broken::Solve(source)) => Err(FitError::Solve { source }),
        Err(Broken::Poor(_)) => Err(FitError::Rank { rank: 0, unknowns: equations.unknowns() }),
    }
}

fn by_pivoted_qr(equations: &Equations, mut reasons: Vec<Reason>, free: Free) -> Result<Solution, FitError> {
    let e = to_csr(&equations.sites, &equations.row_weights);
    let unknowns = equations.unknowns();
    let live: Vec<usize> = (0..e.nrows()).filter(|&r| e.row(r).nnz() > 0).collect();
    // the constant, which no slope sees, gets a row of its own: sum of the coefficients zero
    let constant = free.pinned().is_some();
    let rows = live.len() + usize::from(constant);
    let mut values = vec![0.0; rows * unknowns];
    let mut rhs = vec![0.0; rows];
    for (k, &r) in live.iter().enumerate() {
        let row = e.row(r);
        for (column, value) in row.col_indices().iter().zip(row.values()) {
            values[column * rows + k] = *value;
        }
        rhs[k] = equations.targets[r / 3][r % 3];
    }
    if constant {
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        (0..unknowns).for_each(|column| values[column * rows + rows - 1] = largest);
    }
    let factor = PivotedQr::of_dense(rows, unknowns, &values, &rhs).map_err(|source| FitError::Solve { source })?;
    let mut coefficients = factor.coefficients();
    let mut unsupported = free.list();
    let rank = factor.rank();
    if rank < unknowns {
        if !reasons.iter().any(|r| matches!(r, Reason::RankDeficient { .. })) {
            reasons.push(Reason::RankDeficient { rank });
        }
        let knots = equations.sites.knots();
        let free_directions = factor.null_space();
        unsupported.extend(gaps::touched(&free_directions));
        gaps::smooth_along(&roughness_matrix(&knots), &free_directions, &mut coefficients);
    }
    unsupported.sort_unstable();
    unsupported.dedup();
    Ok(Solution {
        coefficients,
        rank,
        factor: Factor::Pivoted(Box::new(factor)),
        method: MethodUsed::PivotedQr,
        reasons,
        unsupported,
        pinned: None,
        refinements: 0,
        refinement_gain: 1.0,
    })
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
