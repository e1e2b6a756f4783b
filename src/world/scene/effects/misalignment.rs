//! The robot's frame is not the one it believes: `P -> Rz Ry Rx P + t`, `n -> Rz Ry Rx n`.
//!
//! `rotation_deg` about the fixed axes x, y, z in that order, degrees; `translation`, input units. About the input's
//! origin. Constant over a scene: deterministic, no spread.
//! Source: extrinsic calibration error. Not modelled: play of the base, and a frame that moves during the sweep.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite};
use crate::scene::rotation::{Matrix, rotated, rotation};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::along;

/// Error of the robot's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Misalignment {
    /// Angles about x, y, z, degrees.
    pub rotation_deg: [f64; 3],
    /// Shift, input units.
    pub translation: [f64; 3],
}

impl Effect {
    /// A robot whose frame is not the one it believes: `P -> Rz Ry Rx P + translation`, angles `rotation_deg` about the
    /// fixed axes x, y, z in that order, degrees; the same in every replicate. Range: finite numbers.
    pub fn misalignment(rotation_deg: [f64; 3], translation: [f64; 3]) -> Effect {
        Misalignment { rotation_deg, translation }.into()
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    of: Misalignment,
    /// Rotation less identity, so that the smallest angle keeps its digits.
    rotation: Matrix,
}

impl Misalignment {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        self.rotation_deg.iter().try_for_each(|v| finite("effects.misalignment.rotation_deg", *v))?;
        self.translation.iter().try_for_each(|v| finite("effects.misalignment.translation", *v))?;
        if self.rotation_deg == [0.0; 3] && self.translation == [0.0; 3] {
            return Ok(None);
        }
        let mut less_identity = rotation(self.rotation_deg);
        for (k, row) in less_identity.iter_mut().enumerate() {
            row[k] -= 1.0;
        }
        Ok(Some(Box::new(Prepared { of: *self, rotation: less_identity })))
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "misalignment"
    }

    fn changes(&self) -> String {
        format!("frame by {:?} degrees and {:?}", self.of.rotation_deg, self.of.translation)
    }

    fn draws_per_contact(&self) -> usize {
        0
    }

    fn keeps_sites(&self) -> bool {
        self.of.rotation_deg == [0.0; 3] && self.of.translation[..2] == [0.0; 2]
    }

    fn apply(&self, batch: &mut ContactBatch, _draws: &EffectDraws) {
        for point in &mut batch.points {
            *point = along(along(*point, 1.0, rotated(&self.rotation, *point)), 1.0, self.of.translation);
        }
        for normal in &mut batch.normals {
            *normal = along(*normal, 1.0, rotated(&self.rotation, *normal));
        }
    }
}
