//! Now and then a finger slips and the reading is gross: with `probability` p the contact moves by `size` in a
//! direction uniform on the sphere.
//!
//! `size`: input units. Mean 0, covariance p size^2/3 per axis, excess kurtosis far above that of gaussians; a robust
//! fit is meant to find these. The normal stays.
//! Source: the gross-error model of P. J. Huber, *Ann. Math. Stat.* 35 (1964) 73. Not modelled: slips that last over
//! several stations, and normals lost with the grip.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative, probability};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::along;

/// Gross outliers of the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Slip {
    /// How often.
    pub probability: f64,
    /// How far, input units.
    pub size: f64,
}

impl Effect {
    /// Fingers that slip: with `probability` a contact is read `size` away, input units, in a direction uniform on the
    /// sphere. The normal stays. Range: a probability from 0 to 1, a size of zero or more.
    pub fn slip(probability: f64, size: f64) -> Effect {
        Slip { probability, size }.into()
    }
}

impl Slip {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        probability("effects.slip.probability", self.probability)?;
        not_negative("effects.slip.size", self.size)?;
        let none = self.probability == 0.0 || self.size == 0.0;
        Ok((!none).then(|| Box::new(*self) as Box<dyn Stage>))
    }
}

impl Stage for Slip {
    fn name(&self) -> &'static str {
        "slip"
    }

    fn changes(&self) -> String {
        format!("position by {} with probability {}", self.size, self.probability)
    }

    fn draws_per_contact(&self) -> usize {
        3
    }

    fn keeps_sites(&self) -> bool {
        false
    }

    fn rest(&self) -> f64 {
        1.0
    }

    fn jumps(&self) -> bool {
        true
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        batch.for_each_with_uniforms::<3>(draws, |point, _, [gate, height, azimuth]| {
            if gate < self.probability {
                let z = 2.0 * height - 1.0;
                let across = (1.0 - z * z).sqrt();
                let (sin, cos) = (std::f64::consts::TAU * azimuth).sin_cos();
                *point = along(*point, self.size, [across * cos, across * sin, z]);
            }
        });
    }
}
