//! Normals drawn from the von Mises-Fisher law about the normal so far, kappa = 1/sigma^2:
//!
//! ```text
//! v = 1 - cos angle = -ln(u + (1 - u) exp(-2 kappa)) / kappa        azimuth uniform
//! E cos angle = coth kappa - 1/kappa
//! ```
//!
//! `sigma_deg` is per tangent axis, degrees: rms angle sqrt(2) sigma while it is small. The contact point stays.
//! `1 - cos` is drawn, not `cos`, so that the smallest sigma keeps its digits.
//! Source: R. A. Fisher, *Proc. R. Soc. A* 217 (1953) 295; sampling by G. Ulrich, *Appl. Stat.* 33 (1984) 158.
//! Not modelled: errors that differ along and across the sweep, and the shift of the contact that a wrong normal
//! implies (`force_noise` has it).

use super::finger_noise::bent;
use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, not_negative};
use crate::scene::rotation::tangents;
use palpate_numeric::draws::{EffectDraws, NoiseLaw};
use palpate_numeric::vector::unit;

/// Isotropic errors of the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NormalNoise {
    /// Sd per tangent axis, degrees.
    pub sigma_deg: f64,
}

impl Effect {
    /// Normals drawn from the von Mises-Fisher law about the true one, with the sd `sigma_deg` per tangent axis, degrees.
    /// The contact point stays. Range: zero or more.
    pub fn normal_noise(sigma_deg: f64) -> Effect {
        NormalNoise { sigma_deg }.into()
    }
}

#[derive(Clone, Copy, Debug)]
struct Prepared {
    sigma_deg: f64,
    kappa: f64,
}

impl NormalNoise {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.normal_noise.sigma_deg", self.sigma_deg)?;
        let sigma = self.sigma_deg.to_radians();
        // 1/sigma^2 overflows below 1e-154, where the noise is far below rounding
        let kappa = (1.0 / (sigma * sigma)).min(1e300);
        Ok((self.sigma_deg > 0.0).then(|| Box::new(Prepared { sigma_deg: self.sigma_deg, kappa }) as Box<dyn Stage>))
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "normal_noise"
    }

    fn changes(&self) -> String {
        format!("normal by sd {} degrees per tangent axis", self.sigma_deg)
    }

    fn draws_per_contact(&self) -> usize {
        2
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
        if draws.law() != NoiseLaw::Normal {
            // another law: the angle's two parts along the tangents, each of this sd
            let angle = self.sigma_deg.to_radians();
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
