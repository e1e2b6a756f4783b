//! Independent gaussian errors on the rows of the fit: `z + sigma_z N`, `zx + sigma_slope N`, `zy + sigma_slope N`.
//!
//! Units: `sigma_z` input units; `sigma_slope` dimensionless. x and y stay exact. In terms of the normal a slope error
//! e is `n - nz (ex, ey, 0)`, normalised, which is finite at nz = 0 too.
//! Source: the observation model of the paper's Eq. 14. Not modelled: that real slopes err in proportion to
//! 1 + slope^2, that x and y err too, and every correlation.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::unit;

/// Independent errors of z, zx, zy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RowNoise {
    /// Sd of z, input units.
    pub sigma_z: f64,
    /// Sd of each slope.
    pub sigma_slope: f64,
}

impl Effect {
    /// Independent gaussian errors on the rows of the fit, as the paper's studies have them: sd `sigma_z` of z, input
    /// units, and `sigma_slope` of each slope; x and y stay exact. Range: both zero or more.
    pub fn row_noise(sigma_z: f64, sigma_slope: f64) -> Effect {
        RowNoise { sigma_z, sigma_slope }.into()
    }
}

impl RowNoise {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.row_noise.sigma_z", self.sigma_z)?;
        not_negative("effects.row_noise.sigma_slope", self.sigma_slope)?;
        let none = self.sigma_z == 0.0 && self.sigma_slope == 0.0;
        Ok((!none).then(|| Box::new(*self) as Box<dyn Stage>))
    }
}

impl Stage for RowNoise {
    fn name(&self) -> &'static str {
        "row_noise"
    }

    fn changes(&self) -> String {
        format!("z by sd {}, each slope by sd {}", self.sigma_z, self.sigma_slope)
    }

    fn draws_per_contact(&self) -> usize {
        3
    }

    fn keeps_sites(&self) -> bool {
        true
    }

    fn row_sds(&self) -> Option<[f64; 2]> {
        Some([self.sigma_z, self.sigma_slope])
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        batch.for_each_with_gaussians::<3>(draws, |point, normal, [z, sx, sy]| {
            point[2] += self.sigma_z * z;
            if self.sigma_slope > 0.0 {
                let tilt = self.sigma_slope * normal[2];
                *normal = unit([normal[0] - tilt * sx, normal[1] - tilt * sy, normal[2]]);
            }
        });
    }
}
