//! Joint encoders are coarse and noisy; the tip's pose is what the arm's forward kinematics make of them:
//!
//! ```text
//! q^ = Q(q + sigma N),   Q rounds to multiples of resolution        C^ = fk(q^)
//! P^ = P + fk(q^) - fk(q),   n^ = R(q^) R(q)' n        covariance of fk for small sigma: sigma^2 J J'
//! ```
//!
//! `resolution_deg` (0: none) and `sigma_deg` of every joint, degrees. `base` and `links` (Denavit-Hartenberg: a,
//! alpha_deg, d, theta_deg) describe the arm; without them three joints stand beside the patch, at the patch's scale.
//! The force sensor rides on the last link, so the normal rotates with it. The joint angles are those of the touched
//! site; without sigma the error of a site is the same in every repeat and replicate.
//! Source: the paper's section 6 (joint angles of a 3-DOF arm); Denavit-Hartenberg as in [`Arm`]. Not modelled: link
//! lengths that are wrong, bending, backlash.

use super::arm::{Arm, Link, Pose};
use super::{Context, Effect, Kind, Stage, swing};
use crate::scene::batch::ContactBatch;
use crate::scene::error::{SceneError, finite, not_negative};
use crate::scene::rotation::{rotated, rotated_back};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, along, norm};

/// Joints beyond this are no arm (and would exceed an effect's draws per contact).
const MAX_JOINTS: usize = 32;

/// Encoder quantisation and noise.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Encoder {
    /// Step of every encoder, degrees.
    pub resolution_deg: f64,
    /// Sd of every joint angle, degrees.
    pub sigma_deg: f64,
    /// The arm; `None`: three joints beside the patch.
    pub arm: Option<Arm>,
}

impl Effect {
    /// Joint encoders that read in steps of `resolution_deg` (0: none) with noise of sd `sigma_deg`, degrees, carried to
    /// the tip by the arm's kinematics. Range: both zero or more.
    ///
    /// Without [`Effect::with_arm`] three joints stand beside the patch, at the patch's scale.
    pub fn encoder(resolution_deg: f64, sigma_deg: f64) -> Effect {
        Encoder { resolution_deg, sigma_deg, arm: None }.into()
    }

    /// Of [`Effect::encoder`]: the arm, by the place of its base and the Denavit-Hartenberg row of each joint,
    /// `[a, alpha, d, theta]`: link length, twist, offset and the joint's angle at encoder zero; input units and degrees.
    /// Range: 1 to 32 joints, and every site within their reach.
    ///
    /// ```
    /// # use palpate_world::facade as palpate;
    /// use palpate::scene::{Effect, Surface, Sweep, World};
    ///
    /// // a shoulder ten units beside the contact, and one link
    /// let arm = Effect::encoder(0.01, 0.02).with_arm([-10.0, 0.0, 0.0], &[[10.0, 0.0, 0.0, 0.0]]);
    /// World::new(Surface::plane(), Sweep::new(vec![0.0], vec![0.0])).with(arm).compile()?;
    /// # Ok::<(), palpate::scene::SceneError>(())
    /// ```
    pub fn with_arm(mut self, base: [f64; 3], rows: &[[f64; 4]]) -> Effect {
        let link = |[a, alpha_deg, d, theta_deg]: [f64; 4]| Link { a, alpha_deg, d, theta_deg };
        match &mut self.kind {
            Kind::Encoder(encoder) => encoder.arm = Some(Arm { base, links: rows.iter().copied().map(link).collect() }),
            _ => return self.misplace("with_arm", "encoder"),
        }
        self
    }
}

#[derive(Clone, Debug)]
struct Prepared {
    resolution_deg: f64,
    sigma_deg: f64,
    arm: Arm,
    joints: Vec<Vec<f64>>,
    poses: Vec<Pose>,
    radius: f64,
}

