//! The part of `palpate.fit/1` that only a simulated world has: what is true of what was found.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The truth over the same points.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct TruthPart {
    /// Mean true shape index.
    #[serde(rename = "S")]
    pub(crate) shape_index: Option<f64>,
    /// Mean true curvedness.
    #[serde(rename = "R")]
    pub(crate) curvedness: Option<f64>,
    /// Pointwise rms error of S.
    #[serde(rename = "error_S")]
    pub(crate) error_shape_index: Option<f64>,
    /// Pointwise rms error of R.
    #[serde(rename = "error_R")]
    pub(crate) error_curvedness: Option<f64>,
    /// Class of the true surface over most of the points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) class: Option<String>,
    /// Its radius, by the rule of `shape.radius`; so the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) radius: Option<f64>,
    /// Both radii.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) radii: Option<[f64; 2]>,
    /// Direction of k1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<f64>,
    /// The same in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) direction: Option<[f64; 3]>,
    /// Axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axis_deg: Option<f64>,
    /// The same in space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) axis: Option<[f64; 3]>,
}
