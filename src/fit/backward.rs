//! How little the data would have to change for the coefficients to be exact.
//!
//! ```text
//! {r + E c = b, E'r = 0}      backward error   max_i |residual|_i / (|M||v| + |f|)_i     (Oettli and Prager 1964)
//! ```
//!
//! r is a variable of that system: it is taken orthogonal to E, so an exact fit is judged by its rounding and not by
//! the direction of a residual that is nothing but rounding. Rows whose own terms are all but zero are measured against
//! `|E_i|_1 max|c|` (M. Arioli, J. Demmel and I. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165), for there the plain
//! ratio compares rounding with rounding.

use super::{Equations, Fit, Solution};
use crate::linalg::{Sites, Targets, apply_rows, magnitudes};

/// A ratio above this is looked at again with the rows' norms: no row that solves anything is off by so much.
const SUSPICIOUS: f64 = 1e-13;
/// Arioli, Demmel and Duff: denominators below this many roundings of the row's norm are replaced by it.
const TINY: f64 = 1e3 * f64::EPSILON;
/// The first correction of r is itself only accurate to condition^2 u; above this condition a second one is worth its cost.
const CORRECT_TWICE: f64 = 1e4;

/// The backward error and the sizes it is relative to.
#[derive(Debug)]
pub struct Backward {
    /// Largest relative change of a datum.
    pub error: f64,
    /// `| |E||c| + |r| + |b| |_2`, by which a relative change of the rows moves them.
    pub rows: f64,
    /// `|E|'|r|`, by which it moves the normal equations.
    pub columns: Vec<f64>,
    /// `|r|_2`.
    pub residual: f64,
}

/// The backward error of a fit with this condition.
pub fn backward(fit: &Fit, condition: f64) -> Backward {
    let (equations, solution) = (&fit.fitted.equations, &fit.fitted.solution);
    let c = &solution.coefficients;
    let computed = equations.residuals(c);
    let penalty = equations.roughness.as_ref().map(|(lambda, p)| {
        let mut bent = vec![0.0; c.len()];
        p.multiply(c, &mut bent);
        bent.iter_mut().for_each(|b| *b *= lambda);
        bent
    });
    let r = orthogonal(equations, solution, &computed, penalty.as_deref(), condition);
    let mut sizes = Targets::new();
    magnitudes(&equations.sites, &equations.metric, c, &mut sizes);
    let (mut rows, mut residual) = (0.0_f64, 0.0_f64);
    for ((size, r), b) in sizes.iter_mut().zip(&r).zip(&equations.targets) {
        for k in 0..3 {
            size[k] += r[k].abs() + b[k].abs();
            rows += size[k] * size[k];
            residual += r[k] * r[k];
        }
    }
    let columns = column_sizes(equations, &r);
    let error = row_error(equations, c, &computed, &r, &sizes).max(orthogonality(
        equations,
        solution,
        &r,
        &columns,
        penalty.as_deref(),
    ));
    Backward { error, rows: rows.sqrt(), columns, residual: residual.sqrt() }
}

/// The residual less its part in the span of E.
fn orthogonal(
    equations: &Equations,
    solution: &Solution,
    computed: &Targets,
    penalty: Option<&[f64]>,
    condition: f64,
) -> Targets {
    let mut r = computed.clone();
    let mut moved = Targets::new();
    for _ in 0..if condition > CORRECT_TWICE { 2 } else { 1 } {
        let mut delta = equations.transposed(&r);
        if let Some(bent) = penalty {
            delta.iter_mut().zip(bent).for_each(|(d, b)| *d -= b);
        }
        solution.clear_free(&mut delta);
        solution.factor.solve(&mut delta);
        solution.clear_free(&mut delta);
        apply_rows(&equations.sites, &equations.metric, &delta, &mut moved);
        r.iter_mut().zip(&moved).for_each(|(a, m)| (0..3).for_each(|k| a[k] -= m[k]));
    }
    r
}

/// `max_i |r - (b - E c)|_i / (|E||c| + |r| + |b|)_i`.
fn row_error(equations: &Equations, c: &[f64], computed: &Targets, r: &Targets, sizes: &Targets) -> f64 {
    let ratio = |size: &dyn Fn(usize, usize) -> f64| {
        let mut worst = 0.0_f64;
        for site in 0..r.len() {
            for k in 0..3 {
                let gap = (computed[site][k] - r[site][k]).abs();
                if gap > 0.0 {
                    worst = worst.max(gap / size(site, k));
                }
            }
        }
        worst
    };
    let plain = ratio(&|site, k| sizes[site][k]);
    if plain <= SUSPICIOUS {
        return plain;
    }
    let mut norms = Targets::new();
    let largest = c.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    magnitudes(&equations.sites, &equations.metric, &vec![largest; c.len()], &mut norms);
    ratio(&|site, k| {
        let (size, norm) = (sizes[site][k], norms[site][k]);
        if size < TINY * norm { size + norm } else { size }
    })
}

/// `|E|'|r|`.
fn column_sizes(equations: &Equations, r: &Targets) -> Vec<f64> {
    let columns = equations.sites.shape().basis[1];
    let mut sizes = vec![0.0; equations.unknowns()];
    equations.sites.visit(|site| {
        let m = equations.metric.at(site.index);
        let v = r[site.index].map(f64::abs);
        for a in 0..site.x.len() {
            let row = &mut sizes[(site.first[0] + a) * columns + site.first[1]..][..site.y.len()];
            let (n, dn) = (site.x[a].abs(), site.dx[a].abs());
            // |a N' M + b N M'| is bounded by its two terms; b is zero but for normal rows
            let by_value = m.z.abs() * n * v[0] + m.a.abs() * dn * v[1];
            let by_slope = n * (m.b.abs() * v[1] + m.d.abs() * v[2]);
            for ((size, y), dy) in row.iter_mut().zip(site.y).zip(site.dy) {
                *size += by_value * y.abs() + by_slope * dy.abs();
            }
        }
    });
    sizes
}

/// `max_j |E'r - lambda P c|_j / (|E|'|r| + |lambda P c|)_j` over the determined columns.
fn orthogonality(
    equations: &Equations,
    solution: &Solution,
    r: &Targets,
    sizes: &[f64],
    penalty: Option<&[f64]>,
) -> f64 {
    let mut products = equations.transposed(r);
    if let Some(bent) = penalty {
        products.iter_mut().zip(bent).for_each(|(p, b)| *p -= b);
    }
    solution.clear_free(&mut products);
    let size = |u: usize| sizes[u] + penalty.map_or(0.0, |bent| bent[u].abs());
    let ratios = products.iter().enumerate().filter(|(u, _)| size(*u) > 0.0).map(|(u, p)| p.abs() / size(u));
    ratios.fold(0.0, f64::max)
}
