//! How little the data would have to change for the coefficients to be exact.
//!
//! ```text
//! {r + E c = b, E'r = lambda P c}      backward error   max_i |residual|_i / (|M||v| + |f|)_i     (Oettli and Prager 1964)
//! ```
//!
//! r is a variable of that system. It is made orthogonal to E, because the residual of an exact fit is nothing but rounding
//! and its direction means nothing. Rows whose own terms nearly vanish are measured against `|E_i|_1 max|c|` (M. Arioli,
//! J. Demmel and I. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165), because the plain ratio would compare rounding with
//! rounding. A surface through all data leaves no r: what is computed of it is rounding in every direction, and r = 0 is the better
//! choice. The sizes of the penalty's products are `lambda |P||c|`, because without data P c is a sum that cancels.

use crate::fit::certificate::row_passes::{ColumnTotals, RowPasses};
use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::solved::Solved;
use crate::observation::Roughness;
use palpate_numeric::linalg::{Sites, StencilMatrix};
use palpate_numeric::simd::{RowSums, add_lanes};

/// A ratio above this is computed again with the rows' norms: only rows of rounding have one so large.
const SUSPICIOUS: f64 = 1e-13;
/// Arioli, Demmel and Duff: denominators below this many roundings of the row's norm are replaced by it.
const TINY: f64 = 1e3 * f64::EPSILON;
/// The first correction of r has a relative error of condition^2 u; above this condition a second one is worth its cost.
const CORRECT_TWICE: f64 = 1e4;

/// The backward error and the sizes it is relative to.
#[derive(Debug)]
pub(crate) struct Backward {
    /// Largest relative change of a datum.
    pub error: f64,
    /// `| |E||c| + |r| + |b| |_2`, by which a relative change of the rows moves them.
    pub rows: f64,
    /// `|r|_2`.
    pub residual: f64,
    /// Largest share of the roughness in a diagonal entry of the normal matrix.
    pub rough_share: f64,
    /// `lambda |P||c|`, which the rounding of P is a share of; empty without roughness.
    pub roughness: Vec<f64>,
    /// `|E|'|r| + lambda |P||c|`, by which it moves the normal equations, and the squared norms of the columns of E and of the
    /// penalty's rows.
    pub columns: Vec<ColumnTotals>,
}

/// The backward error of a fit: two visits of the rows, three where r is corrected twice.
pub(super) fn backward(solved: &Solved) -> Backward {
    let (equations, solution) = (&solved.fitted.equations, &solved.fitted.solution);
    let c = &solution.coefficients;
    let penalty = equations.roughness.as_ref().map(|Roughness { lambda, penalty: p, .. }| {
        let mut bent = vec![0.0; c.len()];
        p.multiply(c, &mut bent);
        bent.iter_mut().for_each(|b| *b *= lambda);
        bent
    });
    let mut passes = RowPasses::new(equations, c);
    let (mut columns, mut rows) = (vec![ColumnTotals::default(); c.len()], RowSums::default());
    let v = span(&mut passes, solution, penalty.as_deref(), solved.condition(), &mut columns);
    passes.last(&v, &mut columns, &mut rows);
    match solution.column_scales(equations) {
        Some(scales) => columns.iter_mut().zip(scales).for_each(|(column, d)| column.norm = 1.0 / (d * d)),
        None => passes.norms(&mut columns),
    }
    // the penalty is rows like those of the data: the condition is that of both, and so are residual and columns
    let roughness = equations.roughness.as_ref().map_or_else(Vec::new, |rough| sizes(rough.lambda, &rough.penalty, c));
    columns.iter_mut().zip(&roughness).for_each(|(column, size)| column.size += size);
    let (bent, rough_share) = add_roughness(equations, c, penalty.as_deref(), &mut columns);
    let worst = rows.worst.iter().fold(0.0, |m: f64, v| m.max(*v));
    let of_columns = orthogonality(solution, &columns, penalty.as_deref());
    let of_rows = if worst <= SUSPICIOUS {
        worst
    } else {
        passes.against_norms(&v, c.iter().fold(0.0_f64, |m, v| m.max(v.abs())), TINY)
    };
    let error = of_rows.max(of_columns);
    let through_all = error > SUSPICIOUS && roughness.is_empty();
    Backward {
        error: if through_all { error.min(without_residual(equations, c)) } else { error },
        rows: add_lanes(&rows.sizes).sqrt(),
        residual: (add_lanes(&rows.residual) + bent).sqrt(),
        rough_share,
        roughness,
        columns,
    }
}

