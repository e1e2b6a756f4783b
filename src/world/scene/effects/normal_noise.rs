//! Normals drawn from the von Mises-Fisher law about the normal so far, kappa = 1/sigma^2:
//!
//! ```text
//! v = 1 - cos angle = -ln(u + (1 - u) exp(-2 kappa)) / kappa        azimuth uniform
//! E cos angle = coth kappa - 1/kappa
//! n -> Rz Ry Rx n                                            then by one rotation for all, of a sensor that sits askew
//! ```
//!
//! `sigma_deg` is per tangent axis, degrees: rms angle sqrt(2) sigma while it is small. The contact point stays.
//! `1 - cos` is drawn, not `cos`, so that the smallest sigma keeps its digits.
//! Source: R. A. Fisher, *Proc. R. Soc. A* 217 (1953) 295; sampling by G. Ulrich, *Appl. Stat.* 33 (1984) 158.
//! Not modelled: errors that differ along and across the sweep, and the shift of the contact that a wrong normal
//! implies (`force_noise` has it).

use super::finger_noise::bent;
use super::{Context, Effect, Kind, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite, not_negative};
use crate::scene::rotation::{Matrix, rotated, rotation, tangents};
use palpate_numeric::draws::{EffectDraws, NoiseLaw};
use palpate_numeric::vector::{along, unit};

/// Isotropic errors of the normal, and one that all normals share.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NormalNoise {
    /// Sd per tangent axis, degrees.
    pub sigma_deg: f64,
    /// Angles about x, y, z by which a sensor that sits askew turns all normals, degrees.
    #[cfg_attr(feature = "serde", serde(default))]
    pub tilt_deg: [f64; 3],
}

impl Effect {
    /// Normals drawn from the von Mises-Fisher law about the true one, with the sd `sigma_deg` per tangent axis, degrees.
    /// The contact point stays. Range: zero or more.
    pub fn normal_noise(sigma_deg: f64) -> Effect {
        NormalNoise { sigma_deg, ..NormalNoise::default() }.into()
    }

    /// Of [`Effect::normal_noise`]: a sensor that sits askew and turns every normal by `Rz Ry Rx`, angles `tilt_deg` about the fixed axes
    /// x, y, z in that order, degrees; the same in every replicate. The contact point stays. Range: finite numbers.
    pub fn with_normal_tilt(mut self, tilt_deg: [f64; 3]) -> Effect {
        match &mut self.kind {
            Kind::NormalNoise(noise) => noise.tilt_deg = tilt_deg,
            _ => return self.misplace("with_normal_tilt", "normal_noise"),
        }
        self
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    of: NormalNoise,
    kappa: f64,
    /// The tilt's rotation less identity, so that the smallest angle keeps its digits.
    rotation: Matrix,
}

impl NormalNoise {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.normal_noise.sigma_deg", self.sigma_deg)?;
        self.tilt_deg.iter().try_for_each(|v| finite("effects.normal_noise.tilt_deg", *v))?;
        let sigma = self.sigma_deg.to_radians();
        // 1/sigma^2 overflows below 1e-154, where the noise is far below rounding
        let kappa = (1.0 / (sigma * sigma)).min(1e300);
        let mut less_identity = rotation(self.tilt_deg);
        less_identity.iter_mut().enumerate().for_each(|(k, row)| row[k] -= 1.0);
        let acts = self.sigma_deg > 0.0 || self.tilt_deg != [0.0; 3];
        Ok(acts.then(|| Box::new(Prepared { of: *self, kappa, rotation: less_identity }) as Box<dyn Stage>))
    }
}

impl Prepared {
    fn add_noise(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        if draws.law() != NoiseLaw::Normal {
            // another law: the angle's two parts along the tangents, each of this sd
            let angle = self.of.sigma_deg.to_radians();
            batch.for_each_with_gaussians::<2>(draws, |_, normal, [a, b]| {
                *normal = bent(*normal, [angle * a, angle * b]);
            });
            return;
        }
        let far = (-2.0 * self.kappa).exp();
        batch.for_each_with_uniforms::<2>(draws, |_, normal, [height, azimuth]| {
            let fall = (-(height + (1.0 - height) * far).ln() / self.kappa).clamp(0.0, 2.0);
            let sine = (fall * (2.0 - fall)).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * azimuth).sin_cos();
            let (e1, e2) = tangents(*normal);
            *normal = unit([0, 1, 2].map(|k| normal[k] - fall * normal[k] + sine * (cos * e1[k] + sin * e2[k])));
        });
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "normal_noise"
    }

    fn changes(&self) -> String {
        let noise = format!("normal by sd {} degrees per tangent axis", self.of.sigma_deg);
        match (self.of.sigma_deg > 0.0, self.of.tilt_deg != [0.0; 3]) {
            (true, false) => noise,
            (true, true) => format!("{noise}, all turned by {:?} degrees", self.of.tilt_deg),
            _ => format!("normals turned by {:?} degrees", self.of.tilt_deg),
        }
    }

    fn draws_per_contact(&self) -> usize {
        if self.of.sigma_deg > 0.0 { 2 } else { 0 }
    }

    fn keeps_sites(&self) -> bool {
        true
    }

    fn rest(&self) -> f64 {
        1.0
    }

    fn tilts(&self) -> bool {
        true
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        if self.of.sigma_deg > 0.0 {
            self.add_noise(batch, draws);
        }
        if self.of.tilt_deg != [0.0; 3] {
            for normal in &mut batch.normals {
                *normal = along(*normal, 1.0, rotated(&self.rotation, *normal));
            }
        }
    }
}
