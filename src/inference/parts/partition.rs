//! Which point belongs to which primitive: regions one after another, then all of them together.
//!
//! ```text
//! energy = sum_p cost(p, label p) / 2 + agree (pairs of neighbours with different labels) + sum_parts unknowns ln(rows) / 2
//! 1. grow a region from the smoothest point that no region explains; keep it if it lowers the energy
//! 2. repeat: fit every part to its inner points; give every point the best label among its neighbours'; join two parts
//!    where one primitive explains both as well
//! ```
//!
//! H. Isack and Y. Boykov, *Energy-based geometric multi-model fitting*, IJCV 97 (2012) 123. Nothing is drawn at random: seeds
//! come in the order of their misfit, all labels change at once.

use super::cloud::{Cloud, FEWEST_POINTS, NEAREST};
use super::evidence::{Cells, Residuals};
use super::hypothesis::{cost, descended, extent, sampled};
use super::local::{LocalShapes, Noise};
use super::scatter::PartsScatter;
use super::sheet::SheetLimit;
use super::tuning::PartsTuning;
use crate::primitives::descent::{Sample, descend};
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::statistics::{MAD_TO_SD, RAYLEIGH_TO_SD, upper_median};
use palpate_numeric::threads;
use palpate_numeric::vector::{minus, norm};

/// Rounds of fitting and relabelling; most clouds settle in five.
pub(super) const ROUNDS: usize = 15;

/// Sweeps over all labels in a round.
pub(super) const SWEEPS: usize = 4;

/// Points that a part is fitted to while labels still change.
pub(super) const FITTED: usize = 1000;

/// No part.
pub(super) const NONE: u32 = u32::MAX;

/// Every point's part.
#[derive(Clone, Debug)]
pub(super) struct Partition {
    pub(super) parts: Vec<Primitive>,
    pub(super) labels: Vec<u32>,
}

/// The contacts of no part.
pub(super) fn unlabelled(labels: &[u32]) -> Vec<u32> {
    labels.iter().zip(0..).filter(|(label, _)| **label == NONE).map(|(_, i)| i).collect()
}

/// What a partition is made from.
#[derive(Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) shapes: &'a LocalShapes,
    /// The noise as most places show it.
    pub(super) noise: Noise,
    /// The noise with what departures from a primitive are let pass.
    pub(super) coarse: Noise,
    /// What is let pass.
    pub(super) pass: Noise,
    /// A departure that contacts do not resolve.
    pub(super) unresolved: f64,
    pub(super) cells: &'a Cells,
    /// Whether neighbours share errors: contacts that stand off then are no others' than those beside them.
    pub(super) shared: bool,
    /// Whether normals are those of planes through neighbours.
    pub(super) blurred: bool,
    pub(super) tuning: &'a PartsTuning,
}

impl Field<'_> {
    /// The same field where departures of at least this share of the cloud's size are let pass, and normals that go with them.
    pub(super) fn letting_pass(&self, share: f64) -> Self {
        let distance = self.pass.distance.max(share);
        let times = distance / self.pass.distance;
        // normals of planes through neighbours are let pass as much as they ever are
        let normal = if self.blurred { self.pass.normal } else { times * self.pass.normal };
        let coarse = Noise {
            distance: self.noise.distance.hypot(distance),
            normal: if self.blurred { self.coarse.normal } else { self.noise.normal.hypot(normal) },
        };
        Field { pass: Noise { distance, normal }, coarse, ..*self }
    }

    /// Whether every contact has a normal of its own: neither that of a plane through neighbours, nor turned by the waves of shared errors.
    pub(super) fn has_clear_normals(&self) -> bool {
        !self.blurred && !self.shared
    }

    /// What places are off by along the surface, where that turns their normals: those of planes through neighbours turn with many places,
    /// and so do those of a surface that waves.
    pub(super) fn along(&self) -> f64 {
        if self.has_clear_normals() { self.noise.distance } else { 0.0 }
    }

    /// A noise by which kinds are told: normals of planes through neighbours tell nothing beside the places that they are from, and on a
    /// face that is two contacts wide they lean towards the faces beside it.
    pub(super) fn told(&self, noise: Noise) -> Noise {
        if self.blurred { noise.blind() } else { noise }
    }

    /// Contacts that a primitive is judged by: those that it explains; where neighbours share errors all, since its own stand off, too.
    pub(super) fn judged(&self, inner: &[u32], primitive: &Primitive) -> Vec<u32> {
        if self.shared {
            return inner.to_vec();
        }
        explained(self.cloud, inner, primitive, &self.coarse, self.along(), self.tuning)
    }
}