/// `lambda |P||c|`.
fn sizes(lambda: f64, p: &StencilMatrix, c: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; c.len()];
    p.for_each_lower(|row, column, position| {
        let entry = lambda * p.values()[position].abs();
        out[row] += entry * c[column].abs();
        if row != column {
            out[column] += entry * c[row].abs();
        }
    });
    out
}

/// `lambda c'Pc`, the squares of the penalty's rows, and the largest share that they have in a column's squares; the squared
/// norms of their columns are added to `columns`.
fn add_roughness(
    equations: &Equations,
    c: &[f64],
    penalty: Option<&[f64]>,
    columns: &mut [ColumnTotals],
) -> (f64, f64) {
    let (Some(Roughness { lambda, penalty: p, .. }), Some(bent)) = (&equations.roughness, penalty) else {
        return (0.0, 0.0);
    };
    let mut share = 0.0_f64;
    for (column, d) in columns.iter_mut().zip(p.diagonal()) {
        column.norm += lambda * d;
        share = share.max(lambda * d / column.norm);
    }
    (c.iter().zip(bent).map(|(c, b)| c * b).sum::<f64>().max(0.0), share)
}

/// v, the part of the computed residual in the span of E; `columns` is a buffer for its sums.
fn span(
    passes: &mut RowPasses,
    solution: &Solution,
    penalty: Option<&[f64]>,
    condition: f64,
    columns: &mut [ColumnTotals],
) -> Vec<f64> {
    let mut step = |v: &[f64]| {
        passes.products(v, columns);
        let mut step = products(solution, columns, penalty);
        solution.factor.solve(&mut step);
        solution.clear_free(&mut step);
        step
    };
    let mut v = step(&[]);
    if condition > CORRECT_TWICE {
        let again = step(&v);
        v.iter_mut().zip(&again).for_each(|(v, d)| *v += d);
    }
    v
}

/// `E'r - lambda P c` over the determined columns, 0 in the others.
fn products(solution: &Solution, sums: &[ColumnTotals], penalty: Option<&[f64]>) -> Vec<f64> {
    let mut out: Vec<f64> = (0..sums.len()).map(|u| product(sums, penalty, u)).collect();
    solution.clear_free(&mut out);
    out
}

/// `(E'r - lambda P c)_u`.
fn product(sums: &[ColumnTotals], penalty: Option<&[f64]>, u: usize) -> f64 {
    sums[u].product - penalty.map_or(0.0, |bent| bent[u])
}

/// `max_j |E'r - lambda P c|_j / (|E|'|r| + lambda |P||c|)_j` over the determined columns, whose sizes hold the penalty's.
fn orthogonality(solution: &Solution, sums: &[ColumnTotals], penalty: Option<&[f64]>) -> f64 {
    let mut worst = 0.0_f64;
    for (u, sum) in sums.iter().enumerate() {
        if sum.size > 0.0 && !solution.is_free(u) {
            worst = worst.max(product(sums, penalty, u).abs() / sum.size);
        }
    }
    worst
}

