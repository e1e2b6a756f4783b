//! Independent gaussian errors of the measured position: `P + L N`, `L L' = Sigma`.
//!
//! `sigma`: one sd for all axes or one each, input units; or `covariance`, 3 x 3, input units squared, factored by
//! Cholesky with zero pivots allowed. Mean 0, covariance Sigma.
//! Source: the usual model of a tracked or computed fingertip position. Not modelled: correlation between contacts
//! (see `finger_noise`, `encoder`) and growth with the arm's reach.

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite, not_negative};
use palpate_numeric::draws::EffectDraws;

/// Position errors, per axis or correlated between axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum PositionNoise {
    /// Sd along x, y, z, input units.
    Sigma([f64; 3]),
    /// Covariance of x, y, z, input units squared.
    Covariance([[f64; 3]; 3]),
}

impl Effect {
    /// Independent gaussian errors of the measured position with these sds along x, y, z, input units. Range: zero or more.
    pub fn position_noise(sigma: [f64; 3]) -> Effect {
        PositionNoise::Sigma(sigma).into()
    }

    /// Gaussian errors of the measured position with this covariance of x, y, z, input units squared. It is symmetric and
    /// has no negative eigenvalue. A world has this or [`Effect::position_noise`].
    pub fn position_covariance(covariance: [[f64; 3]; 3]) -> Effect {
        PositionNoise::Covariance(covariance).into()
    }
}

/// Lower triangle rows: xx, yx yy, zx zy zz.
#[derive(Clone, Copy, Debug)]
struct Prepared {
    factor: [f64; 6],
    keeps_sites: bool,
}

impl PositionNoise {
    pub(crate) fn prepare(&self, _context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        let factor = match self {
            PositionNoise::Sigma(sigma) => {
                sigma.iter().try_for_each(|s| not_negative("effects.position_noise.sigma", *s))?;
                [sigma[0], 0.0, sigma[1], 0.0, 0.0, sigma[2]]
            }
            PositionNoise::Covariance(covariance) => factored(covariance)?,
        };
        if factor.iter().all(|f| *f == 0.0) {
            return Ok(None);
        }
        let keeps_sites = factor[..3].iter().all(|f| *f == 0.0);
        Ok(Some(Box::new(Prepared { factor, keeps_sites })))
    }
}

/// Cholesky factor of a symmetric positive semidefinite matrix.
fn factored(a: &[[f64; 3]; 3]) -> Result<[f64; 6], SceneError> {
    const KEY: &str = "effects.position_noise.covariance";
    for i in 0..3 {
        for j in 0..3 {
            finite(KEY, a[i][j])?;
            if a[i][j] != a[j][i] {
                return Err(SceneError::Clash {
                    first: format!("{KEY}[{i}][{j}] = {}", a[i][j]),
                    second: format!("{KEY}[{j}][{i}] = {}", a[j][i]),
                    why: "a covariance is symmetric".into(),
                });
            }
        }
    }
    let largest = a[0][0].max(a[1][1]).max(a[2][2]);
    let mut l = [[0.0; 3]; 3];
    for j in 0..3 {
        let pivot = a[j][j] - (0..j).map(|k| l[j][k] * l[j][k]).sum::<f64>();
        // a pivot this small is the rounding of a zero one
        let rounding = 8.0 * f64::EPSILON * largest;
        if pivot < -rounding {
            return Err(SceneError::range(
                KEY,
                pivot,
                "a covariance has no negative eigenvalue (this pivot is negative)",
            ));
        }
        l[j][j] = if pivot <= rounding { 0.0 } else { pivot.sqrt() };
        for i in j + 1..3 {
            let rest = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if l[j][j] > 0.0 {
                l[i][j] = rest / l[j][j];
            } else if rest.abs() > rounding {
                return Err(SceneError::range(KEY, rest, "a coordinate without variance has no covariance either"));
            }
        }
    }
    Ok([l[0][0], l[1][0], l[1][1], l[2][0], l[2][1], l[2][2]])
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "position_noise"
    }

    fn changes(&self) -> String {
        let [xx, yx, yy, zx, zy, zz] = self.factor;
        format!("position by sd {}, {}, {}", xx, yx.hypot(yy), zx.hypot(zy).hypot(zz))
    }

    fn draws_per_contact(&self) -> usize {
        3
    }

    fn keeps_sites(&self) -> bool {
        self.keeps_sites
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let [xx, yx, yy, zx, zy, zz] = self.factor;
        batch.for_each_with_gaussians::<3>(draws, |point, _, [a, b, c]| {
            point[0] += xx * a;
            point[1] += yx * a + yy * b;
            point[2] += zx * a + zy * b + zz * c;
        });
    }
}
