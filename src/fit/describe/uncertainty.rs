//! Uncertainty of a linear functional `g'c` by the delta method, from the rows themselves:
//!
//! ```text
//! v = (E'E + lambda P)^-1 g        u^2 = sum_b s_b^2 |E_b v|^2       b = heights, slopes
//! ```
//!
//! With rows of unit variance this is `g'(E'E)^-1 g`; with presets, whose weights are no noise levels, the blocks'
//! residual variances `s_b^2` stand in (a sandwich), so the answer does not believe the weights.

use crate::fit::Fit;

/// Standard uncertainty of `g'c`.
pub fn functional(fit: &Fit, gradient: &[f64]) -> f64 {
    let fitted = &fit.fitted;
    let mut v = gradient.to_vec();
    fitted.solution.clear_free(&mut v);
    fitted.solution.factor.solve(&mut v);
    let squares = fitted.equations.row_squares(&v);
    let [heights, slopes] = fit.noise().block_variance;
    (heights * squares[0] + slopes * squares[1]).sqrt()
}