/// The backward error with r = 0, `max_i |b - E c|_i / (|E||c| + |b|)_i`, rows of rounding measured as in `against_norms`.
fn without_residual(equations: &Equations, c: &[f64]) -> f64 {
    let (columns, largest) = (equations.sites.shape().basis[1], c.iter().fold(0.0_f64, |m, v| m.max(v.abs())));
    let residuals = equations.residuals(c);
    let mut worst = 0.0_f64;
    equations.sites.visit(|site| {
        let w = equations.row_weights.at(site.index);
        let (mut sizes, mut norms) = (equations.targets[site.index].map(f64::abs), [0.0; 3]);
        for (a, (n, dn)) in site.x.iter().zip(site.dx).enumerate() {
            let first = (site.first[0] + a) * columns + site.first[1];
            for ((m, dm), c) in site.y.iter().zip(site.dy).zip(&c[first..]) {
                let entries = [w.z * n * m, w.a * dn * m + w.b * n * dm, w.d * n * dm];
                for (k, entry) in entries.into_iter().enumerate() {
                    sizes[k] += entry.abs() * c.abs();
                    norms[k] += entry.abs() * largest;
                }
            }
        }
        for (k, residual) in residuals[site.index].into_iter().enumerate() {
            let size = if sizes[k] < TINY * norms[k] { sizes[k] + norms[k] } else { sizes[k] };
            if size > 0.0 {
                worst = worst.max(residual.abs() / size);
            }
        }
    });
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Objective, SlopeWeights, Smooth, fit_contacts};
    use crate::observation::to_csr;
    use palpate_geometry::contact::Contacts;

    /// The sizes of the columns are those of data and penalty together, as the rows say one by one, and the penalty's largest
    /// share is what it is in the normal matrix, which is assembled another way.
    #[test]
    fn a_penalty_counts_as_rows_of_its_own() {
        let at = |r: usize, step: f64| (r as f64 * step).fract();
        let (x, y): (Vec<f64>, Vec<f64>) = (0..60).map(|r| (at(r, 0.754_877_666), at(r, 0.569_840_291))).unzip();
        let z = x.iter().zip(&y).map(|(x, y)| x * x - 0.3 * y).collect();
        let lambda = 0.037;
        let options = FitOptions {
            degree: [3, 3],
            segments: [2, 2],
            objective: Objective::Slopes(SlopeWeights::Equal),
            smooth: Smooth::Lambda(lambda),
            ..FitOptions::default()
        };
        let fit = fit_contacts(&Contacts::from_positions(x, y, z), &options).unwrap();
        let found = backward(&fit.solved);
        let (whole, data) = (fit.equations().normal_matrix().diagonal(), fit.equations().with_roughness(None));
        let mut share = 0.0_f64;
        for ((column, whole), data) in found.columns.iter().zip(&whole).zip(data.normal_matrix().diagonal()) {
            assert!((column.norm - whole).abs() <= 1e-12 * whole, "{} for {whole}", column.norm);
            share = share.max((whole - data) / whole);
        }
        assert!(share > 0.01, "the penalty is felt: {share}");
        let (equations, c) = (fit.equations(), &fit.solution().coefficients);
        let (rows, residuals) = (to_csr(&equations.sites, &equations.row_weights), equations.residuals(c));
        let mut sizes = sizes(lambda, &equations.roughness.as_ref().unwrap().penalty, c);
        for (r, row) in rows.row_iter().enumerate() {
            let residual = residuals[r / 3][r % 3].abs();
            row.col_indices().iter().zip(row.values()).for_each(|(&u, e)| sizes[u] += e.abs() * residual);
        }
        for (column, size) in found.columns.iter().zip(&sizes) {
            assert!((column.size - size).abs() <= 1e-9 * size, "{} for {size}", column.size);
        }
        assert!((found.rough_share - share).abs() <= 1e-10, "{} for {share}", found.rough_share);
        assert!(found.error < 1e-14, "{:e}", found.error);
    }

    /// Nine heights fix nine coefficients: no residual is left, and what is computed of it says nothing.
    #[test]
    fn a_surface_through_all_heights_has_a_backward_error_of_rounding() {
        let (x, y): (Vec<f64>, Vec<f64>) = (0..9).map(|r| ((r / 3) as f64, (r % 3) as f64)).unzip();
        let z = vec![0.3, 7.1, 8.2, 3.0, 4.4, 7.0, 1.9, 3.0, 4.7];
        let objective = Objective::Slopes(SlopeWeights::Explicit([1.0; 3]));
        let options = FitOptions { objective, ..FitOptions::default() };
        let mut fit = fit_contacts(&Contacts::from_positions(x, y, z), &options).unwrap();
        let found = backward(&fit.solved).error;
        assert!(found < 1e-15, "{found:e}");
        assert!(fit.certificate().digits_of_coefficients > 13.0);
        // a coefficient that is off is an error of its size, over the terms of the rows as they are written down elsewhere
        fit.solved.fitted.solution.coefficients[4] += 1e-6;
        let (equations, c) = (fit.equations(), &fit.solution().coefficients);
        let (rows, residuals) = (to_csr(&equations.sites, &equations.row_weights), equations.residuals(c));
        let ratio = |r: usize| {
            let row = rows.row(r);
            let terms = row.col_indices().iter().zip(row.values()).map(|(&u, e)| (e * c[u]).abs()).sum::<f64>();
            let (residual, target) = (residuals[r / 3][r % 3], equations.targets[r / 3][r % 3]);
            if row.nnz() > 0 { residual.abs() / (terms + target.abs()) } else { 0.0 }
        };
        let expected = (0..rows.nrows()).map(ratio).fold(0.0, f64::max);
        let off = without_residual(equations, c);
        assert!(expected > 1e-8 && (off - expected).abs() <= 1e-9 * expected, "{off:e} for {expected:e}");
    }

    /// A contact on the rim sees one coefficient alone; where that is rounding, so are all terms of the row.
    #[test]
    fn a_row_of_nothing_is_measured_by_its_norm() {
        let (x, y): (Vec<f64>, Vec<f64>) = (0..9).map(|r| ((r / 3) as f64, (r % 3) as f64)).unzip();
        let z = vec![0.3, 7.1, 8.2, 3.0, 4.4, 7.0, 1.9, 3.0, 4.7];
        let objective = Objective::Slopes(SlopeWeights::Explicit([1.0, 0.0, 0.0]));
        let options = FitOptions { objective, ..FitOptions::default() };
        let fit = fit_contacts(&Contacts::from_positions(x, y, z), &options).unwrap();
        let (mut equations, mut c) = (fit.equations().clone(), fit.solution().coefficients.clone());
        c[0] = 1e-18;
        let left = equations.residuals(&c);
        equations.targets.iter_mut().zip(&left).for_each(|(target, left)| target[0] -= left[0]);
        equations.targets[0][0] = 0.0;
        let found = without_residual(&equations, &c);
        assert!(found < 1e-15, "{found:e}");
    }

    /// Without data near it a coefficient has a sum of the penalty that cancels: its rounding is no backward error of one.
    #[test]
    fn a_penalty_over_a_gap_has_a_backward_error_of_rounding() {
        let at = |r: usize, step: f64| (r as f64 * step).fract();
        let places = (0..300).map(|r| (at(r, 0.754_877_666), at(r, 0.569_840_291)));
        let (x, y): (Vec<f64>, Vec<f64>) = places.filter(|(x, y)| (x - 0.5).hypot(y - 0.5) > 0.4).unzip();
        let z = x.iter().zip(&y).map(|(x, y)| (3.0 * x).sin() * y).collect();
        let options = FitOptions {
            degree: [3, 3],
            segments: [8, 8],
            objective: Objective::Slopes(SlopeWeights::Equal),
            smooth: Smooth::Lambda(1e-5),
            ..FitOptions::default()
        };
        let fit = fit_contacts(&Contacts::from_positions(x, y, z), &options).unwrap();
        let found = backward(&fit.solved);
        assert!(found.columns.iter().zip(&found.roughness).any(|(column, rough)| column.size <= *rough), "a gap");
        assert!(found.error < 1e-14, "{:e}", found.error);
        let promised = fit.certificate().digits_of_coefficients;
        assert!(promised > 9.0, "{promised}");
    }
}
