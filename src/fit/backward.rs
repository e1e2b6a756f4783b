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
use crate::linalg::{RowMetric, Site, Sites, Targets, add_transposed, site_magnitudes, site_rows};

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
    /// Squared norms of E's columns.
    pub norms: Vec<f64>,
}

/// What one visit of the rows with the final r adds up.
struct Sums {
    /// `E'r`.
    products: Vec<f64>,
    /// `|E|'|r|`.
    sizes: Vec<f64>,
    /// Squared column norms.
    norms: Vec<f64>,
}

/// The backward error of a fit with this condition: two visits of the rows, three where r is corrected twice.
pub fn backward(fit: &Fit, condition: f64) -> Backward {
    let (equations, solution) = (&fit.fitted.equations, &fit.fitted.solution);
    let c = &solution.coefficients;
    let penalty = equations.roughness.as_ref().map(|(lambda, p)| {
        let mut bent = vec![0.0; c.len()];
        p.multiply(c, &mut bent);
        bent.iter_mut().for_each(|b| *b *= lambda);
        bent
    });
    let columns = equations.sites.shape().basis[1];
    let (mut computed, mut sizes) = (vec![[0.0; 3]; equations.sites.len()], vec![[0.0; 3]; equations.sites.len()]);
    let mut descent = vec![0.0; c.len()];
    // in the order of the visit, in which all that follows goes from front to back
    let mut places = computed.iter_mut().zip(&mut sizes);
    equations.sites.visit(|site| {
        let Some((computed, size)) = places.next() else { return };
        let m = equations.metric.at(site.index);
        let (rows, target) = (site_rows(site, &m, c, columns), equations.targets[site.index]);
        let magnitudes = site_magnitudes(site, &m, c, columns);
        *computed = [0, 1, 2].map(|k| target[k] - rows[k]);
        *size = [0, 1, 2].map(|k| magnitudes[k] + target[k].abs());
        add_transposed(site, &m, *computed, columns, &mut descent);
    });
    let (r, sums) = orthogonal(equations, solution, &computed, descent, penalty.as_deref(), condition);
    let (mut rows, mut residual, mut plain) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ((size, r), computed) in sizes.iter_mut().zip(&r).zip(&computed) {
        for k in 0..3 {
            size[k] += r[k].abs();
            rows += size[k] * size[k];
            residual += r[k] * r[k];
            plain = larger_ratio(plain, (computed[k] - r[k]).abs(), size[k]);
        }
    }
    let of_rows = if plain <= SUSPICIOUS { plain } else { row_error(equations, c, &computed, &r, &sizes) };
    let error = of_rows.max(orthogonality(solution, &sums, penalty.as_deref()));
    Backward { error, rows: rows.sqrt(), columns: sums.sizes, residual: residual.sqrt(), norms: sums.norms }
}

/// The residual less its part in the span of E, and what it adds up to; `descent` is `E'` times the residual.
fn orthogonal(
    equations: &Equations,
    solution: &Solution,
    computed: &Targets,
    mut descent: Vec<f64>,
    penalty: Option<&[f64]>,
    condition: f64,
) -> (Targets, Sums) {
    let columns = equations.sites.shape().basis[1];
    let mut r = computed.clone();
    let zeros = || vec![0.0; descent.len()];
    let mut sums = Sums { products: zeros(), sizes: zeros(), norms: zeros() };
    let last = if condition > CORRECT_TWICE { 1 } else { 0 };
    for turn in 0..=last {
        if let Some(bent) = penalty {
            descent.iter_mut().zip(bent).for_each(|(d, b)| *d -= b);
        }
        solution.clear_free(&mut descent);
        solution.factor.solve(&mut descent);
        solution.clear_free(&mut descent);
        let mut places = r.iter_mut();
        equations.sites.visit(|site| {
            let Some(r) = places.next() else { return };
            let m = equations.metric.at(site.index);
            let moved = site_rows(site, &m, &descent, columns);
            (0..3).for_each(|k| r[k] -= moved[k]);
            add_transposed(site, &m, *r, columns, &mut sums.products);
            if turn == last {
                add_sizes(site, &m, r.map(f64::abs), columns, &mut sums);
            }
        });
        if turn < last {
            descent.copy_from_slice(&sums.products);
            sums.products.fill(0.0);
        }
    }
    (r, sums)
}

