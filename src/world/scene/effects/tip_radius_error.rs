//! The robot believes its tips to have radius `rho + e`: the contact it computes is `C - (rho + e) n = P - e n`.
//!
//! `error` e: input units, constant over a scene (positive: tips believed too large), as a calibration leaves it.
//! Deterministic: mean shift -e n, no spread. Later effects that tilt the sensed normal swing the contact about the
//! tip's centre with the believed radius.
//! Source: the contact from tip centre and normal (R. S. Fearing, in *Dextrous Robot Hands*, 1990, the paper's [7]).
//! Not modelled: tips out of round, a different error per finger.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::along;

/// Error of the calibrated tip radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TipRadiusError {
    /// Believed minus true radius, input units.
    pub error: f64,
}

impl Effect {
    /// Tips that are believed too large by `error`, input units: the contact that the robot computes is `P - error n`.
    ///
    /// Range: any finite number; negative for tips believed too small, as long as the believed radius is none below zero.
    pub fn tip_radius_error(error: f64) -> Effect {
        TipRadiusError { error }.into()
    }
}

impl TipRadiusError {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        finite("effects.tip_radius_error.error", self.error)?;
        if context.believed_radius < 0.0 {
            return Err(SceneError::Clash {
                first: format!("effects.tip_radius_error.error = {}", self.error),
                second: format!("sweep.tip_radius = {}", context.tip_radius),
                why: "the robot would believe in a tip of negative radius".into(),
            });
        }
        Ok((self.error != 0.0).then(|| Box::new(*self) as Box<dyn Stage>))
    }
}

impl Stage for TipRadiusError {
    fn name(&self) -> &'static str {
        "tip_radius_error"
    }

    fn changes(&self) -> String {
        format!("position by {} along the normal", -self.error)
    }

    fn draws_per_contact(&self) -> usize {
        0
    }

    fn keeps_sites(&self) -> bool {
        false
    }

    fn apply(&self, batch: &mut ContactBatch, _draws: &EffectDraws) {
        for (point, normal) in batch.points.iter_mut().zip(&batch.normals) {
            *point = along(*point, -self.error, *normal);
        }
    }
}
