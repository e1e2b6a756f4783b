//! Uncertainty of a linear functional `g'c` by the delta method, from the rows themselves:
//!
//! ```text
//! v = (E'E + lambda P)^-1 g        u^2 = sum_b s_b^2 |E_b v|^2       b = heights, slopes
//! ```
//!
//! With rows of unit variance this is `g'(E'E)^-1 g`. Preset weights are not inverse noise sds; then the variances `s_b^2`
//! of the residuals take their place (a sandwich estimator), so the answer does not rest on the weights.

use crate::fit::solved::Solved;

/// Standard uncertainty of `g'c`.
pub(super) fn standard_uncertainty(solved: &Solved, gradient: &[f64]) -> f64 {
    let fitted = &solved.fitted;
    let mut v = gradient.to_vec();
    fitted.solution.clear_free(&mut v);
    fitted.solution.factor.solve(&mut v);
    let squares = fitted.equations.row_squares(&v);
    let [heights, slopes] = solved.noise().row_variances;
    (heights * squares[0] + slopes * squares[1]).sqrt()
}
