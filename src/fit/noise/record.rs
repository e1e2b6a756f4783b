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
use crate::linalg::Sites;

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
