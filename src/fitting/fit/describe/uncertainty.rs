//! Uncertainty of a linear functional `g'c` by the delta method, from the rows themselves:
//!
//! ```text
//! v = (E'E + lambda P)^-1 g        u^2 = sum_b s_b^2 |E_b v|^2       b = heights, slopes
//! ```
//!
//! With rows of unit variance this is `g'(E'E)^-1 g`. Preset weights are not inverse noise sds; then the variances `s_b^2`
//! of the residuals take their place (a sandwich estimator), so the answer does not rest on the weights.

use crate::fit::Robust;
use crate::fit::describe::interval::NoisePart;
use crate::fit::linear::equations::Equations;
use crate::fit::noise::declared::declared_off;
use crate::fit::noise::sds::NoiseSource;
use crate::fit::solved::Solved;
use palpate_geometry::shape::{
    GridGradients, ShapeMaps, chi_square_upper_tail, f_upper_tail, mean_gradients, umbilic_gradients,
};
use palpate_numeric::linalg::{Targets, apply_rows};

/// Standard uncertainty of `g'c`.
pub(super) fn standard_uncertainty(solved: &Solved, gradient: &[f64]) -> f64 {
    noise_part(solved, &solved.fitted.equations, gradient, [1.0; 2]).u
}

/// Standard uncertainty of `g'c` with its degrees of freedom; `above` are factors by which the noise sds are larger than
/// declared. `equations` are those of the fit, which may be assembled once for many functionals.
fn noise_part(solved: &Solved, equations: &Equations, gradient: &[f64], above: [f64; 2]) -> NoisePart {
    let fitted = &solved.fitted;
    let mut v = gradient.to_vec();
    fitted.solution.clear_free(&mut v);
    fitted.solution.factor.solve(&mut v);
    let squares = equations.row_squares(&v);
    let noise = solved.noise();
    let parts = [0, 1].map(|b| above[b] * above[b] * noise.row_variances[b] * squares[b]);
    NoisePart::new((parts[0] + parts[1]).sqrt(), degrees_of_freedom(parts, noise.dof))
}

/// Of a sum of two variances with their own degrees of freedom (F. E. Satterthwaite, *Biometrics Bull.* 2 (1946) 110).
fn degrees_of_freedom(parts: [f64; 2], dof: [f64; 2]) -> f64 {
    let total = parts[0] + parts[1];
    // the shares first: the square of a small variance would underflow
    let spread: f64 = (0..2).map(|b| if parts[b] > 0.0 { (parts[b] / total).powi(2) / dof[b] } else { 0.0 }).sum();
    if spread > 0.0 { 1.0 / spread } else { f64::INFINITY }
}

/// By which factor errors in place raise the uncertainty of `g'c`, because the rows of one contact share them.
///
/// ```text
/// u^2 = sum_r (E_r v)'C_r (E_r v)        beside    sum_r c_b |E_b v|^2,  c_b the mean variance of the rows of kind b
/// ```
fn in_place(solved: &Solved, gradient: &[f64]) -> f64 {
    let fitted = &solved.fitted;
    let Some(moved) = &fitted.moved else { return 1.0 };
    let mut v = gradient.to_vec();
    fitted.solution.clear_free(&mut v);
    fitted.solution.factor.solve(&mut v);
    let mut rows = Targets::new();
    apply_rows(&fitted.equations.sites, &fitted.equations.row_weights, &v, &mut rows);
    let counts = fitted.equations.row_weights.row_counts(rows.len()).map(|r| (r as f64).max(1.0));
    let of = |k: &dyn Fn(&[f64; 6]) -> f64| moved.covariances.iter().map(k).sum::<f64>();
    let means = [of(&|c| c[0]) / counts[0], of(&|c| c[3] + c[5]) / counts[1]];
    let (mut shared, mut apart) = (0.0, 0.0);
    for ([z, p, q], [zz, zp, zq, pp, pq, qq]) in rows.iter().zip(&moved.covariances) {
        shared += z * z * zz + p * p * pp + q * q * qq + 2.0 * (z * p * zp + z * q * zq + p * q * pq);
        apart += means[0] * z * z + means[1] * (p * p + q * q);
    }
    if apart > 0.0 { (shared / apart).max(0.0).sqrt() } else { 1.0 }
}

/// Of a mean of S or of R; `None` where the measurements leave nothing from which noise could be told.
pub(super) fn of_mean(solved: &Solved, gradient: &[f64], above: [f64; 2]) -> Option<NoisePart> {
    of_functional(solved, &solved.fitted.equations, gradient, above)
}

fn of_functional(solved: &Solved, equations: &Equations, gradient: &[f64], above: [f64; 2]) -> Option<NoisePart> {
    let part = with_rows_apart(solved, equations, gradient, above)?;
    let factor = in_place(solved, gradient);
    Some(NoisePart { u: factor * part.u, ..part })
}

/// The same where no rows of a contact share errors.
fn with_rows_apart(solved: &Solved, equations: &Equations, gradient: &[f64], above: [f64; 2]) -> Option<NoisePart> {
    let fitted = &solved.fitted;
    let source = fitted.noise.source();
    if source != NoiseSource::Sigma && fitted.equations.count() <= fitted.solution.rank {
        return None;
    }
    if source == NoiseSource::Estimated
        && solved.options.robust == Robust::None
        && let Some(levels) = solved.levels()
    {
        let [u, dof] = levels.uncertainty(gradient);
        return Some(NoisePart::new(u, dof));
    }
    let part = noise_part(solved, equations, gradient, above);
    let part = match solved.levels().filter(|levels| levels.probability_shared() > 0.0) {
        Some(levels) => {
            let largest = above[0].max(above[1]);
            let [u, dof] = levels.beside_independent(gradient, [part.u, part.dof], largest);
            NoisePart::new(u, dof)
        }
        None => part,
    };
    // beside no degree of freedom at all even Student's law has no interval
    (part.dof >= 1.0).then_some(part)
}