/// `sizes += |E_site|'|r|`, `norms += ` squares of the rows.
#[inline]
fn add_sizes(site: &Site, m: &RowMetric, r: [f64; 3], columns: usize, sums: &mut Sums) {
    site.unrolled(|site| add_sizes_of(site, m, r, columns, sums));
}

#[inline(always)]
fn add_sizes_of(site: &Site, m: &RowMetric, r: [f64; 3], columns: usize, sums: &mut Sums) {
    // |a N' M + b N M'| is bounded by its two terms; b is zero but for normal rows
    let (value, slope_x, slope_y) = (m.z.abs() * r[0], m.a.abs() * r[1], m.b.abs() * r[1] + m.d.abs() * r[2]);
    for a in 0..site.x.len() {
        let start = (site.first[0] + a) * columns + site.first[1];
        let (x, dx) = (site.x[a], site.dx[a]);
        let (along, across) = (value * x.abs() + slope_x * dx.abs(), slope_y * x.abs());
        let range = start..start + site.y.len();
        let (sizes, norms) = (&mut sums.sizes[range.clone()], &mut sums.norms[range]);
        for b in 0..site.y.len() {
            let (y, dy) = (site.y[b], site.dy[b]);
            sizes[b] += along * y.abs() + across * dy.abs();
            let rows = [m.z * x * y, m.a * dx * y + m.b * x * dy, m.d * x * dy];
            norms[b] += rows[0] * rows[0] + rows[1] * rows[1] + rows[2] * rows[2];
        }
    }
}

/// The larger of `worst` and `gap / size`; divides only where it is that.
#[inline]
fn larger_ratio(worst: f64, gap: f64, size: f64) -> f64 {
    if gap > worst * size { gap / size } else { worst }
}

/// `max_i |r - (b - E c)|_i / (|E||c| + |r| + |b|)_i` with the rows' norms where those sizes are next to nothing.
fn row_error(equations: &Equations, c: &[f64], computed: &Targets, r: &Targets, sizes: &Targets) -> f64 {
    let largest = vec![c.iter().fold(0.0_f64, |m, v| m.max(v.abs())); c.len()];
    let columns = equations.sites.shape().basis[1];
    let mut places = computed.iter().zip(r).zip(sizes);
    let mut worst = 0.0;
    equations.sites.visit(|site| {
        let Some(((computed, r), sizes)) = places.next() else { return };
        let norms = site_magnitudes(site, &equations.metric.at(site.index), &largest, columns);
        for k in 0..3 {
            let size = if sizes[k] < TINY * norms[k] { sizes[k] + norms[k] } else { sizes[k] };
            worst = larger_ratio(worst, (computed[k] - r[k]).abs(), size);
        }
    });
    worst
}

/// `max_j |E'r - lambda P c|_j / (|E|'|r| + |lambda P c|)_j` over the determined columns.
fn orthogonality(solution: &Solution, sums: &Sums, penalty: Option<&[f64]>) -> f64 {
    let mut products = sums.products.clone();
    if let Some(bent) = penalty {
        products.iter_mut().zip(bent).for_each(|(p, b)| *p -= b);
    }
    solution.clear_free(&mut products);
    let size = |u: usize| sums.sizes[u] + penalty.map_or(0.0, |bent| bent[u].abs());
    let ratios = products.iter().enumerate().filter(|(u, _)| size(*u) > 0.0).map(|(u, p)| p.abs() / size(u));
    ratios.fold(0.0, f64::max)
}
