//! Which point belongs to which primitive: regions one after another, then all of them together.
//!
//! ```text
//! energy = sum_p cost(p, label p) / 2 + AGREE (pairs of neighbours with different labels) + sum_parts unknowns ln(rows) / 2
//! 1. grow a region from the smoothest point that no region explains; keep it if it lowers the energy
//! 2. repeat: fit every part to its inner points; give every point the best label among its neighbours'; join two parts
//!    where one primitive explains both as well
//! ```
//!
//! H. Isack and Y. Boykov, *Energy-based geometric multi-model fitting*, IJCV 97 (2012) 123. Nothing is drawn at random: seeds
//! come in the order of their misfit, all labels change at once.

use std::collections::HashSet;

use super::cloud::{Cloud, FEWEST_POINTS, NEAREST};
use super::evidence::{Cells, Residuals};
use super::hypothesis::{CAP, Walk, best, cost, descended, extent, grow, sampled};
use super::local::{LocalShape, Noise};
use crate::primitives::descent::Sample;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::statistics::{MAD_TO_SD, RAYLEIGH_TO_SD, mad, upper_median};
use palpate_numeric::threads;

/// What a pair of neighbours with different labels costs. A point with all 8 neighbours on the other side changes sides
/// unless it costs 6 more there, which noise does once in thirty.
const AGREE: f64 = 0.7;

/// Rounds of fitting and relabelling; most clouds settle in five.
const ROUNDS: usize = 15;

/// Sweeps over all labels in a round.
const SWEEPS: usize = 4;

/// Points that two parts are judged by when they are to be joined.
const JUDGED: usize = 200;

/// No part.
pub(super) const NONE: u32 = u32::MAX;

/// Every point's part.
#[derive(Clone, Debug)]
pub(super) struct Partition {
    pub(super) parts: Vec<Primitive>,
    pub(super) labels: Vec<u32>,
}

/// What a partition is made from.
pub(super) struct Field<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) shapes: &'a [LocalShape],
    /// The noise as most places show it.
    pub(super) noise: &'a Noise,
    /// The noise with what departures from a primitive are let pass.
    pub(super) coarse: &'a Noise,
    /// What is let pass.
    pub(super) pass: Noise,
    pub(super) cells: Cells,
}

/// Cuts the cloud into parts.
pub(super) fn partition(field: &Field) -> Partition {
    settled(grown(field.cloud, field.shapes, field.coarse), field)
}

/// Parts whose edges and sizes follow each other until nothing changes.
fn settled(mut partition: Partition, field: &Field) -> Partition {
    let cloud = field.cloud;
    let mut fine = *field.coarse;
    for round in 0..ROUNDS {
        let before = partition.labels.clone();
        partition.refit(field);
        if round > 0 {
            fine = partition.noise(cloud, field.noise);
        }
        (0..SWEEPS).for_each(|_| partition.relabel(cloud, &fine));
        partition.drop_small();
        let joined = partition.join(field);
        if !joined && round > 1 && same(&before, &partition.labels) {
            break;
        }
    }
    partition.refit(field);
    partition.sharpen(field);
    partition
}

/// All but one point in a thousand have the label that they had.
fn same(before: &[u32], after: &[u32]) -> bool {
    1000 * before.iter().zip(after).filter(|(a, b)| a != b).count() <= before.len()
}

