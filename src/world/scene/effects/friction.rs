//! Coulomb friction tilts the sensed force, and with it the normal that is read from it.
//!
//! ```text
//! f = N (n - mu t),   n^ = f/|f|: tilted by atan mu against the sliding direction t (tangent to the surface)
//! P^ = C - rho n^ = P - rho (n^ - n)
//! ```
//!
//! `mu` dimensionless, `sigma` its sd from contact to contact (a gaussian law; 0: constant). The force grows to
//! N sqrt(1 + mu^2). Mean tilt atan mu for sigma = 0.
//! Source: Coulomb's law on a sliding finger (A. Bicchi, J. K. Salisbury, D. L. Brock, *IJRR* 12 (1993) 249, contact
//! sensing from force measurements). Not modelled: stick-slip, direction changes at stations, rolling resistance.

use super::{Context, Effect, Stage, swing};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{along, dot, norm, scaled, unit};

/// Sliding friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction {
    /// Coefficient of friction.
    pub mu: f64,
    /// Its sd from contact to contact.
    pub sigma: f64,
}

impl Effect {
    /// Sliding friction with coefficient `mu`, which varies by the sd `sigma` from contact to contact: the sensed normal
    /// is tilted by `atan mu` against the sliding direction.
    ///
    /// Range: both zero or more, without unit.
    pub fn friction(mu: f64, sigma: f64) -> Effect {
        Friction { mu, sigma }.into()
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    friction: Friction,
    /// Horizontal sliding direction of each contact.
    sliding: Vec<[f64; 3]>,
    radius: f64,
}

impl Friction {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.friction.mu", self.mu)?;
        not_negative("effects.friction.sigma", self.sigma)?;
        if self.mu == 0.0 && self.sigma == 0.0 {
            return Ok(None);
        }
        let sliding = context.sites.iter().map(|site| [site.direction[0], site.direction[1], 0.0]).collect();
        Ok(Some(Box::new(Prepared { friction: *self, sliding, radius: context.believed_radius })))
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn changes(&self) -> String {
        let tilt = self.friction.mu.atan().to_degrees();
        format!("normal by {tilt:.3} degrees against the sliding (mu {}, sd {})", self.friction.mu, self.friction.sigma)
    }

    fn draws_per_contact(&self) -> usize {
        usize::from(self.friction.sigma > 0.0)
    }

    fn keeps_sites(&self) -> bool {
        self.radius == 0.0
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let mut varied = vec![0.0; replicates];
        for (contact, sliding) in self.sliding.iter().enumerate() {
            if self.friction.sigma > 0.0 {
                draws.gaussians(contact as u64, batch.first_replicate(), 1, &mut varied);
            }
            for (replicate, varied) in varied.iter().enumerate() {
                let reading = contact * replicates + replicate;
                let normal = batch.normals[reading];
                let mu = self.friction.mu + self.friction.sigma * varied;
                let tangent = along(*sliding, -dot(*sliding, normal), normal);
                let length = norm(tangent);
                // straight down a wall the sliding has no horizontal part left to tilt by
                if length == 0.0 {
                    continue;
                }
                let tilted = unit(along(normal, -mu, scaled(1.0 / length, tangent)));
                swing(&mut batch.points[reading], &mut batch.normals[reading], tilted, self.radius);
                if let Some(load) = batch.loads.get_mut(reading) {
                    *load *= 1.0_f64.hypot(mu);
                }
            }
        }
    }
}
