//! Grids solved by their two Kronecker factors: directly where that is exact, by conjugate gradients elsewhere.
//!
//! Exact: every pixel measured, one weight per block, slope rows, no roughness. Then `A^-1` needs two small eigenproblems
//! and four matrix products; elsewhere the same factors, with mean weights, are the preconditioner.

use crate::fit::FitError;
use crate::fit::linear::equations::Equations;
use crate::fit::linear::free_unknowns::Free;
use crate::fit::linear::reasons::Reason;
use crate::fit::linear::refinement::refine;
use crate::fit::linear::solution::Solution;
use crate::fit::options::method::MethodUsed;
use crate::fit::placing::sites::DataSites;
use crate::observation::GridSites;
use palpate_numeric::linalg::{RowWeights, Sites, StencilMatrix};
use palpate_numeric::solve::{FastDiagonalisation, GridSolver};

/// What the two factors are used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GridMethod {
    /// `kronecker`: they give the answer.
    Direct,
    /// `pcg`: they precondition conjugate gradients.
    Iterative,
}

/// Solves a grid's problem by `kronecker` or `pcg`.
///
/// # Errors
/// [`FitError::Method`] where the data or the weights are not what the method needs.
pub(super) fn solve(
    equations: &Equations,
    matrix: StencilMatrix,
    free: &Free,
    method: GridMethod,
) -> Result<Solution, FitError> {
    let used = match method {
        GridMethod::Direct => MethodUsed::Kronecker,
        GridMethod::Iterative => MethodUsed::Pcg,
    };
    let refuse = |why| Err(FitError::Method { method: used.name(), why });
    let DataSites::Gridded(sites) = &equations.sites else { return refuse("needs a grid") };
    if free.pinned().is_some() {
        return refuse("needs heights: without them use method = auto");
    }
    if !free.is_empty() {
        return refuse("needs data under every coefficient: this grid has gaps, use method = auto");
    }
    let exact = matches!(&equations.row_weights, RowWeights::Uniform(m) if m.b == 0.0) && equations.roughness.is_none();
    if method == GridMethod::Direct && !exact {
        return refuse("is exact only for complete grids with one weight per block and no roughness: use pcg or auto");
    }
    let diagonalisation = diagonalise(sites, mean_weights(equations)).map_err(|source| FitError::Solve { source })?;
    let order = matrix.order();
    let solver = match method {
        GridMethod::Direct => GridSolver::direct(matrix, diagonalisation),
        GridMethod::Iterative => GridSolver::iterative(matrix, diagonalisation),
    };
    let mut coefficients = equations.right_side();
    let iterations = solver.solve(&mut coefficients);
    let why = match method {
        GridMethod::Direct => Reason::CompleteGrid,
        GridMethod::Iterative => Reason::Iterated { iterations },
    };
    let mut solution = Solution::unrefined(coefficients, solver, used, vec![Reason::Requested, why], order);
    refine(equations, &mut solution, free);
    Ok(solution)
}

fn diagonalise(
    sites: &GridSites,
    weights: [f64; 3],
) -> Result<FastDiagonalisation, palpate_numeric::solve::SolveError> {
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