impl Partition {
    /// The points of every part.
    pub(super) fn members(&self) -> Vec<Vec<u32>> {
        let mut members = vec![Vec::new(); self.parts.len()];
        for (i, label) in self.labels.iter().enumerate().filter(|(_, label)| **label != NONE) {
            members[*label as usize].push(i as u32);
        }
        members
    }

    /// Those of them whose neighbours all belong to the same part or to none; all of them where these are too few. Neighbours on the other
    /// side of a thin wall are no reason to leave a contact out: those that errors take away from that wall would be left, and the wall
    /// be too thick.
    pub(super) fn inner(&self, cloud: &Cloud, members: &[u32], tuning: &PartsTuning) -> Vec<u32> {
        let is_inner = |i: &u32| {
            let (own, i) = (self.labels[*i as usize], *i as usize);
            let beside = cloud.linked(i).iter().map(|j| *j as usize);
            beside.filter(|j| !cloud.are_back_to_back(i, *j, tuning)).all(|j| [own, NONE].contains(&self.labels[j]))
        };
        let inner: Vec<u32> = members.iter().copied().filter(is_inner).collect();
        if inner.len() >= FEWEST_POINTS { inner } else { members.to_vec() }
    }

    /// Fits every part to its inner points, its kind chosen anew.
    pub(super) fn refit(&mut self, field: &Field) {
        let members = self.members();
        let fitted = threads::map(self.parts.len(), 1, |part| self.chosen_for(field, part, &members[part]));
        self.replace(fitted);
    }

    /// The simplest kind for a part's inner points, where these are enough.
    fn chosen_for(&self, field: &Field, part: usize, members: &[u32]) -> Option<Primitive> {
        let inner = self.inner(field.cloud, members, field.tuning);
        if inner.len() < NEAREST / 2 { None } else { chosen(field, &inner, &self.parts[part]) }
    }

    /// Parts that a simpler kind explains as well are of that kind: a ball a hundred times as large as its patch is a plane.
    pub(super) fn simplify(&mut self, field: &Field) {
        let members = self.members();
        let simpler = threads::map(self.parts.len(), 1, |part| {
            let found = self.chosen_for(field, part, &members[part]);
            found.filter(|found| found.kind.free().len() < self.parts[part].kind.free().len())
        });
        self.replace(simpler);
    }

    pub(super) fn replace(&mut self, by: Vec<Option<Primitive>>) {
        self.parts.iter_mut().zip(by).for_each(|(part, by)| *part = by.unwrap_or(*part));
    }

    /// What contacts scatter by, all together and about each part: medians, since some are on the wrong side.
    pub(super) fn scatter(&self, field: &Field) -> PartsScatter {
        let mut off: Vec<Vec<[f64; 2]>> = vec![Vec::new(); self.parts.len()];
        for i in (0..field.cloud.len()).filter(|i| self.labels[*i] != NONE) {
            let part = self.labels[i] as usize;
            let (d, normal) = self.parts[part].nearest(field.cloud.points[i]);
            off[part].push([d.abs(), norm(minus(normal, field.cloud.normals[i]))]);
        }
        let floor = &field.noise;
        let noise_of = |off: &[[f64; 2]]| {
            let median = |k: usize| upper_median(off.iter().map(|o| o[k]).collect::<Vec<f64>>()).unwrap_or(0.0);
            let [distance, normal] = [MAD_TO_SD * median(0), RAYLEIGH_TO_SD * median(1)];
            Noise { distance: floor.distance.max(distance), normal: floor.normal.max(normal) }
        };
        let common = noise_of(&off.concat());
        let own = |off: &Vec<[f64; 2]>| noise_of(off).between(&common, &field.coarse);
        let own = if field.shared { Vec::new() } else { off.iter().map(own).collect() };
        let most_price = field.tuning.most_price * field.tuning.cost_of_none;
        PartsScatter { common, own, along: field.along(), most_price }
    }

