//! A sensor whose slopes are all too steep, or all too flat, by one factor:
//!
//! ```text
//! zx -> (1 + relative) zx,   zy -> (1 + relative) zy        n -> unit((1 + relative) nx, (1 + relative) ny, nz)
//! ```
//!
//! `relative`: 0.3 is 30 % too steep, -0.2 is 20 % too flat. About z; constant over a scene: deterministic, no spread. The contact
//! point stays.
//! Source: photometric calibration of tactile images, M. K. Johnson, E. H. Adelson, *CVPR* 2009, 1070: slopes are read off brightness, whose
//! scale has to be calibrated. Not modelled: a factor that differs from place to place or between x and y.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::unit;

/// One factor on all slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlopeGain {
    /// By how much slopes are too steep, relative to themselves.
    pub relative: f64,
}

impl Effect {
    /// A sensor whose slopes are all `1 + relative` times the true ones; the same in every replicate. The contact point stays.
    /// Range: finite numbers.
    pub fn slope_gain(relative: f64) -> Effect {
        SlopeGain { relative }.into()
    }
}

impl SlopeGain {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        finite("effects.slope_gain.relative", self.relative)?;
        Ok((self.relative != 0.0).then(|| Box::new(*self) as Box<dyn Stage>))
    }
}

impl Stage for SlopeGain {
    fn name(&self) -> &'static str {
        "slope_gain"
    }

    fn changes(&self) -> String {
        format!("slopes by a factor of {}", 1.0 + self.relative)
    }

    fn draws_per_contact(&self) -> usize {
        0
    }

    fn keeps_sites(&self) -> bool {
        true
    }

    fn apply(&self, batch: &mut ContactBatch, _draws: &EffectDraws) {
        for normal in &mut batch.normals {
            let [x, y, z] = *normal;
            // the change is added, so that the smallest factor keeps its digits
            *normal = unit([x + self.relative * x, y + self.relative * y, z]);
        }
    }
}
