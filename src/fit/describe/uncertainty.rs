//! Uncertainty of a linear functional `g'c` by the delta method, from the rows themselves:
//!
//! ```text
//! v = (E'E + lambda P)^-1 g        u^2 = sum_b s_b^2 |E_b v|^2       b = heights, slopes
//! ```
//!
//! With rows of unit variance this is `g'(E'E)^-1 g`. Preset weights are not inverse noise sds; then the variances `s_b^2`
//! of the residuals take their place (a sandwich estimator), so the answer does not rest on the weights.

use crate::fit::solved::Solved;
use crate::shape::{GridGradients, ShapeMaps, mean_gradients};

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

/// Standard uncertainties of mean S and mean R, and the gradients that they come from.
pub(super) struct Uncertainties {
    /// Gradients of S and R over the grid.
    pub gradients: GridGradients,
    /// Of mean S.
    pub of_shape_index: f64,
    /// Of mean R, 1/length in input units.
    pub of_curvedness: f64,
}

impl Uncertainties {
    /// Over the points of the maps.
    pub(super) fn new(solved: &Solved, local: &ShapeMaps) -> Uncertainties {
        let gradients = GridGradients::new(&solved.surface, &local.rows);
        let of_means = mean_gradients(&solved.surface, local, &gradients);
        // nothing between -1 and 1 has a larger standard deviation
        let of_shape_index = standard_uncertainty(solved, &of_means.shape_index).min(1.0);
        let of_curvedness = standard_uncertainty(solved, &of_means.curvedness) / solved.patch.frame.scale;
        Uncertainties { gradients, of_shape_index, of_curvedness }
    }
}
