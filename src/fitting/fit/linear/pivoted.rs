//! Rank-revealing QR of the rows written out, those of the roughness among them; directions that the data do not determine take least roughness.
//!
//! ```text
//! [E; sqrt(lambda) L] = Q R P, rank r      c <- c + Z t,  (Z'PZ) t = -Z'P c       Z the null space, P the roughness
//! ```

use crate::fit::FitError;
use crate::fit::linear::equations::Equations;
use crate::fit::linear::free_unknowns::Free;
use crate::fit::linear::reasons::Reason;
use crate::fit::linear::solution::Solution;
use crate::fit::options::method::MethodUsed;
use crate::observation::{Roughness, RoughnessOrder, roughness_matrix, roughness_rows, to_csr};
use palpate_numeric::linalg::{Eigen, StencilMatrix, dot, eigen};
use palpate_numeric::solve::PivotedQr;

/// Solves by rank-revealing QR; `reasons` are those that led here.
///
/// # Errors
/// [`FitError::Solve`] where the rows have no such factor.
pub(super) fn by_pivoted_qr(
    equations: &Equations,
    mut reasons: Vec<Reason>,
    free: &Free,
) -> Result<Solution, FitError> {
    let unknowns = equations.unknowns();
    let factor = factor_rows(equations, free)?;
    let mut coefficients = factor.coefficients();
    let mut unsupported = free.list();
    let rank = factor.rank();
    if rank < unknowns {
        if !reasons.iter().any(|r| matches!(r, Reason::RankDeficient { .. })) {
            reasons.push(Reason::RankDeficient { rank });
        }
        let null_space = factor.null_space();
        unsupported.extend(moved_by(&null_space));
        smooth_along(
            &roughness_matrix(&equations.sites.knots(), RoughnessOrder::Second.terms()),
            &null_space,
            &mut coefficients,
        )?;
    }
    unsupported.sort_unstable();
    unsupported.dedup();
    let solution = Solution::unrefined(coefficients, factor, MethodUsed::PivotedQr, reasons, rank);
    Ok(Solution { unsupported, ..solution })
}

/// The dense rows that are not empty, factored.
fn factor_rows(equations: &Equations, free: &Free) -> Result<PivotedQr, FitError> {
    let e = to_csr(&equations.sites, &equations.row_weights);
    let unknowns = equations.unknowns();
    let filled: Vec<usize> = (0..e.nrows()).filter(|&r| e.row(r).nnz() > 0).collect();
    // slope rows do not see the constant: a row of its own sets the sum of the coefficients to zero
    let constant = free.pinned().is_some();
    let rows_of = |rough: &Roughness| (rough.lambda.sqrt(), roughness_rows(&equations.sites.knots(), &rough.terms));
    let rough = equations.roughness.as_ref().map(rows_of);
    let bends = rough.as_ref().map_or(0, |(_, bends)| bends.len());
    let rows = filled.len() + bends + usize::from(constant);
    let mut values = vec![0.0; rows * unknowns];
    let mut rhs = vec![0.0; rows];
    for (k, &r) in filled.iter().enumerate() {
        let row = e.row(r);
        for (column, value) in row.col_indices().iter().zip(row.values()) {
            values[column * rows + k] = *value;
        }
        rhs[k] = equations.targets[r / 3][r % 3];
    }
    if let Some((root, bends)) = &rough {
        for (k, bend) in bends.iter().enumerate() {
            bend.iter().enumerate().for_each(|(column, v)| values[column * rows + filled.len() + k] = root * v);
        }
    }
    if constant {
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        (0..unknowns).for_each(|column| values[column * rows + rows - 1] = largest);
    }
    PivotedQr::of_dense(rows, unknowns, &values, &rhs).map_err(|source| FitError::Solve { source })
}

/// Unknowns that any of these directions moves by more than rounding.
fn moved_by(directions: &[Vec<f64>]) -> Vec<usize> {
    let mut list = Vec::new();
    for z in directions {
        let largest = z.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        list.extend((0..z.len()).filter(|&u| z[u].abs() > 1e-10 * largest));
    }
    list
}

/// Moves `c` along the columns of Z to least roughness: `(Z'PZ) t = -Z'P c`, `c += Z t`.
fn smooth_along(penalty: &StencilMatrix, directions: &[Vec<f64>], c: &mut [f64]) -> Result<(), FitError> {
    let count = directions.len();
    let mut bent = vec![0.0; c.len()];
    let mut matrix = faer::Mat::<f64>::zeros(count, count);
    let mut rhs = faer::Mat::<f64>::zeros(count, 1);
    for k in 0..count {
        penalty.multiply(&directions[k], &mut bent);
        (0..count).for_each(|l| matrix[(l, k)] = dot(&directions[l], &bent));
        rhs[(k, 0)] = -dot(c, &bent);
    }
    // planes have no roughness: the eigendecomposition leaves coefficients along such directions as they are
    let no_eigenvalues = FitError::Rank { rank: c.len() - count, unknowns: c.len() };
    let Eigen { values, vectors } = eigen(matrix.as_ref()).ok_or(no_eigenvalues)?;
    let largest = (0..count).fold(0.0_f64, |m, k| m.max(values[k].abs()));
    for k in 0..count {
        if values[k] <= 1e-12 * largest {
            continue;
        }
        let along: f64 = (0..count).map(|l| vectors[(l, k)] * rhs[(l, 0)]).sum::<f64>() / values[k];
        for (l, direction) in directions.iter().enumerate() {
            let step = along * vectors[(l, k)];
            c.iter_mut().zip(direction).for_each(|(c, z)| *c += step * z);
        }
    }
    Ok(())
}
