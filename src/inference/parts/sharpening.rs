//! Parts at the noise that they themselves show, once it is known whose the contacts are.
//!
//! ```text
//! the same kind     fitted to what its own scatter explains, if half of that scatter goes with it
//! another kind      if contacts scatter about it no more than others about their parts, and by half of what they do about the part's
//! ```

use super::evidence::Residuals;
use super::hypothesis::{cost, descended, extent, sampled};
use super::local::Noise;
use super::partition::{FITTED, Field, Partition, ROUNDS, SWEEPS, exact, explained};
use super::tuning::PartsTuning;
use crate::primitives::descent::Sample;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::statistics::mad;
use palpate_numeric::threads;

impl Partition {
    /// Fits parts at the noise that they themselves show, as long as that halves it. Until then they are fitted with what is let pass:
    /// normals that were estimated across an edge tilt exact planes. Whose a point beside an edge is, distances alone tell.
    pub(super) fn sharpen(&mut self, field: &Field) {
        for round in 0..ROUNDS {
            let members = self.members();
            let common = self.scatter(field).common.distance;
            let sharper = threads::map(self.parts.len(), 1, |part| {
                let (inner, before) = (&self.inner(field.cloud, &members[part], field.tuning), &self.parts[part]);
                sharper(inner, before, field).or_else(|| of_sharper_kind((inner, before), field, common))
            });
            let is_sharp = sharper.iter().all(Option::is_none);
            if is_sharp && (round > 0 || !self.is_told_by_distances(field)) {
                break;
            }
            self.replace(sharper);
            let scatter = self.scatter(field).of_distances();
            (0..SWEEPS).for_each(|_| self.relabel(field, &scatter));
        }
    }

    /// Whether normals only blur labels: they are those of planes through neighbours, and contacts lie far nearer than what is let pass.
    fn is_told_by_distances(&self, field: &Field) -> bool {
        field.blurred && self.scatter(field).common.distance < field.tuning.sharper * field.coarse.distance
    }
}

/// The primitive fitted to those of its inner points that their own scatter explains, if half of that scatter goes with it.
fn sharper(inner: &[u32], before: &Primitive, field: &Field) -> Option<Primitive> {
    let (cloud, floor, tuning) = (field.cloud, &field.noise, field.tuning);
    let scatter = |primitive: &Primitive| {
        mad(inner.iter().map(|i| primitive.nearest(cloud.points[*i as usize]).0)).max(floor.distance)
    };
    let u = Noise { distance: scatter(before), normal: floor.normal };
    let explains = |i: &u32| cost(before, cloud.contact(*i as usize), &u, field.along(), tuning) < tuning.cost_of_none;
    let explained: Vec<u32> = inner.iter().copied().filter(explains).collect();
    let found = exact(cloud, &explained, before, &u, tuning)?.primitive;
    (scatter(&found) < tuning.sharper * u.distance).then_some(found)
}

/// A primitive of another kind, where the share of the contacts by which kinds are told scatters about it no more than the `common` ones
/// about theirs, and clearly less than about the part's: what is let pass hides that a strip of a bar is none of a ball.
fn of_sharper_kind((inner, before): (&[u32], &Primitive), field: &Field, common: f64) -> Option<Primitive> {
    let (cloud, PartsTuning { loose, sharper, own, .. }) = (field.cloud, field.tuning);
    let scatter = |primitive: &Primitive| {
        let mut residuals = Residuals::default();
        residuals.add(cloud, inner, primitive);
        residuals.spread(&Noise { distance: 0.0, normal: 0.0 }, *own).distance
    };
    let most = sharper * scatter(before);
    if field.shared || most <= loose * common {
        return None;
    }
    let u = field.told(Noise { distance: most, ..field.noise });
    let (points, normals) = sampled(cloud, inner, FITTED);
    let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
    let extent = extent(&points);
    let others = PartKind::EXACT.into_iter().filter(|kind| *kind != before.kind);
    // contacts off its edges are of neither kind, and are left behind step by step
    let fitted = |kind| {
        (0..ROUNDS).try_fold(descended(kind, &sample, &[], extent, field.tuning)?, |found, _| {
            let near = Noise { distance: scatter(&found.primitive).max(field.noise.distance), ..u };
            let kept = explained(cloud, inner, &found.primitive, &near, field.along(), field.tuning);
            exact(cloud, &kept, &found.primitive, &near, field.tuning)
        })
    };
    others.filter_map(fitted).map(|found| found.primitive).find(|found| scatter(found) <= loose * common)
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::vector::Vector;

    /// The top of a disc and its rim, seen from one side, which is so low that a ball lies within a tenth of a spacing of it. No error.
    fn disc() -> Vec<Vector> {
        let top = (0..1600_u32).map(|k| [f64::from(k % 40), f64::from(k / 40)].map(|v| 0.7 * v - 13.65));
        let top = top.filter(|[x, y]| x.hypot(*y) < 12.9).map(|[x, y]| [x, y, 2.0]);
        let rim = (0..168_u32).map(|k| (f64::from(k / 4) / 41.0 * 3.0, f64::from(k % 4)));
        let rim = rim.map(|(turn, row)| [13.0 * turn.cos(), 13.0 * turn.sin(), 1.6 - 0.7 * row]);
        top.chain(rim).collect()
    }

    #[test]
    fn a_low_rim_without_errors_is_of_a_bar_and_not_of_the_ball_beside_it() {
        let found = Parts::of(&Contacts::from_points(&disc()), &PartsOptions::default()).unwrap();
        let told: Vec<(PartKind, Option<f64>)> = found.parts.iter().map(|p| (p.kind, p.geometry.radius)).collect();
        let [(PartKind::Plane, None), (PartKind::Cylinder, Some(radius))] = told[..] else { panic!("{told:?}") };
        assert!((radius - 13.0).abs() < 1e-6, "{radius}");
    }
}
