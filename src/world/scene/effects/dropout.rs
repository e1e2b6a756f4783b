//! Readings that never arrive: each contact is lost with `probability` p, independently.
//!
//! The number kept is binomial. A lost contact is in neither the contacts nor the truth of its replicate; the
//! other contacts keep their draws. The set of sites changes, so a study cannot keep its factor.
//! Not modelled: several losses in a row, as by a loose cable.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, probability};
use palpate_numeric::draws::EffectDraws;

/// Lost readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dropout {
    /// How often.
    pub probability: f64,
}

impl Effect {
    /// Readings that never arrive: each contact is lost with `probability`, independently. Range: 0 to below 1.
    pub fn dropout(probability: f64) -> Effect {
        Dropout { probability }.into()
    }
}

impl Dropout {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        probability("effects.dropout.probability", self.probability)?;
        if self.probability == 1.0 {
            return Err(SceneError::range("effects.dropout.probability", 1.0, "below 1, or no contact is left"));
        }
        Ok((self.probability > 0.0).then(|| Box::new(*self) as Box<dyn Stage>))
    }
}

impl Stage for Dropout {
    fn name(&self) -> &'static str {
        "dropout"
    }

    fn changes(&self) -> String {
        format!("contacts lost with probability {}", self.probability)
    }

    fn draws_per_contact(&self) -> usize {
        1
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
        let replicates = batch.replicates();
        let mut uniforms = vec![0.0; replicates];
        for contact in 0..batch.contacts() {
            draws.uniforms(contact as u64, batch.first_replicate(), 1, &mut uniforms);
            for (replicate, u) in uniforms.iter().enumerate() {
                if *u < self.probability {
                    batch.lose(contact * replicates + replicate);
                }
            }
        }
    }
}
