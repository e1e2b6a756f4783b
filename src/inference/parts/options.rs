//! What a caller may say of a segmentation.

use super::error::PartsError;
use super::tuning::PartsTuning;

/// How a cloud is cut into parts. The default suits clouds from simulations and scanners alike.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct PartsOptions {
    /// Departures from a primitive, along the normal and in the input's unit, that make no part of their own; `None`: a tenth of
    /// the spacing or 0.3 % of the cloud's size, whichever is more, beside the noise; a hundredth or three of it where contacts depart
    /// from their parts side by side ([`PartsTuning::departs`]). What is named is neither less nor more.
    pub tolerance: Option<f64>,
    /// Where the sensor stood: estimated normals point to it.
    pub viewpoint: Option<[f64; 3]>,
    /// What decides; the defaults serve a user who names nothing.
    pub tuning: PartsTuning,
}

impl PartsOptions {
    /// The same with departures up to `tolerance` let pass.
    pub fn with_tolerance(mut self, tolerance: f64) -> PartsOptions {
        self.tolerance = Some(tolerance);
        self
    }

    pub(super) fn check(&self) -> Result<(), PartsError> {
        match self.tolerance.filter(|t| !(*t >= 0.0 && t.is_finite())) {
            Some(value) => {
                let expected = "a length in the contacts' unit is needed, zero or more";
                Err(PartsError::Option { option: "tolerance", value, expected })
            }
            None => Ok(()),
        }
    }
}