    /// Every point takes the label of least energy among those of its neighbours, all at once.
    pub(super) fn relabel(&mut self, field: &Field, scatter: &PartsScatter) {
        let (cloud, labels, tuning) = (field.cloud, &self.labels, field.tuning);
        let prices: Vec<f64> = (0..self.parts.len()).map(|part| scatter.price(part)).collect();
        let chosen = threads::map(cloud.len(), 256, |i| {
            let own = labels[i];
            let beside = cloud.near(i).iter().map(|&j| labels[j as usize]);
            if beside.clone().all(|label| label == own) {
                return own;
            }
            let mut candidates: Vec<u32> = beside.chain([own]).collect();
            candidates.sort_unstable();
            candidates.dedup();
            let energy = |label: u32| {
                let differing = cloud.linked(i).iter().filter(|&&j| labels[j as usize] != label).count();
                let data = match label {
                    NONE => tuning.cost_of_none,
                    part => {
                        let part = part as usize;
                        let own = cost(&self.parts[part], cloud.contact(i), scatter.of(part), scatter.along, tuning);
                        (own + prices[part]).min(tuning.cost_of_none)
                    }
                };
                0.5 * data + tuning.agree * differing as f64
            };
            let of = |label: u32| (energy(label), label);
            candidates.into_iter().map(of).fold(of(own), |best, new| if new.0 < best.0 { new } else { best }).1
        });
        self.labels = chosen;
    }

    /// Parts with hardly a point go, and their points with them.
    pub(super) fn drop_small(&mut self) {
        let mut counts = vec![0_usize; self.parts.len()];
        self.labels.iter().filter(|l| **l != NONE).for_each(|l| counts[*l as usize] += 1);
        self.keep(|part| counts[part] >= FEWEST_POINTS);
    }

    /// Contacts that their part does not explain are of none: what a camera puts between two faces belongs to neither.
    pub(super) fn drop_strays(&mut self, field: &Field) {
        if field.shared {
            return;
        }
        // normals beside an edge lean where they are those of planes through neighbours, and distances alone tell
        let normal = if field.blurred { f64::INFINITY } else { field.coarse.normal };
        let (cloud, u, tuning) = (field.cloud, &Noise { normal, ..field.coarse }, field.tuning);
        let cost_in =
            |part: u32, i: usize| cost(&self.parts[part as usize], cloud.contact(i), u, field.along(), tuning);
        let labels = threads::map(cloud.len(), 256, |i| match self.labels[i] {
            NONE => NONE,
            part if cost_in(part, i) < tuning.cost_of_none => part,
            _ => NONE,
        });
        let mut left = vec![0_usize; self.parts.len()];
        labels.iter().filter(|label| **label != NONE).for_each(|label| left[*label as usize] += 1);
        // so few tell no primitive, and which of them stray is not known
        let is_told = |label: u32| label == NONE || left[label as usize] >= FEWEST_POINTS;
        self.labels.iter_mut().zip(labels).filter(|(old, _)| is_told(**old)).for_each(|(old, new)| *old = new);
    }

    /// What the contacts of a surface scatter by.
    pub(super) fn sheet_limit(&self, field: &Field) -> SheetLimit {
        let beside = Noise { distance: field.unresolved, normal: field.pass.normal };
        let of = (self.fewest_of_region(field), field.blurred);
        SheetLimit::new(&self.scatter(field).common, &beside, of, field.tuning)
    }

    /// Parts whose contacts fill a strip of space go, and their contacts with them.
    pub(super) fn drop_strips(&mut self, field: &Field) {
        if field.shared {
            return;
        }
        let limit = self.sheet_limit(field);
        let members = self.members();
        let holds = |part: usize| limit.holds_part(field.cloud, &self.labels, &members[part], &self.parts[part]);
        let kept = threads::map(self.parts.len(), 1, holds);
        self.keep(|part| kept[part]);
    }

    /// Only the parts for which `keeps` holds, numbered anew.
    pub(super) fn keep(&mut self, keeps: impl Fn(usize) -> bool) {
        let mut number = vec![NONE; self.parts.len()];
        let mut kept = Vec::new();
        for (part, primitive) in self.parts.iter().enumerate() {
            if keeps(part) {
                number[part] = kept.len() as u32;
                kept.push(*primitive);
            }
        }
        self.parts = kept;
        self.labels.iter_mut().filter(|l| **l != NONE).for_each(|l| *l = number[*l as usize]);
    }
}

