//! The normal is ESTIMATED from the sensed force, which is noisy, biased, drifting and quantised:
//!
//! ```text
//! f^ = Q(F n + bias + drift W + sigma N),    W: random walk along the lane, one step a contact,    n^ = f^/|f^|
//! P^ = C - rho n^
//! ```
//!
//! `sigma` (sd per axis), `bias` (one number for all axes or three), `drift` (sd of one step per axis), `quantum`
//! (step of the converter; Q rounds to its multiples): all in the unit of force. F is the force of `indentation` where
//! that stands in the scene, else `load` (default 1: the other keys are then fractions of the contact force). For
//! small errors n^ - n has covariance (sigma/F)^2 per tangent axis and mean bias_t/F.
//! A reading whose quantised force is zero has no direction and is lost.
//! Source: the paper's section 6 (normals from a force sensor); Bicchi, Salisbury, Brock, *IJRR* 12 (1993) 249.
//! Leaves out: cross-talk between axes, hysteresis, temperature; each lane starts from a zeroed sensor.

use super::{Context, Stage, swing};
use crate::draws::EffectDraws;
use crate::scene::SceneError;
use crate::scene::error::{finite, not_negative, positive};
use crate::scene::simulate::Block;
use crate::scene::vector::{norm, scaled};

/// Errors of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceNoise {
    /// Sd per axis.
    pub sigma: f64,
    /// Constant offset.
    pub bias: [f64; 3],
    /// Sd of one step of the random walk per axis.
    pub drift: f64,
    /// Step of the converter; 0: none.
    pub quantum: f64,
    /// Contact force where no indentation sets it.
    pub load: f64,
}

impl Default for ForceNoise {
    fn default() -> ForceNoise {
        ForceNoise { sigma: 0.0, bias: [0.0; 3], drift: 0.0, quantum: 0.0, load: 1.0 }
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    noise: ForceNoise,
    radius: f64,
    /// The contact before is in the same lane.
    continues: Vec<bool>,
}

impl ForceNoise {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.force_noise.sigma", self.sigma)?;
        self.bias.iter().try_for_each(|bias| finite("effects.force_noise.bias", *bias))?;
        not_negative("effects.force_noise.drift", self.drift)?;
        not_negative("effects.force_noise.quantum", self.quantum)?;
        positive("effects.force_noise.load", self.load)?;
        if self.sigma == 0.0 && self.bias == [0.0; 3] && self.drift == 0.0 && self.quantum == 0.0 {
            return Ok(None);
        }
        let (key, load) = context
            .load
            .map_or(("effects.force_noise.load", self.load), |load| ("effects.indentation.threshold", load));
        if self.quantum > load {
            return Err(SceneError::Clash {
                first: format!("effects.force_noise.quantum = {}", self.quantum),
                second: format!("{key} = {load}"),
                why: "the converter's step is larger than the force it should resolve".into(),
            });
        }
        Ok(Some(Box::new(Prepared { noise: *self, radius: context.believed_radius, continues: context.continues() })))
    }
}

impl Prepared {
    fn quantised(&self, value: f64) -> f64 {
        if self.noise.quantum > 0.0 { (value / self.noise.quantum).round() * self.noise.quantum } else { value }
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "force_noise"
    }

    fn changes(&self) -> String {
        let ForceNoise { sigma, bias, drift, quantum, .. } = self.noise;
        format!("normal, estimated from the force: sd {sigma}, bias {bias:?}, drift {drift}, quantum {quantum}")
    }

    fn draws_per_contact(&self) -> usize {
        if self.noise.sigma > 0.0 || self.noise.drift > 0.0 { 6 } else { 0 }
    }

    fn keeps_sites(&self) -> bool {
        // quantum <= load: only an error can round the whole force to zero, and so lose the reading
        let ForceNoise { sigma, bias, drift, quantum, .. } = self.noise;
        self.radius == 0.0 && (quantum == 0.0 || (sigma == 0.0 && drift == 0.0 && bias == [0.0; 3]))
    }

    fn apply(&self, block: &mut Block, draws: &EffectDraws) {
        let lanes = block.lanes();
        let per = self.draws_per_contact();
        let mut drawn = vec![0.0; lanes * 6];
        let mut walk = vec![[0.0; 3]; lanes];
        for (contact, continues) in self.continues.iter().enumerate() {
            if per > 0 {
                draws.gaussians(contact as u64, block.first_replicate(), per, &mut drawn);
            }
            for (lane, values) in drawn.chunks_exact(6).enumerate() {
                let entry = contact * lanes + lane;
                let load = block.loads.get(entry).copied().unwrap_or(self.noise.load);
                let start = if *continues { walk[lane] } else { [0.0; 3] };
                walk[lane] = [0, 1, 2].map(|k| start[k] + self.noise.drift * values[3 + k]);
                let normal = block.normals[entry];
                let sensed = [0, 1, 2].map(|k| {
                    let offset = self.noise.bias[k] + walk[lane][k] + self.noise.sigma * values[k];
                    self.quantised(load * normal[k] + offset)
                });
                let size = norm(sensed);
                if size == 0.0 {
                    block.lose(entry);
                    continue;
                }
                let estimated = scaled(1.0 / size, sensed);
                swing(&mut block.points[entry], &mut block.normals[entry], estimated, self.radius);
                if let Some(load) = block.loads.get_mut(entry) {
                    *load = size;
                }
            }
        }
    }
}