impl Encoder {
    pub(crate) fn prepare(&self, context: &Context) -> Result<Option<Box<dyn Stage>>, SceneError> {
        not_negative("effects.encoder.resolution_deg", self.resolution_deg)?;
        not_negative("effects.encoder.sigma_deg", self.sigma_deg)?;
        if self.resolution_deg == 0.0 && self.sigma_deg == 0.0 {
            return Ok(None);
        }
        let arm = self.arm.clone().unwrap_or_else(|| default_arm(context));
        check_arm(&arm)?;
        let mut joints: Vec<Vec<f64>> = Vec::with_capacity(context.sites.len());
        for site in context.sites {
            let target = site.touch.tip_centre(context.tip_radius);
            let solved = arm.inverse(target, joints.last().map(Vec::as_slice)).map_err(|miss| SceneError::Arm {
                finger: site.finger,
                station: site.station,
                miss,
                span: arm.span(),
                distance: norm(along(target, -1.0, arm.base)),
            })?;
            joints.push(solved);
        }
        let poses = joints.iter().map(|q| arm.forward(q, None)).collect();
        let (resolution_deg, sigma_deg, radius) = (self.resolution_deg, self.sigma_deg, context.believed_radius);
        Ok(Some(Box::new(Prepared { resolution_deg, sigma_deg, arm, joints, poses, radius })))
    }
}

fn check_arm(arm: &Arm) -> Result<(), SceneError> {
    if arm.links.is_empty() || arm.links.len() > MAX_JOINTS {
        let expected = "from 1 to 32 links are needed";
        return Err(SceneError::List { key: "effects.encoder.links".into(), expected });
    }
    let numbers = arm.links.iter().flat_map(|link| [link.a, link.alpha_deg, link.d, link.theta_deg]);
    numbers.chain(arm.base).try_for_each(|value| finite("effects.encoder.links", value))
}

/// Beside the sites' bounding box; a box without extent counts as a unit.
fn default_arm(context: &Context) -> Arm {
    let range = |axis: usize| {
        let values = context.sites.iter().map(|site| site.touch.point[axis]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    };
    let ranges = [range(0), range(1), range(2)];
    let side = (ranges[0].1 - ranges[0].0).max(ranges[1].1 - ranges[1].0);
    let side = if side > 0.0 { side } else { 1.0 };
    Arm::beside(side, ranges.map(|(lo, hi)| 0.5 * (lo + hi)))
}

impl Prepared {
    fn read(&self, angle: f64, noise: f64) -> f64 {
        let noisy = angle + self.sigma_deg.to_radians() * noise;
        let step = self.resolution_deg.to_radians();
        if step > 0.0 { (noisy / step).round() * step } else { noisy }
    }

    /// Shift of the point, and the normal as it is believed to stand.
    fn misread(&self, contact: usize, read: &[f64], normal: Vector) -> (Vector, Vector) {
        let (pose, true_pose) = (self.arm.forward(read, None), &self.poses[contact]);
        let moved = along(pose.point, -1.0, true_pose.point);
        (moved, rotated(&pose.rotation, rotated_back(&true_pose.rotation, normal)))
    }
}

impl Stage for Prepared {
    fn name(&self) -> &'static str {
        "encoder"
    }

    fn changes(&self) -> String {
        let joints = self.arm.links.len();
        format!("pose of a {joints}-joint arm: steps of {}, sd {} degrees", self.resolution_deg, self.sigma_deg)
    }

    fn draws_per_contact(&self) -> usize {
        if self.sigma_deg > 0.0 { self.arm.links.len() } else { 0 }
    }

    fn keeps_sites(&self) -> bool {
        false
    }

    fn apply(&self, batch: &mut ContactBatch, draws: &EffectDraws) {
        let replicates = batch.replicates();
        let joints = self.arm.links.len();
        let mut drawn = vec![0.0; replicates * joints];
        let mut read = vec![0.0; joints];
        for (contact, angles) in self.joints.iter().enumerate() {
            if self.sigma_deg > 0.0 {
                draws.gaussians(contact as u64, batch.first_replicate(), joints, &mut drawn);
            }
            for (replicate, values) in drawn.chunks_exact(joints).enumerate() {
                for ((read, angle), noise) in read.iter_mut().zip(angles).zip(values) {
                    *read = self.read(*angle, *noise);
                }
                let reading = contact * replicates + replicate;
                let (moved, normal) = self.misread(contact, &read, batch.normals[reading]);
                swing(&mut batch.points[reading], &mut batch.normals[reading], normal, self.radius);
                batch.points[reading] = along(batch.points[reading], 1.0, moved);
            }
        }
    }
}
