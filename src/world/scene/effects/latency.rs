//! The position read with a normal is an older one: the finger was then further back on its path by `lag`.
//!
//! ```text
//! lag = distance + jitter (2 U - 1),   U uniform in (0, 1)        P -> P + T(along - lag) - T(along)
//! ```
//!
//! T is the true contact of the same tip further back on the same path. `distance` (speed times delay) and `jitter`
//! (speed times half a sampling period), input units; uniform, because the two clocks are not synchronised.
//! Mean lag `distance`, variance jitter^2/3. The lag of every site must stay on the surface; this is checked at its
//! ends before anything is drawn (a site that falls off in between keeps its unlagged position).
//! Not modelled: changes of speed between stations, the delay of the force channel, and the rotation of the shift by a
//! misaligned frame (second order).

use super::{Context, Effect, Stage};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite, not_negative};
use crate::scene::surface::{Surface, SurfacePoint};
use crate::scene::sweep::{Site, contact};
use palpate_numeric::draws::EffectDraws;

/// Positions that lag behind forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Latency {
    /// Mean lag along the path, input units.
    pub distance: f64,
    /// Half the width of the uniform law about it.
    pub jitter: f64,
}

impl Effect {
    /// Positions older than the normals they are read with: the finger was then `distance + jitter (2 U - 1)` further
    /// back on its path, input units, U uniform in (0, 1). Range: `jitter` zero or more, and every lagged site on the
    /// surface.
    pub fn latency(distance: f64, jitter: f64) -> Effect {
        Latency { distance, jitter }.into()
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    of: Latency,
    surface: Surface,
    tip_radius: f64,
    sites: Vec<Site>,
    /// Shift of each contact when the lag does not vary.
    constant: Vec<[f64; 3]>,
}

impl Latency {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        finite("effects.latency.distance", self.distance)?;
        not_negative("effects.latency.jitter", self.jitter)?;
        if self.distance == 0.0 && self.jitter == 0.0 {
            return Ok(None);
        }
        let mut constant = Vec::with_capacity(context.sites.len());
        for site in context.sites {
            let reached = |lag| lagged(context.surface, site, lag, context.tip_radius);
            let ends = [self.distance - self.jitter, self.distance + self.jitter];
            if let Some(lag) = ends.into_iter().find(|lag| reached(*lag).is_none()) {
                return Err(SceneError::Clash {
                    first: format!("effects.latency.distance = {} +- jitter = {}", self.distance, self.jitter),
                    second: format!("finger {}, station {} at {:?}", site.finger, site.station, site.aim),
                    why: format!("a lag of {lag} leaves the surface there"),
                });
            }
            constant.push(reached(self.distance).map_or([0.0; 3], |from| shift(&from, site)));
        }
        Ok(Some(Box::new(Prepared {
            of: *self,
            surface: context.surface.clone(),
            tip_radius: context.tip_radius,
            sites: context.sites.to_vec(),
            constant,
        })))
    }
}

fn lagged(surface: &Surface, site: &Site, lag: f64, tip_radius: f64) -> Option<SurfacePoint> {
    contact(surface, [site.aim[0] - lag * site.direction[0], site.aim[1] - lag * site.direction[1]], tip_radius)
}

fn shift(from: &SurfacePoint, site: &Site) -> [f64; 3] {
    [0, 1, 2].map(|k| from.point[k] - site.touch.point[k])
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "latency"
    }

    fn changes(&self) -> String {
        format!("position by {} +- {} back along the path", self.of.distance, self.of.jitter)
    }

    fn draws_per_contact(&self) -> usize {
        usize::from(self.of.jitter > 0.0)
    }

    fn keeps_sites(&self) -> bool {
        false
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let mut uniforms = vec![0.0; replicates];
        for (contact, site) in self.sites.iter().enumerate() {
            if self.of.jitter > 0.0 {
                draws.uniforms(contact as u64, batch.first_replicate(), 1, &mut uniforms);
            }
            for (replicate, u) in uniforms.iter().enumerate() {
                let moved = if self.of.jitter > 0.0 {
                    let lag = self.of.distance + self.of.jitter * (2.0 * u - 1.0);
                    lagged(&self.surface, site, lag, self.tip_radius).map_or([0.0; 3], |from| shift(&from, site))
                } else {
                    self.constant[contact]
                };
                let point = &mut batch.points[contact * replicates + replicate];
                *point = [0, 1, 2].map(|k| point[k] + moved[k]);
            }
        }
    }
}
