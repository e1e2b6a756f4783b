//! How far to trust the numbers of a fit.
//!
//! ```text
//! condition        |E D|_1 |(E D)^+|_1, D the columns' inverse norms; root of the estimate for D E'E D, or R's
//! backward error   max |residual|_i / (|M||v| + |f|)_i of  {r + E c = b, E'r = 0}   (Oettli and Prager 1964)
//! ```
//!
//! r is a variable of that system: it is taken orthogonal to E, so an exact fit is judged by its rounding and not by
//! the direction of a residual that is nothing but rounding.

use super::{Fit, MethodUsed, Reason};
use crate::linalg::{Sites, Targets, apply_rows, magnitudes};

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
    Certificate {
        method: solution.method,
        reasons: solution.reasons.clone(),
        equations: fit.fitted.equations.count(),
        unknowns: fit.fitted.equations.unknowns(),
        rank: solution.rank,
        condition: solution.factor.condition(),
        backward_error: backward_error(fit),
        unsupported: solution.unsupported.clone(),
        refinements: solution.refinements,
        refinement_gain: solution.refinement_gain,
    }
}

fn backward_error(fit: &Fit) -> f64 {
    let equations = &fit.fitted.equations;
    let solution = &fit.fitted.solution;
    let c = &solution.coefficients;
    let held = |v: &mut [f64]| solution.unsupported.iter().for_each(|&u| v[u] = 0.0);
    let computed = equations.residuals(c);
    let penalty = equations.roughness.as_ref().map(|(lambda, p)| {
        let mut bent = vec![0.0; c.len()];
        p.multiply(c, &mut bent);
        bent.iter_mut().for_each(|b| *b *= lambda);
        bent
    });
    let mut r = computed.clone();
    let mut moved = Targets::new();
    // twice: the first correction is itself only accurate to condition^2 u
    for _ in 0..2 {
        let mut delta = equations.transposed(&r);
        if let Some(bent) = &penalty {
            delta.iter_mut().zip(bent).for_each(|(d, b)| *d -= b);
        }
        held(&mut delta);
        solution.factor.solve(&mut delta);
        apply_rows(&equations.sites, &equations.metric, &delta, &mut moved);
        r.iter_mut().zip(&moved).for_each(|(a, m)| (0..3).for_each(|k| a[k] -= m[k]));
    }
    let mut size = Targets::new();
    magnitudes(&equations.sites, &equations.metric, c, &mut size);
    let mut worst = 0.0_f64;
    for site in 0..r.len() {
        for k in 0..3 {
            let gap = (computed[site][k] - r[site][k]).abs();
            let scale = size[site][k] + r[site][k].abs() + equations.targets[site][k].abs();
            if gap > 0.0 && scale > 0.0 {
                worst = worst.max(gap / scale);
            }
        }
    }
    worst.max(orthogonality(fit, &r, penalty.as_deref()))
}

/// `max_j |E'r - lambda P c|_j / (|E|'|r| + |lambda P c|)_j` over the determined columns.
fn orthogonality(fit: &Fit, r: &Targets, penalty: Option<&[f64]>) -> f64 {
    let equations = &fit.fitted.equations;
    let mut products = equations.transposed(r);
    let columns = equations.sites.shape().basis[1];
    let mut sizes = vec![0.0; products.len()];
    equations.sites.visit(|site| {
        let m = equations.metric.at(site.index);
        let v = r[site.index].map(f64::abs);
        for a in 0..site.x.len() {
            for b in 0..site.y.len() {
                let value = (m.z * site.x[a] * site.y[b]).abs() * v[0]
                    + (m.a * site.dx[a] * site.y[b] + m.b * site.x[a] * site.dy[b]).abs() * v[1]
                    + (m.d * site.x[a] * site.dy[b]).abs() * v[2];
                sizes[(site.first[0] + a) * columns + site.first[1] + b] += value;
            }
        }
    });
    if let Some(bent) = penalty {
        for (u, b) in bent.iter().enumerate() {
            products[u] -= b;
            sizes[u] += b.abs();
        }
    }
    fit.fitted.solution.unsupported.iter().for_each(|&u| products[u] = 0.0);
    products.iter().zip(&sizes).filter(|(_, s)| **s > 0.0).fold(0.0, |m, (p, s)| m.max(p.abs() / s))
}
