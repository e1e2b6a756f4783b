//! What a fit knows of its noise: sds, or weights with the residuals from which the sds are computed on demand.
//!
//! ```text
//! s_b^2 = |weighted residuals of kind b|^2 / (rows_b - trace H_b)          sd of kind b = s_b / weight_b
//! ```

use crate::fit::SlopeWeights;
use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::sds::{NoiseSds, NoiseSource};
use crate::fit::noise::traces::hat_traces;
use palpate_numeric::linalg::Sites;

/// Noise sds known with the fit, or the weights from which they are computed on demand, at the cost of a trace.
#[derive(Clone, Debug)]
pub(crate) enum NoiseRecord {
    /// Declared, or estimated with the fit.
    Known(NoiseSds),
    /// Weights that are not inverse noise sds.
    Weighted {
        /// What the user called the weights.
        word: SlopeWeights,
        /// The weights `[wz, wx, wy]`, input units.
        weights: [f64; 3],
        /// The power of two that extreme weights were multiplied by.
        unit: f64,
        /// Sums of squares of the weighted residuals, `[heights, slopes]`.
        squares: [f64; 2],
    },
}

impl NoiseRecord {
    /// The sds of the rows of a solved problem.
    pub(crate) fn sds(&self, equations: &Equations, solution: &Solution) -> NoiseSds {
        match self {
            NoiseRecord::Known(sds) => *sds,
            NoiseRecord::Weighted { word, weights, unit, squares } => {
                let rows = equations.row_weights.row_counts(equations.sites.len());
                let (variances, dof) = residual_variances(equations, solution, *squares);
                NoiseSds { dof, ..sds_of_weights(*word, *weights, *unit, variances, rows) }
            }
        }
    }

    /// By which factor an F ratio of sums of squares is too large under a robust loss; 1 without one.
    pub(crate) fn efficiency(&self) -> f64 {
        match self {
            NoiseRecord::Known(sds) => sds.efficiency,
            NoiseRecord::Weighted { .. } => 1.0,
        }
    }

    /// Whether the weights are preset ones, which differ by factors of ten at most.
    pub(crate) fn is_preset(&self) -> bool {
        let word = match self {
            NoiseRecord::Known(sds) => sds.weights,
            NoiseRecord::Weighted { word, .. } => Some(*word),
        };
        matches!(word, Some(SlopeWeights::Tangent | SlopeWeights::Position | SlopeWeights::Equal))
    }

    /// Where the weights of the rows come from, at no cost.
    pub(crate) fn source(&self) -> NoiseSource {
        match self {
            NoiseRecord::Known(sds) => sds.source,
            NoiseRecord::Weighted { weights, .. } => NoiseSource::Weights(*weights),
        }
    }

    /// The power of two that extreme weights were multiplied by; 1 for all others.
    pub(crate) fn unit(&self) -> f64 {
        match self {
            NoiseRecord::Known(_) => 1.0,
            NoiseRecord::Weighted { unit, .. } => *unit,
        }
    }
}

/// Noise sds of rows with these weights, `[wz, wx, wy]` times `unit`, and these variances.
pub(crate) fn sds_of_weights(
    word: SlopeWeights,
    weights: [f64; 3],
    unit: f64,
    row_variances: [f64; 2],
    rows: [usize; 2],
) -> NoiseSds {
    let sd = |b: usize| (rows[b] > 0 && weights[b] > 0.0).then(|| row_variances[b].sqrt() / unit / weights[b]);
    NoiseSds {
        source: NoiseSource::Weights(weights),
        weights: Some(word),
        sigma_z: sd(0),
        sigma_normal_deg: None,
        sigma_slope: sd(1),
        row_variances,
        dof: [f64::INFINITY; 2],
        efficiency: 1.0,
    }
}

