//! Errors that change slowly along the path of a finger: Ornstein-Uhlenbeck processes in the distance s along it.
//!
//! ```text
//! e(s + d) = a e(s) + sqrt(1 - a^2) sigma N,   a = exp(-d / length),   e(first) = sigma N
//! covariance of e(s), e(s'): sigma^2 exp(-|s - s'| / length)
//! ```
//!
//! `sigma`: of the position, one for all axes or three, input units. `sigma_deg`: of the normal per tangent axis,
//! degrees; the normal rotates by the angle |e| towards e. `length`: correlation length, input units. Repeats of a site
//! share their error; the fingers are independent of each other.
//! Source: G. E. Uhlenbeck, L. S. Ornstein, *Phys. Rev.* 36 (1930) 823, in its exact discretisation. Not modelled:
//! correlation between fingers, and between position and normal.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative, positive};
use crate::scene::rotation::tangents;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::unit;

/// Correlated errors along the path of each finger.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FingerNoise {
    /// Sd of the position along x, y, z, input units.
    pub sigma: [f64; 3],
    /// Sd of the normal per tangent axis, degrees.
    pub sigma_deg: f64,
    /// Correlation length, input units.
    pub length: f64,
}

impl Effect {
    /// Errors that change slowly along the path of each finger: of the position with sds `sigma`, input units, and of the
    /// normal with `sigma_deg` per tangent axis, degrees; their correlation falls as `exp(-distance / length)`.
    ///
    /// Range: the sds zero or more, `length` above zero.
    pub fn finger_noise(sigma: [f64; 3], sigma_deg: f64, length: f64) -> Effect {
        FingerNoise { sigma, sigma_deg, length }.into()
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    of: FingerNoise,
    /// (a, sqrt(1 - a^2)) of each contact; the first contact of a finger has a = 0.
    steps: Vec<(f64, f64)>,
}

impl FingerNoise {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        self.sigma.iter().try_for_each(|sigma| not_negative("effects.finger_noise.sigma", *sigma))?;
        not_negative("effects.finger_noise.sigma_deg", self.sigma_deg)?;
        positive("effects.finger_noise.length", self.length)?;
        if self.sigma == [0.0; 3] && self.sigma_deg == 0.0 {
            return Ok(None);
        }
        let continues = context.continues();
        let steps = (0..context.sites.len()).map(|contact| {
            if !continues[contact] {
                return (0.0, 1.0);
            }
            let distance = (context.sites[contact].along - context.sites[contact - 1].along).abs();
            // 1 - a^2 without cancellation for stations much closer than the length
            let decay = distance / self.length;
            ((-decay).exp(), (-(-2.0 * decay).exp_m1()).sqrt())
        });
        Ok(Some(Box::new(Prepared { of: *self, steps: steps.collect() })))
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "finger_noise"
    }

    /// The draws keep the name that this effect had first, so that a scene and a seed give the same numbers as ever.
    fn draws_name(&self) -> &'static str {
        "lane_noise"
    }

    fn changes(&self) -> String {
        let FingerNoise { sigma, sigma_deg, length } = self.of;
        format!("position by sd {sigma:?}, normal by sd {sigma_deg} degrees, correlated over {length}")
    }

    fn draws_per_contact(&self) -> usize {
        5
    }

    fn keeps_sites(&self) -> bool {
        self.of.sigma[..2] == [0.0; 2]
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let mut drawn = vec![0.0; replicates * 5];
        let mut states = vec![[0.0; 5]; replicates];
        let angle = self.of.sigma_deg.to_radians();
        for (contact, (keep, fresh)) in self.steps.iter().enumerate() {
            draws.gaussians(contact as u64, batch.first_replicate(), 5, &mut drawn);
            for (replicate, (state, values)) in states.iter_mut().zip(drawn.chunks_exact(5)).enumerate() {
                for (s, value) in state.iter_mut().zip(values) {
                    *s = keep * *s + fresh * value;
                }
                let reading = contact * replicates + replicate;
                let point = &mut batch.points[reading];
                *point = [0, 1, 2].map(|k| point[k] + self.of.sigma[k] * state[k]);
                if angle > 0.0 {
                    let normal = &mut batch.normals[reading];
                    *normal = bent(*normal, [angle * state[3], angle * state[4]]);
                }
            }
        }
    }
}

/// The normal rotated by the angle |e| towards e in its tangent plane.
pub(super) fn bent(normal: [f64; 3], e: [f64; 2]) -> [f64; 3] {
    let size = e[0].hypot(e[1]);
    if size == 0.0 {
        return normal;
    }
    let (e1, e2) = tangents(normal);
    let (sin, cos) = size.sin_cos();
    unit([0, 1, 2].map(|k| cos * normal[k] + sin / size * (e[0] * e1[k] + e[1] * e2[k])))
}
