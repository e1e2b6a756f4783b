//! Uncertainty of a linear functional `g'c` by the delta method, from the rows themselves:
//!
//! ```text
//! v = (E'E + lambda P)^-1 g        u^2 = sum_b s_b^2 |E_b v|^2       b = heights, slopes
//! ```
//!
//! With rows of unit variance this is `g'(E'E)^-1 g`. Preset weights are not inverse noise sds; then the variances `s_b^2`
//! of the residuals take their place (a sandwich estimator), so the answer does not rest on the weights.

use crate::fit::describe::interval::NoisePart;
use crate::fit::solved::Solved;
use crate::shape::{GridGradients, ShapeMaps, mean_gradients};

/// Standard uncertainty of `g'c`.
pub(super) fn standard_uncertainty(solved: &Solved, gradient: &[f64]) -> f64 {
    noise_part(solved, gradient).u
}

/// Standard uncertainty of `g'c` with its degrees of freedom.
fn noise_part(solved: &Solved, gradient: &[f64]) -> NoisePart {
    let fitted = &solved.fitted;
    let mut v = gradient.to_vec();
    fitted.solution.clear_free(&mut v);
    fitted.solution.factor.solve(&mut v);
    let squares = fitted.equations.row_squares(&v);
    let noise = solved.noise();
    let parts = [0, 1].map(|b| noise.row_variances[b] * squares[b]);
    NoisePart { u: (parts[0] + parts[1]).sqrt(), dof: degrees_of_freedom(parts, noise.dof) }
}

/// Of a sum of two variances with their own degrees of freedom (F. E. Satterthwaite, *Biometrics Bull.* 2 (1946) 110).
fn degrees_of_freedom(parts: [f64; 2], dof: [f64; 2]) -> f64 {
    let total = parts[0] + parts[1];
    // the shares first: the square of a small variance would underflow
    let spread: f64 = (0..2).map(|b| if parts[b] > 0.0 { (parts[b] / total).powi(2) / dof[b] } else { 0.0 }).sum();
    if spread > 0.0 { (1.0 / spread).max(1.0) } else { f64::INFINITY }
}

/// Standard uncertainties of mean S and mean R, and the gradients that they come from.
pub(super) struct Uncertainties {
    /// Gradients of S and R over the grid.
    pub gradients: GridGradients,
    /// Of mean S.
    pub of_shape_index: NoisePart,
    /// Of mean R, 1/length in input units.
    pub of_curvedness: NoisePart,
}

impl Uncertainties {
    /// Over the points of the maps.
    pub(super) fn new(solved: &Solved, local: &ShapeMaps) -> Uncertainties {
        let gradients = GridGradients::new(&solved.surface, &local.rows);
        let of_means = mean_gradients(&solved.surface, local, &gradients);
        // nothing between -1 and 1 has a larger standard deviation
        let of_shape_index = noise_part(solved, &of_means.shape_index);
        let of_shape_index = NoisePart { u: of_shape_index.u.min(1.0), ..of_shape_index };
        let of_curvedness = noise_part(solved, &of_means.curvedness);
        let of_curvedness = NoisePart { u: of_curvedness.u / solved.patch.frame.scale, ..of_curvedness };
        Uncertainties { gradients, of_shape_index, of_curvedness }
    }
}