/// Factors by which the noise sds are larger than declared, at least 1.
pub(super) fn above_declared(solved: &Solved) -> [f64; 2] {
    declared_off(solved).map(|factor| factor.unwrap_or(1.0).max(1.0))
}

/// Standard uncertainty of `g'c` from noise, as the means have it; `above` is [`above_declared`].
pub(super) fn noise_at_point(solved: &Solved, equations: &Equations, gradient: &[f64], above: [f64; 2]) -> Option<f64> {
    of_functional(solved, equations, gradient, above).map(|part| part.u)
}

/// Covariance of the noise in two means, from their gradients: half of what the variance of the sum of both, in units of
/// their own uncertainties, exceeds 2 by.
pub(super) fn covariance(solved: &Solved, gradients: [&[f64]; 2]) -> Option<f64> {
    let above = above_declared(solved);
    let [a, b] = gradients.map(|g| of_mean(solved, g, above));
    let [a, b] = [a?.u, b?.u];
    if a <= 0.0 || b <= 0.0 {
        return None;
    }
    let sum: Vec<f64> = gradients[0].iter().zip(gradients[1]).map(|(x, y)| x / a + y / b).collect();
    let variance = of_mean(solved, &sum, above)?.u.powi(2);
    Some((0.5 * variance - 1.0).clamp(-1.0, 1.0) * a * b)
}

/// S beyond which the surface may be an umbilic throughout, where S is +-1 and cannot exceed it.
const NEAR_UMBILIC: f64 = 0.6;

/// Significance at which equal curvatures are rejected, that of the 95 % interval.
const UMBILIC_SIGNIFICANCE: f64 = 0.05;

/// Whether the curvatures in the middle of the patch may be equal. Noise separates two equal curvatures, always in the same
/// direction, so that the mean of S lies some 2.5 standard uncertainties below 1 on a ball.
///
/// ```text
/// T = d'C^-1 d,   d = ((a - c)/2, b),   C its covariance       T/2 ~ F(2, dof)
/// ```
fn may_be_umbilic(solved: &Solved, above: [f64; 2]) -> bool {
    let middle = [0, 1].map(|k| {
        let [lo, hi] = solved.patch.knots[k].domain();
        0.5 * (lo + hi)
    });
    let [(p, by_p), (q, by_q)] = umbilic_gradients(&solved.surface, middle[0], middle[1]);
    let sum: Vec<f64> = by_p.iter().zip(&by_q).map(|(a, b)| a + b).collect();
    let parts = [&by_p, &by_q, &sum].map(|g| of_mean(solved, g, above));
    let [Some(of_p), Some(of_q), Some(of_sum)] = parts else { return true };
    let [pp, qq] = [of_p, of_q].map(|part| part.u * part.u);
    let pq = 0.5 * (of_sum.u * of_sum.u - pp - qq);
    let determinant = pp * qq - pq * pq;
    if determinant.is_nan() || determinant <= 0.0 {
        return false;
    }
    let t = (p * p * qq - 2.0 * p * q * pq + q * q * pp) / determinant;
    let dof = of_p.dof.min(of_q.dof);
    let chance = if dof.is_finite() { f_upper_tail(0.5 * t, 2.0, dof) } else { chi_square_upper_tail(t, 2.0) };
    chance > UMBILIC_SIGNIFICANCE
}

/// Standard uncertainties of mean S and mean R, and the gradients that they come from.
pub(super) struct Uncertainties {
    /// Gradients of S and R over the grid.
    pub gradients: GridGradients,
    /// Of mean S.
    pub of_shape_index: Option<NoisePart>,
    /// Of mean R, 1/length in input units.
    pub of_curvedness: Option<NoisePart>,
    /// The end of S, 1 or -1, that its interval has to reach because the curvatures may be equal.
    pub end_of_shape_index: Option<f64>,
}

impl Uncertainties {
    /// Over the points of the maps.
    pub(super) fn new(solved: &Solved, local: &ShapeMaps, mean_shape_index: Option<f64>) -> Uncertainties {
        let gradients = GridGradients::new(&solved.surface, &local.rows);
        let of_means = mean_gradients(&solved.surface, local, &gradients);
        // nothing between -1 and 1 has a larger standard deviation
        let above = above_declared(solved);
        let of_shape_index = of_mean(solved, &of_means.shape_index, above);
        let of_shape_index = of_shape_index.map(|part| NoisePart { u: part.u.min(1.0), ..part });
        let of_curvedness = of_mean(solved, &of_means.curvedness, above);
        let of_curvedness = of_curvedness.map(|part| NoisePart { u: part.u / solved.patch.frame.scale, ..part });
        let near = mean_shape_index.filter(|s| s.abs() > NEAR_UMBILIC);
        let end_of_shape_index = near.filter(|_| may_be_umbilic(solved, above)).map(f64::signum);
        Uncertainties { gradients, of_shape_index, of_curvedness, end_of_shape_index }
    }
}

#[cfg(test)]
mod by_dense_rows;