/// Region after region.
fn grown(cloud: &Cloud, shapes: &[LocalShape], u: &Noise) -> Partition {
    let misfit = |i: usize| {
        let [z, n] = shapes[i].variance;
        z / u.distance.powi(2) + 2.0 * n / u.normal.powi(2)
    };
    let mut order: Vec<(f64, u32)> = (0..cloud.len()).map(|i| (misfit(i), i as u32)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut walk = Walk::new(cloud.len());
    let mut costs = vec![CAP; cloud.len()];
    let mut tried = vec![false; cloud.len()];
    let mut labels = vec![NONE; cloud.len()];
    let mut parts = Vec::new();
    let rows = (4 * cloud.len()) as f64;
    for (_, seed) in order {
        let seed = seed as usize;
        if tried[seed] || labels[seed] != NONE {
            continue;
        }
        tried[seed] = true;
        let found = grow(cloud, seed, u, &mut walk).filter(|(_, members)| members.len() >= FEWEST_POINTS);
        let Some((primitive, members)) = found else {
            cloud.near(seed).iter().for_each(|&j| tried[j as usize] = true);
            continue;
        };
        let better: Vec<(usize, f64)> = members
            .iter()
            .map(|&i| (i as usize, cost(&primitive, cloud.points[i as usize], cloud.normals[i as usize], u)))
            .filter(|(i, cost)| *cost < costs[*i])
            .collect();
        let gain: f64 = better.iter().map(|(i, cost)| costs[*i] - cost).sum();
        let price = (primitive.kind.free().len() + 1) as f64 * rows.ln();
        if gain <= price || better.len() < FEWEST_POINTS / 2 {
            cloud.near(seed).iter().for_each(|&j| tried[j as usize] = true);
            continue;
        }
        for (i, cost) in better {
            costs[i] = cost;
            labels[i] = parts.len() as u32;
        }
        parts.push(primitive);
    }
    Partition { parts, labels }
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

    /// Those of them whose neighbours all belong to the same part; all of them where these are too few.
    pub(super) fn inner(&self, cloud: &Cloud, members: &[u32]) -> Vec<u32> {
        let is_inner = |i: &u32| {
            let own = self.labels[*i as usize];
            cloud.linked(*i as usize).iter().all(|&j| self.labels[j as usize] == own)
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
        let inner = self.inner(field.cloud, members);
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

    fn replace(&mut self, by: Vec<Option<Primitive>>) {
        self.parts.iter_mut().zip(by).for_each(|(part, by)| *part = by.unwrap_or(*part));
    }

    /// Fits parts at the noise that they themselves show, as long as that halves it. Until then they are fitted with what is let pass:
    /// normals that were estimated across an edge tilt exact planes. Whose a point beside an edge is, distances alone tell.
    fn sharpen(&mut self, field: &Field) {
        let cloud = field.cloud;
        for _ in 0..ROUNDS {
            let members = self.members();
            let sharper = threads::map(self.parts.len(), 1, |part| {
                sharper(cloud, &self.inner(cloud, &members[part]), &self.parts[part], field.noise)
            });
            if sharper.iter().all(Option::is_none) {
                break;
            }
            self.replace(sharper);
            let u = Noise { normal: f64::INFINITY, ..self.noise(cloud, field.noise) };
            (0..SWEEPS).for_each(|_| self.relabel(cloud, &u));
        }
    }

    /// The noise as all parts together show it: medians, since some points are on the wrong side.
    fn noise(&self, cloud: &Cloud, floor: &Noise) -> Noise {
        let off: Vec<(f64, f64)> = (0..cloud.len())
            .filter(|&i| self.labels[i] != NONE)
            .map(|i| {
                let (d, normal) = self.parts[self.labels[i] as usize].nearest(cloud.points[i]);
                (d.abs(), palpate_numeric::vector::norm(palpate_numeric::vector::minus(normal, cloud.normals[i])))
            })
            .collect();
        if off.is_empty() {
            return *floor;
        }
        let median = |values: Vec<f64>| upper_median(values).unwrap_or(0.0);
        Noise {
            distance: floor.distance.max(MAD_TO_SD * median(off.iter().map(|o| o.0).collect())),
            normal: floor.normal.max(RAYLEIGH_TO_SD * median(off.iter().map(|o| o.1).collect())),
        }
    }

    /// Every point takes the label of least energy among those of its neighbours, all at once.
    fn relabel(&mut self, cloud: &Cloud, u: &Noise) {
        let labels = &self.labels;
        let chosen = threads::map(cloud.len(), 256, |i| {
            let own = labels[i];
            let mut candidates: Vec<u32> = cloud.near(i).iter().map(|&j| labels[j as usize]).collect();
            candidates.push(own);
            candidates.sort_unstable();
            candidates.dedup();
            let energy = |label: u32| {
                let differing = cloud.linked(i).iter().filter(|&&j| labels[j as usize] != label).count();
                let data = match label {
                    NONE => CAP,
                    part => cost(&self.parts[part as usize], cloud.points[i], cloud.normals[i], u),
                };
                0.5 * data + AGREE * differing as f64
            };
            let of = |label: u32| (energy(label), label);
            candidates.into_iter().map(of).fold(of(own), |best, new| if new.0 < best.0 { new } else { best }).1
        });
        self.labels = chosen;
    }

    /// Parts with hardly a point go, and their points with them.
    fn drop_small(&mut self) {
        let mut counts = vec![0_usize; self.parts.len()];
        self.labels.iter().filter(|l| **l != NONE).for_each(|l| counts[*l as usize] += 1);
        self.keep(|part| counts[part] >= FEWEST_POINTS);
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

    /// Joins pairs of parts, the one that lowers the energy most first, until none does.
    fn join(&mut self, field: &Field) -> bool {
        let mut joined = false;
        let pairs: Vec<(usize, usize)> = (0..self.parts.len()).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
        let mut gains = self.gains(field, &pairs);
        while let Some((_, primitive, (a, b))) = gains.iter().copied().reduce(|x, y| if y.0 > x.0 { y } else { x }) {
            joined = true;
            self.parts[a] = primitive;
            self.labels.iter_mut().filter(|l| **l == b as u32).for_each(|l| *l = a as u32);
            self.keep(|part| part != b);
            // numbers beyond b move down by one; what was known of a and b is void
            gains.retain(|(_, _, (x, y))| ![*x, *y].iter().any(|k| *k == a || *k == b));
            let moved = |k: usize| if k > b { k - 1 } else { k };
            gains.iter_mut().for_each(|(_, _, (x, y))| (*x, *y) = (moved(*x), moved(*y)));
            let others = (0..self.parts.len()).filter(|k| *k != a);
            let new: Vec<(usize, usize)> = others.map(|k| (a.min(k), a.max(k))).collect();
            gains.extend(self.gains(field, &new));
        }
        joined
    }

    /// The pairs of which joining lowers the energy, by how much and to which primitive.
    fn gains(&self, field: &Field, pairs: &[(usize, usize)]) -> Vec<(f64, Primitive, (usize, usize))> {
        let cloud = field.cloud;
        let members = self.members();
        let inner = threads::map(members.len(), 1, |part| self.inner(cloud, &members[part]));
        let adjacent = self.adjacent(cloud);
        let judged = threads::map(pairs.len(), 1, |k| {
            let (a, b) = pairs[k];
            self.gain_of_joining(field, (a, &inner[a]), (b, &inner[b]), adjacent.contains(&(a as u32, b as u32)))
        });
        let found = judged.into_iter().zip(pairs).filter_map(|(found, pair)| found.map(|(gain, p)| (gain, p, *pair)));
        found.collect()
    }

    /// Pairs of parts with points next to each other, the smaller number first.
    fn adjacent(&self, cloud: &Cloud) -> HashSet<(u32, u32)> {
        let mut pairs = HashSet::new();
        for i in 0..cloud.len() {
            for &j in cloud.linked(i) {
                let (a, b) = (self.labels[i], self.labels[j as usize]);
                if a != b && a != NONE && b != NONE {
                    pairs.insert((a.min(b), a.max(b)));
                }
            }
        }
        pairs
    }

    /// By how much one primitive beats two, if it does.
    fn gain_of_joining(
        &self,
        field: &Field,
        (a, of_a): (usize, &[u32]),
        (b, of_b): (usize, &[u32]),
        adjacent: bool,
    ) -> Option<(f64, Primitive)> {
        let (cloud, u) = (field.cloud, field.coarse);
        let [one, two] = [self.parts[a], self.parts[b]];
        let (mut points, mut normals) = sampled(cloud, of_a, JUDGED);
        let first = points.len();
        let (more_points, more_normals) = sampled(cloud, of_b, JUDGED);
        points.extend(more_points);
        normals.extend(more_normals);
        let mean = |primitive: &Primitive, from: usize, to: usize| -> f64 {
            (from..to).map(|k| cost(primitive, points[k], normals[k], u)).sum::<f64>() / (to - from) as f64
        };
        // a primitive that explains nothing of the other part, nor the other way round, has nothing to do with it
        let foreign = if adjacent { 0.98 } else { 0.7 } * CAP;
        if mean(&one, first, points.len()) > foreign && mean(&two, 0, first) > foreign {
            return None;
        }
        let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
        let joint = best(&sample, &[one, two])?.primitive;
        let (mut together, mut apart) = (Residuals::default(), Residuals::default());
        together.add(cloud, of_a, &joint);
        together.add(cloud, of_b, &joint);
        apart.add(cloud, of_a, &one);
        apart.add(cloud, of_b, &two);
        let unknowns = |p: &Primitive| p.kind.free().len();
        let more = (unknowns(&one) + unknowns(&two) + 1).saturating_sub(unknowns(&joint));
        let lost = together.lose_to(&apart, more, &field.cells, &field.pass);
        (lost < 0.0).then_some((-lost, joint))
    }
}

/// The simplest kind that no richer one beats.
fn chosen(field: &Field, inner: &[u32], before: &Primitive) -> Option<Primitive> {
    /// Points that a part is fitted to while labels still change.
    const FITTED: usize = 1000;
    let (cloud, u) = (field.cloud, field.coarse);
    let (points, normals) = sampled(cloud, inner, FITTED);
    let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
    let extent = extent(&points);
    let mut kept: Option<(Primitive, Residuals)> = None;
    for kind in PartKind::EXACT {
        let Some(found) = descended(kind, &sample, &[*before], extent) else { continue };
        let mut residuals = Residuals::default();
        residuals.add(cloud, inner, &found.primitive);
        let better = kept.as_ref().is_none_or(|(primitive, simpler)| {
            let more = kind.free().len().saturating_sub(primitive.kind.free().len());
            simpler.lose_to(&residuals, more, &field.cells, &field.pass) > 0.0
        });
        if better {
            kept = Some((found.primitive, residuals));
        }
    }
    kept.map(|(primitive, _)| primitive)
}

/// The primitive fitted to those of its inner points that their own scatter explains, if half of that scatter goes with it.
fn sharper(cloud: &Cloud, inner: &[u32], before: &Primitive, floor: &Noise) -> Option<Primitive> {
    let scatter = |primitive: &Primitive| {
        mad(inner.iter().map(|i| primitive.nearest(cloud.points[*i as usize]).0)).max(floor.distance)
    };
    let u = Noise { distance: scatter(before), normal: floor.normal };
    let explains = |i: &u32| cost(before, cloud.points[*i as usize], cloud.normals[*i as usize], &u) < CAP;
    let explained: Vec<u32> = inner.iter().copied().filter(explains).collect();
    let found = exact(cloud, &explained, before, &u)?.primitive;
    (scatter(&found) < 0.5 * u.distance).then_some(found)
}

/// The kind of the part fitted once more to all inner points, for the answer.
pub(super) fn exact(
    cloud: &Cloud,
    inner: &[u32],
    primitive: &Primitive,
    u: &Noise,
) -> Option<crate::primitives::descent::Descended> {
    let (points, normals) = sampled(cloud, inner, usize::MAX);
    let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
    descended(primitive.kind, &sample, &[*primitive], extent(&points))
}
