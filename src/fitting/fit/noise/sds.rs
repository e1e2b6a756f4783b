//! Noise sds of one fit, in input units and in the patch frame, and where they come from.

use crate::fit::SlopeWeights;

/// A robust loss measures in scales that come from medians, which tell as much as this share of the residuals would by their
/// squares (F. R. Hampel, *J. Am. Stat. Assoc.* 69 (1974) 383).
pub(crate) const MEDIAN_EFFICIENCY: f64 = 0.37;

/// Where the weights of the rows come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseSource {
    /// Weights of slope rows `[wz, wx, wy]`, input units; they need not be inverse noise sds.
    Weights([f64; 3]),
    /// Noise sds that the user declared.
    Sigma,
    /// Noise sds estimated with the fit.
    Estimated,
}

/// Noise sds and where they come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseSds {
    /// Weights given, sds given, or sds estimated.
    pub source: NoiseSource,
    /// The weights' word: `tangent`, `position`, `equal`, `auto` or `explicit`; `None` with normal rows.
    pub weights: Option<SlopeWeights>,
    /// Sd of a height, input units.
    pub sigma_z: Option<f64>,
    /// Sd of a normal per tangent axis, degrees.
    pub sigma_normal_deg: Option<f64>,
    /// Sd of a slope.
    pub sigma_slope: Option<f64>,
    /// Variances of the weighted rows, `[heights, slopes]`: 1 where the weights are inverse noise sds.
    pub row_variances: [f64; 2],
    /// Degrees of freedom behind the noise of heights and of slopes or normals; infinite where it was declared.
    pub dof: [f64; 2],
    /// Factor that corrects an F ratio of sums of squares for a robust loss; 1 without one.
    pub(crate) efficiency: f64,
}

/// Noise sds in the patch frame, by which rows are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RowSds {
    /// Sd of a height.
    pub z: f64,
    /// Sd of a normal per tangent axis (radians), or of a slope.
    pub slope: f64,
}