/// The points that cost less than the most: a face too small to be a part has its neighbour's label, and a dozen points of a
/// cone's top turn its half angle by five uncertainties.
pub(super) fn explained(
    cloud: &Cloud,
    inner: &[u32],
    primitive: &Primitive,
    coarse: &Noise,
    along: f64,
    tuning: &PartsTuning,
) -> Vec<u32> {
    let cost_of = |i: &u32| cost(primitive, cloud.contact(*i as usize), coarse, along, tuning);
    let is_explained = |i: &u32| cost_of(i) < tuning.cost_of_none;
    let kept: Vec<u32> = inner.iter().copied().filter(is_explained).collect();
    if kept.len() >= FEWEST_POINTS { kept } else { inner.to_vec() }
}

/// The simplest kind that no richer one beats.
fn chosen(field: &Field, inner: &[u32], before: &Primitive) -> Option<Primitive> {
    let cloud = field.cloud;
    let [u, pass] = [field.coarse, field.pass].map(|noise| field.told(noise));
    let inner = &field.judged(inner, before);
    let own = if field.shared { 1.0 } else { field.tuning.own };
    let (points, normals) = sampled(cloud, inner, FITTED);
    let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
    let loses =
        |simpler: &Residuals, richer: &Residuals, more| simpler.lose_over(richer, more, field.cells, &pass, own);
    simplest((cloud, inner), &sample, &[*before], field.tuning, loses)
}

/// The simplest kind for some contacts that `loses` to no richer one that is so many unknowns richer, each begun at the primitives `before`,
/// too.
pub(super) fn simplest(
    (cloud, members): (&Cloud, &[u32]),
    sample: &Sample,
    before: &[Primitive],
    tuning: &PartsTuning,
    loses: impl Fn(&Residuals, &Residuals, usize) -> f64,
) -> Option<Primitive> {
    let extent = extent(sample.points);
    let mut kept: Option<(Primitive, Residuals)> = None;
    for kind in PartKind::EXACT {
        let Some(found) = descended(kind, sample, before, extent, tuning) else { continue };
        let mut residuals = Residuals::default();
        residuals.add(cloud, members, &found.primitive);
        let better = kept.as_ref().is_none_or(|(primitive, simpler)| {
            let more = kind.free().len().saturating_sub(primitive.kind.free().len());
            loses(simpler, &residuals, more) > 0.0
        });
        if better {
            kept = Some((found.primitive, residuals));
        }
    }
    kept.map(|(primitive, _)| primitive)
}

/// The kind of the part fitted once more to all inner points, for the answer: from where some of them lead it.
pub(super) fn exact(
    cloud: &Cloud,
    inner: &[u32],
    primitive: &Primitive,
    u: &Noise,
    tuning: &PartsTuning,
) -> Option<crate::primitives::descent::Descended> {
    let (points, normals) = sampled(cloud, inner, usize::MAX);
    let all = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
    let (some, turned) = sampled(cloud, inner, FITTED);
    let part = Sample { points: &some, normals: &turned, ..all };
    let near = descended(primitive.kind, &part, &[*primitive], extent(&points), tuning)?;
    descend(&near.primitive, &all)
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, unit};

    /// Contacts some one apart on both sides of a pipe's wall that is two thick, off by 0.2: those that errors take away from the other side
    /// have it less often among their neighbours.
    #[test]
    fn a_thin_wall_is_as_thick_as_it_is() {
        let draws = EffectDraws::new(12, "thin wall");
        let contact = |k: u64| -> (Vector, Vector) {
            let (mut at, mut off) = ([0.0; 2], [0.0; 4]);
            draws.uniforms(k, 0, 2, &mut at);
            draws.gaussians(k, 1, 4, &mut off);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let (radius, side) = if k.is_multiple_of(2) { (10.0, 1.0) } else { (8.0, -1.0) };
            let off_by = |c: f64, k: usize| side * c + 0.05 * off[k];
            let away = radius + 0.2 * off[0];
            ([away * cos, away * sin, 25.0 * at[1]], unit([off_by(cos, 1), off_by(sin, 2), 0.05 * off[3]]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..2800).map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        let [outer, inner] = &found.parts[..] else { panic!("{:?}", found.parts) };
        for (part, radius) in [(outer, 10.0), (inner, 8.0)] {
            let off = (part.geometry.radius.unwrap() - radius) / part.u.radius.unwrap();
            assert!(part.kind == PartKind::Cylinder && off.abs() < 3.0, "{off} {part:?}");
        }
    }
}
