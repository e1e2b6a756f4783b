//! The normal is estimated from the sensed force, which is noisy, biased, drifting and quantised:
//!
//! ```text
//! f^ = Q(F n + bias + drift W + sigma N),    W: random walk along a finger, one step a contact,    n^ = f^/|f^|
//! P^ = C - rho n^
//! ```
//!
//! `sigma` (sd per axis), `bias` (one number for all axes or three), `drift` (sd of one step per axis), `quantum`
//! (step of the converter; Q rounds to its multiples): all in the unit of force. F is the force of `indentation` where
//! that stands in the scene, else `load` (default 1: the other keys are then fractions of the contact force). For
//! small errors n^ - n has covariance (sigma/F)^2 per tangent axis and mean bias_t/F.
//! A reading whose quantised force is zero has no direction and is lost.
//! Source: the paper's section 6 (normals from a force sensor); Bicchi, Salisbury, Brock, *IJRR* 12 (1993) 249.
//! Not modelled: cross-talk between axes, hysteresis, temperature; the sensor is zeroed before each finger starts.

use super::{Context, Effect, Kind, Stage, swing};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite, not_negative, positive};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{norm, scaled};

/// Errors of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

impl Effect {
    /// Noise of sd `sigma` per axis on the force that the normal is estimated from.
    ///
    /// The contact force F is what [`Effect::indentation`] sets, where the world has it, else 1, or what
    /// [`Effect::with_force`] says: without either, `sigma` is a fraction of the contact force. Range: zero or more.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::{Effect, Surface, Sweep, World};
    ///
    /// let sensor = Effect::force_noise(0.02).with_force_bias([0.01, 0.0, -0.01]).with_force_steps(0.01);
    /// let sweep = Sweep::new(vec![0.0], vec![-1.0, 0.0, 1.0]);
    /// World::new(Surface::plane(), sweep.clone()).with(sensor).compile()?;
    ///
    /// let mixed_up = World::new(Surface::plane(), sweep).with(Effect::dropout(0.1).with_force_steps(0.01));
    /// assert!(mixed_up.compile().unwrap_err().to_string().contains("belongs to force_noise"));
    /// # Ok::<(), palpate::scene::SceneError>(())
    /// ```
    pub fn force_noise(sigma: f64) -> Effect {
        ForceNoise { sigma, ..ForceNoise::default() }.into()
    }

    /// Of [`Effect::force_noise`]: a constant offset of the sensed force, unit of force. Range: finite.
    pub fn with_force_bias(self, bias: [f64; 3]) -> Effect {
        self.with_force_setting("with_force_bias", |noise| noise.bias = bias)
    }

    /// Of [`Effect::force_noise`]: a random walk along each finger whose steps have this sd per axis, unit of force. Range:
    /// zero or more.
    pub fn with_force_drift(self, sd: f64) -> Effect {
        self.with_force_setting("with_force_drift", |noise| noise.drift = sd)
    }

    /// Of [`Effect::force_noise`]: the step of the sensor's converter, unit of force; 0 for none. A reading that is
    /// rounded to no force at all is lost.
    pub fn with_force_steps(self, quantum: f64) -> Effect {
        self.with_force_setting("with_force_steps", |noise| noise.quantum = quantum)
    }

    /// Of [`Effect::force_noise`]: the contact force, where no indentation sets it. Range: above zero.
    pub fn with_force(self, force: f64) -> Effect {
        self.with_force_setting("with_force", |noise| noise.load = force)
    }

    fn with_force_setting(mut self, setting: &'static str, set: impl FnOnce(&mut ForceNoise)) -> Effect {
        match &mut self.kind {
            Kind::ForceNoise(noise) => set(noise),
            _ => return self.misplace(setting, "force_noise"),
        }
        self
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    noise: ForceNoise,
    radius: f64,
    /// Whether the contact before each contact was made by the same finger.
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

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let per = self.draws_per_contact();
        let mut drawn = vec![0.0; replicates * 6];
        let mut walk = vec![[0.0; 3]; replicates];
        for (contact, continues) in self.continues.iter().enumerate() {
            if per > 0 {
                draws.gaussians(contact as u64, batch.first_replicate(), per, &mut drawn);
            }
            for (replicate, values) in drawn.chunks_exact(6).enumerate() {
                let reading = contact * replicates + replicate;
                let load = batch.loads.get(reading).copied().unwrap_or(self.noise.load);
                let start = if *continues { walk[replicate] } else { [0.0; 3] };
                walk[replicate] = [0, 1, 2].map(|k| start[k] + self.noise.drift * values[3 + k]);
                let normal = batch.normals[reading];
                let sensed = [0, 1, 2].map(|k| {
                    let offset = self.noise.bias[k] + walk[replicate][k] + self.noise.sigma * values[k];
                    self.quantised(load * normal[k] + offset)
                });
                let size = norm(sensed);
                if size == 0.0 {
                    batch.lose(reading);
                    continue;
                }
                let estimated = scaled(1.0 / size, sensed);
                swing(&mut batch.points[reading], &mut batch.normals[reading], estimated, self.radius);
                if let Some(load) = batch.loads.get_mut(reading) {
                    *load = size;
                }
            }
        }
    }
}