/// Variance of the weighted rows of each kind with its degrees of freedom, from their residuals and their share of the
/// unknowns.
fn residual_variances(equations: &Equations, solution: &Solution, squares: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let rows = equations.row_weights.row_counts(equations.sites.len()).map(|r| r as f64);
    let traces = hat_traces(equations, solution);
    let dof = [0, 1].map(|b| rows[b] - traces[b]);
    let variance = |b: usize| if dof[b] > 1e-9 * rows[b].max(1.0) { squares[b] / dof[b] } else { 0.0 };
    ([0, 1].map(variance), dof)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, Objective, fit_contacts};
    use palpate_geometry::contact::Contacts;

    #[test]
    fn sds_are_those_of_the_residuals_over_the_weights() {
        let sds = sds_of_weights(SlopeWeights::Equal, [4.0, 0.5, 0.5], 0.25, [9.0, 16.0], [3, 5]);
        assert_eq!((sds.sigma_z, sds.sigma_slope, sds.sigma_normal_deg), (Some(3.0), Some(32.0), None));
        assert_eq!((sds.row_variances, sds.dof), ([9.0, 16.0], [f64::INFINITY; 2]));
        let none = sds_of_weights(SlopeWeights::Equal, [4.0, 0.0, 0.5], 1.0, [9.0, 16.0], [0, 5]);
        assert_eq!((none.sigma_z, none.sigma_slope), (None, None));
    }

    /// Weighted rows have the variance of their residuals over what their own share of the unknowns leaves.
    #[test]
    fn a_weighted_fit_has_the_sds_of_its_residuals() {
        let place = |r: usize| [0.754_877_666, 0.569_840_291].map(|k| 2.0 * (r as f64 * k).fract() - 1.0);
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = (0..40).map(place).map(|[x, y]| (x, y)).unzip();
        (x[0], y[0], x[1], y[1]) = (-1.0, -1.0, 1.0, 1.0);
        let z = (0..40).map(|r| x[r] * y[r] + 0.01 * (91.0 * r as f64).sin()).collect();
        let bent = |k: f64| (0..40).map(|r| 0.1 * (k * r as f64).sin()).collect::<Vec<f64>>();
        let contacts = Contacts::from_positions(x, y, z).with_slopes(bent(37.0), bent(53.0));
        for word in [SlopeWeights::Tangent, SlopeWeights::Explicit([1e120, 1e121, 1e121])] {
            let fit = fit_contacts(&contacts, &FitOptions::default().with_objective(Objective::Slopes(word))).unwrap();
            let record = &fit.solved.fitted.noise;
            let noise = fit.noise();
            let traces = hat_traces(fit.equations(), fit.solution());
            let squares = fit.equations().residual_squares(&fit.solution().coefficients);
            let sds = [noise.sigma_z.unwrap(), noise.sigma_slope.unwrap()];
            let weights = match word {
                SlopeWeights::Explicit(weights) => weights,
                _ => [1.0, 10.0, 10.0],
            };
            for (b, rows) in [40.0, 80.0].into_iter().enumerate() {
                assert!((noise.dof[b] - (rows - traces[b])).abs() < 1e-9);
                let variance = squares[b] / (rows - traces[b]);
                assert!((noise.row_variances[b] / variance - 1.0).abs() < 1e-12);
                let sd = variance.sqrt() / weights[b] / record.unit();
                assert!((sds[b] / sd - 1.0).abs() < 1e-12, "{word:?} {b}: {} {sd}", sds[b]);
            }
            let is_preset = word == SlopeWeights::Tangent;
            assert_eq!((record.is_preset(), record.unit() == 1.0, record.efficiency()), (is_preset, is_preset, 1.0));
            assert!(matches!(record.source(), NoiseSource::Weights(w) if (w[1] / weights[1] - 1.0).abs() < 1e-12));
        }
        let options = FitOptions::default().with_objective(Objective::Slopes(SlopeWeights::Auto));
        let estimated = fit_contacts(&contacts, &options).unwrap();
        let record = &estimated.solved.fitted.noise;
        assert_eq!((record.source(), record.is_preset(), record.unit()), (NoiseSource::Estimated, false, 1.0));
        assert_eq!(record.efficiency(), 1.0);
        let preset =
            NoiseRecord::Known(NoiseSds { weights: Some(SlopeWeights::Equal), efficiency: 2.0, ..*estimated.noise() });
        assert!(preset.is_preset() && preset.efficiency() == 2.0);
    }
}
