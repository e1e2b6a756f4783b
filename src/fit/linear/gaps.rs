//! Gaps: free coefficients take the values of least roughness, given the others.
//!
//! ```text
//! P_FF c_F = -P_FD c_D        (roughness, by elimination: no small lambda)
//! A_DD c_D = E_D'(b - E_F c_F)
//! ```
//!
//! The two are solved alternately. So few data reach F that a handful of alternations settles both.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::free::Free;
use crate::fit::linear::reasons::Reason;
use crate::fit::linear::solution::Solution;
use crate::linalg::{RowWeights, SiteWeights, apply_rows};
use crate::observation::roughness_matrix;
use crate::solve::{Cholesky, SolveError};

/// Alternations of the two solves at most; nearly free columns couple by less than 0.05^2, so 12 reach rounding.
const MAX_ALTERNATIONS: usize = 40;

/// Solves for the held unknowns by `solution.factor` (of the masked matrix) and for the free ones by least roughness.
///
/// # Errors
/// Where least roughness does not determine the free unknowns.
pub(super) fn solve_with_gaps(equations: &Equations, solution: &mut Solution, free: &Free) -> Result<(), SolveError> {
    if free.count() == 0 {
        let mut c = equations.right_side();
        free.clear(&mut c);
        solution.factor.solve(&mut c);
        solution.coefficients = c;
        return Ok(());
    }
    solution.reasons.push(Reason::Gap { coefficients: free.count() });
    let penalty = roughness_matrix(&equations.sites.knots());
    let mut smooth = Cholesky::plan(penalty.shape())?;
    smooth.factor(&free.keep(&penalty))?;
    let mut bent = vec![0.0; solution.coefficients.len()];
    for alternation in 0..MAX_ALTERNATIONS {
        let before = solution.coefficients.clone();
        let mut step = equations.descent(&solution.coefficients);
        free.clear(&mut step);
        solution.factor.solve(&mut step);
        solution.coefficients.iter_mut().zip(&step).for_each(|(c, d)| *c += d);
        let mut held = solution.coefficients.clone();
        free.clear(&mut held);
        penalty.multiply(&held, &mut bent);
        for (u, b) in bent.iter_mut().enumerate() {
            *b = if free.has(u) { -*b } else { 0.0 };
        }
        smooth.solve(&mut bent);
        for (u, b) in bent.iter().enumerate() {
            if free.has(u) {
                solution.coefficients[u] = *b;
            }
        }
        let largest = solution.coefficients.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let moved = before.iter().zip(&solution.coefficients).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        if alternation > 0 && moved <= 4.0 * f64::EPSILON * largest {
            break;
        }
    }
    Ok(())
}

/// Moves the surface up or down until its mean height over the sites with slopes is zero, which changes no residual.
pub(super) fn centre_heights(equations: &Equations, c: &mut [f64]) {
    let mut rows = Vec::new();
    let heights = RowWeights::Uniform(SiteWeights { z: 1.0, ..SiteWeights::default() });
    apply_rows(&equations.sites, &heights, c, &mut rows);
    let has_slope = |r: usize| {
        let m = equations.row_weights.at(r);
        m.a != 0.0 || m.d != 0.0
    };
    let met: Vec<f64> = (0..rows.len()).filter(|&r| has_slope(r)).map(|r| rows[r][0]).collect();
    let mean = met.iter().sum::<f64>() / met.len().max(1) as f64;
    c.iter_mut().for_each(|c| *c -= mean);
}
