//! Grids solved through their two Kronecker factors: directly where that is exact, by conjugate gradients elsewhere.
//!
//! Exact: every pixel measured, one weight per block, slope rows, no roughness. Then `A^-1` needs two small eigenproblems
//! and four matrix products; otherwise the same factors with the mean weights precondition.

use crate::fit::linear::gaps::Free;
use crate::fit::linear::reasons::{MethodUsed, Reason};
use crate::fit::linear::refinement::refine;
use crate::fit::linear::{Factor, Solution};
use crate::fit::objective::equations::Equations;
use crate::fit::{FitError, Method, Observed};
use crate::linalg::{RowWeights, Sites, StencilMatrix};
use crate::observation::GridSites;
use crate::solve::{FastDiagonalisation, GridSolver};

/// Solves a grid's problem by `kronecker` or `pcg`.
pub fn solve(equations: &Equations, matrix: StencilMatrix, free: &Free, method: Method) -> Result<Solution, FitError> {
    let name = if method == Method::Kronecker { "kronecker" } else { "pcg" };
    let refuse = |why| Err(FitError::Method { method: name, why });
    let Observed::Gridded(sites) = &equations.sites else { return refuse("needs a grid") };
    if free.pinned().is_some() {
        return refuse("needs heights: without them use --method auto");
    }
    if !free.is_empty() {
        return refuse("needs data under every coefficient: this grid has gaps, use --method auto");
    }
    let exact = matches!(&equations.row_weights, RowWeights::Uniform(m) if m.b == 0.0) && equations.roughness.is_none();
    if method == Method::Kronecker && !exact {
        return refuse("is exact only for complete grids with one weight per block and no roughness: use pcg or auto");
    }
    let diagonalisation = diagonalise(sites, mean_weights(equations)).map_err(|source| FitError::Solve { source })?;
    let order = matrix.order();
    let (solver, used) = if method == Method::Kronecker {
        (GridSolver::direct(matrix, diagonalisation), MethodUsed::Kronecker)
    } else {
        (GridSolver::iterative(matrix, diagonalisation), MethodUsed::Pcg)
    };
    let mut coefficients = equations.right_side();
    let iterations = solver.solve(&mut coefficients);
    let why = if used == MethodUsed::Kronecker { Reason::CompleteGrid } else { Reason::Iterated { iterations } };
    let mut solution = Solution {
        coefficients,
        factor: Factor::Grid(Box::new(solver)),
        method: used,
        reasons: vec![Reason::Requested, why],
        rank: order,
        unsupported: Vec::new(),
        pinned: None,
        refinements: 0,
        refinement_gain: 1.0,
    };
    refine(equations, &mut solution, free);
    Ok(solution)
}

fn diagonalise(sites: &GridSites, weights: [f64; 3]) -> Result<FastDiagonalisation, crate::solve::SolveError> {
    let [x, y] = sites.axes().each_ref().map(|axis| [axis.gram(0, None), axis.gram(1, None)]);
    FastDiagonalisation::new([&x[0], &x[1]], [&y[0], &y[1]], weights)
}

/// Root mean squared weights of the three blocks over all pixels.
fn mean_weights(equations: &Equations) -> [f64; 3] {
    let squares = match &equations.row_weights {
        RowWeights::Uniform(m) => [m.z * m.z, m.a * m.a, m.d * m.d],
        RowWeights::PerSite(all) => {
            let count = equations.sites.len() as f64;
            all.iter().fold([0.0; 3], |s, m| {
                [s[0] + m.z * m.z / count, s[1] + m.a * m.a / count, s[2] + (m.b * m.b + m.d * m.d) / count]
            })
        }
    };
    squares.map(f64::sqrt)
}
