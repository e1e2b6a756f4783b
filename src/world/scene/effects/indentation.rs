//! Elastic tips sink in before they are read: Hertz contact at the force that triggers the reading.
//!
//! ```text
//! F = threshold + overshoot U,  U uniform in (0, 1)        1/rho_e = 1/rho - (k1 + k2)/2
//! delta = (9 F^2 / (16 E*^2 rho_e))^(1/3)                  P -> P - delta n
//! ```
//!
//! `modulus` E* (contact modulus, force/length^2), `threshold` and `overshoot` (force: what the approach adds before
//! the sampled sensor stops it, uniform because the approach is not synchronised with the sampling). The sensed force
//! that later stages start from is F.
//! Mean of delta: `delta(1) (3/5)(b^(5/3) - a^(5/3))/(b - a)`, a, b the least and largest force.
//! Source: K. L. Johnson, *Contact Mechanics*, 1985, section 4.2.
//! Not modelled: the ellipse of unequal curvatures (their mean is taken), viscosity, the growth of the
//! contact area beyond small strains, and how the shifted pad tilts the normal.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative, positive};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::along;

/// Hertz indentation at a force threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Indentation {
    /// Contact modulus E*, force per length squared.
    pub modulus: f64,
    /// Force at which a reading is triggered.
    pub threshold: f64,
    /// Largest excess over the threshold.
    pub overshoot: f64,
}

impl Effect {
    /// Elastic tips that sink in by Hertz's law before they are read: depth `(9 F^2 / (16 modulus^2 rho_e))^(1/3)` at a
    /// force F uniform between `threshold` and `threshold + overshoot`.
    ///
    /// Units: force per length squared, force, force. Range: `modulus` above zero, the forces zero or more; the tips need a
    /// radius, and the depth stays below it.
    pub fn indentation(modulus: f64, threshold: f64, overshoot: f64) -> Effect {
        Indentation { modulus, threshold, overshoot }.into()
    }
}

/// Depth at unit force, contact by contact.
#[derive(Clone, Debug)]
struct Prepared {
    threshold: f64,
    overshoot: f64,
    unit_depth: Vec<f64>,
}

impl Indentation {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        positive("effects.indentation.modulus", self.modulus)?;
        not_negative("effects.indentation.threshold", self.threshold)?;
        not_negative("effects.indentation.overshoot", self.overshoot)?;
        let largest = self.threshold + self.overshoot;
        if largest == 0.0 {
            return Ok(None);
        }
        if context.tip_radius == 0.0 {
            return Err(SceneError::Clash {
                first: format!("effects.indentation.threshold = {}", self.threshold),
                second: "sweep.tip_radius = 0".into(),
                why: "a point sinks in without limit; give the tips a radius".into(),
            });
        }
        let mut unit_depth = Vec::with_capacity(context.sites.len());
        for site in context.sites {
            let local = &site.touch.local;
            // closer than the tip fits: the tip touches along a ring, which Hertz does not describe
            let bend = (1.0 / context.tip_radius - 0.5 * (local.k1 + local.k2)).max(0.0);
            unit_depth.push((9.0 * bend / (16.0 * self.modulus * self.modulus)).cbrt());
        }
        let deepest = unit_depth.iter().fold(0.0, |a: f64, b| a.max(*b)) * power(largest);
        if deepest > context.tip_radius {
            return Err(SceneError::Indentation {
                depth: deepest,
                force: largest,
                tip_radius: context.tip_radius,
                modulus: self.modulus,
            });
        }
        Ok(Some(Box::new(Prepared { threshold: self.threshold, overshoot: self.overshoot, unit_depth })))
    }
}

/// `F^(2/3)`.
fn power(force: f64) -> f64 {
    (force * force).cbrt()
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "indentation"
    }

    fn changes(&self) -> String {
        let mean = self.unit_depth.iter().sum::<f64>() / self.unit_depth.len() as f64;
        let (least, most) = (self.threshold, self.threshold + self.overshoot);
        format!(
            "position by {:.3e} to {:.3e} into the surface, force {least} to {most}",
            mean * power(least),
            mean * power(most)
        )
    }

    fn draws_per_contact(&self) -> usize {
        usize::from(self.overshoot > 0.0)
    }

    fn keeps_sites(&self) -> bool {
        false
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let mut excess = vec![0.0; replicates];
        let mut loads = std::mem::take(&mut batch.loads);
        loads.resize(batch.points.len(), 0.0);
        for (contact, unit_depth) in self.unit_depth.iter().enumerate() {
            if self.overshoot > 0.0 {
                draws.uniforms(contact as u64, batch.first_replicate(), 1, &mut excess);
            }
            for (replicate, excess) in excess.iter().enumerate() {
                let reading = contact * replicates + replicate;
                let force = self.threshold + self.overshoot * excess;
                loads[reading] = force;
                batch.points[reading] =
                    along(batch.points[reading], -unit_depth * power(force), batch.normals[reading]);
            }
        }
        batch.loads = loads;
    }
}
