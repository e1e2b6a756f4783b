//! Region after region, from the smoothest place that none explains.
//!
//! ```text
//! region(p)    grown from p over contacts that cost less in it than `steals` of what they cost now; in no part `cost_of_none`
//! kept where   sum of what its contacts then cost less > (unknowns + 1) ln(rows)
//! ```

use super::cloud::{FEWEST_POINTS, NEAREST};
use super::hypothesis::{Walk, begun_alike, begun_round, cost, grow, is_single};
use super::local::{LocalShape, Noise};
use super::partition::{Field, NONE, Partition, unlabelled};
use super::sheet::SheetLimit;
use crate::primitives::placed::Primitive;

/// Region after region, beside the parts that there are; with a `limit` only from contacts that lie on a sheet by it.
pub(super) fn grown(from: Partition, field: &Field, limit: Option<&SheetLimit>) -> Partition {
    let count = field.cloud.len();
    // those of planes through neighbours lean towards other faces on a narrow one, and tell no thin thing
    let mut walk =
        if field.has_clear_normals() { Walk::along_faces(count, field.tuning.parallel) } else { Walk::new(count) };
    let mut growing = Growing::new(from, field);
    for seed in smoothest_first(&growing.found.labels, field, limit) {
        if growing.tried[seed] || growing.found.labels[seed] != NONE {
            continue;
        }
        growing.tried[seed] = true;
        match growing.region(seed, &mut walk) {
            Some(region) => growing.add(region),
            None => growing.leave(seed),
        }
    }
    growing.found
}

/// Contacts of no part from which regions may begin, that with the least misfit of the surface through its neighbours first.
fn smoothest_first(labels: &[u32], field: &Field, limit: Option<&SheetLimit>) -> impl Iterator<Item = usize> + use<> {
    let (left, u): (Vec<u32>, &Noise) = (unlabelled(labels), &field.coarse);
    let misfit = |shape: &LocalShape| {
        let [z, n] = shape.variance;
        z / u.distance.powi(2) + 2.0 * n / u.normal.powi(2)
    };
    let begins = |(_, shape): &(u32, &LocalShape)| limit.is_none_or(|limit| limit.holds_contact(shape));
    let known = left.iter().copied().zip(field.shapes.of(field.cloud, &left));
    let mut order: Vec<(f64, u32)> = known.filter(begins).map(|(i, shape)| (misfit(shape), i)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, i)| i as usize)
}

/// A primitive, and the contacts that cost less in it than before, with what they cost.
struct GrownRegion {
    primitive: Primitive,
    better: Vec<(usize, f64)>,
}

/// The parts so far.
struct Growing<'a> {
    field: &'a Field<'a>,
    found: Partition,
    /// What every contact costs in its part.
    costs: Vec<f64>,
    tried: Vec<bool>,
    /// Parts that are settled, which keep what they explain.
    known: u32,
}

impl<'a> Growing<'a> {
    fn new(found: Partition, field: &'a Field<'a>) -> Growing<'a> {
        let (cloud, tuning) = (field.cloud, field.tuning);
        let cost_of = |i: usize| match found.labels[i] {
            NONE => tuning.cost_of_none,
            part => cost(&found.parts[part as usize], cloud.contact(i), &field.coarse, field.along(), tuning),
        };
        let costs = (0..cloud.len()).map(cost_of).collect();
        Growing { field, costs, tried: vec![false; cloud.len()], known: found.parts.len() as u32, found }
    }

    /// What a contact may cost in a region that takes it; none takes contacts of a settled part.
    fn most_of(&self, i: usize) -> f64 {
        let tuning = self.field.tuning;
        match self.found.labels[i] {
            NONE => tuning.cost_of_none,
            _ if self.field.shared => tuning.cost_of_none,
            part if part < self.known => 0.0,
            _ => tuning.steals * self.costs[i],
        }
    }

    /// The region about a contact, if it lowers the energy: of a face, else of a thin thing.
    fn region(&self, seed: usize, walk: &mut Walk) -> Option<GrownRegion> {
        let (cloud, tuning) = (self.field.cloud, self.field.tuning);
        let free = |i: usize| self.most_of(i) > 0.0;
        if is_single(cloud, seed, free) {
            return None;
        }
        let parallel = if self.field.shared { f64::NEG_INFINITY } else { tuning.parallel };
        let of_face = begun_alike((cloud, parallel), seed, walk, free).and_then(|first| self.region_from(&first, walk));
        let round = || begun_round((cloud, tuning.round), seed, free).filter(|_| self.field.has_clear_normals());
        of_face.or_else(|| self.region_from(&round()?, walk))
    }

    /// The region that begins with some contacts, if it lowers the energy.
    fn region_from(&self, first: &[u32], walk: &mut Walk) -> Option<GrownRegion> {
        let (cloud, u, along) = (self.field.cloud, &self.field.coarse, self.field.along());
        let tuning = self.field.tuning;
        let (primitive, members) = grow((cloud, u, along, tuning), first, walk, |i| self.most_of(i))?;
        let cost_of = |i: usize| cost(&primitive, cloud.contact(i), u, along, tuning);
        let costs = members.iter().map(|i| *i as usize).map(|i| (i, cost_of(i)));
        let better: Vec<(usize, f64)> = costs.filter(|(i, cost)| *cost < self.costs[*i]).collect();
        let gain: f64 = better.iter().map(|(i, cost)| self.costs[*i] - cost).sum();
        let rows = (4 * cloud.len()) as f64;
        let price = (primitive.kind.free().len() + 1) as f64 * rows.ln();
        let is_large = members.len() >= FEWEST_POINTS && better.len() >= FEWEST_POINTS / 2;
        (is_large && gain > price).then_some(GrownRegion { primitive, better })
    }

    fn add(&mut self, region: GrownRegion) {
        for (i, cost) in region.better {
            self.costs[i] = cost;
            self.found.labels[i] = self.found.parts.len() as u32;
        }
        self.found.parts.push(region.primitive);
    }

    /// No part begins here, nor right beside it.
    fn leave(&mut self, seed: usize) {
        let beside = if self.field.shared { NEAREST } else { self.field.tuning.barren.min(NEAREST) };
        self.field.cloud.near(seed)[..beside].iter().for_each(|&j| self.tried[j as usize] = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::cloud::Cloud;
    use crate::parts::surveyed::{LetPass, Surveyed};
    use crate::parts::tuning::PartsTuning;
    use crate::parts::{Parts, PartsOptions};
    use crate::primitives::placed::PartKind;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, unit};

    /// Two faces of a box, 20 by 20 contacts each, the second beyond x = 0.
    fn faces() -> Cloud {
        let place = |k: u32| (f64::from(k % 20) + 0.5, f64::from(k / 20));
        let top = (0..400).map(place).map(|(s, y)| ([-s, y, 0.0], [0.0, 0.0, 1.0]));
        let side = (0..400).map(place).map(|(s, y)| ([0.0, y, -s], [1.0, 0.0, 0.0]));
        let (points, normals): (Vec<Vector>, Vec<Vector>) = top.chain(side).unzip();
        Cloud::new(&points, normals).unwrap()
    }

    #[test]
    fn regions_end_at_an_edge_and_leave_settled_parts_alone() {
        let tuning = PartsTuning::default();
        let cloud = faces();
        let pass = LetPass::new(&cloud, None, false, &tuning);
        let surveyed = Surveyed::new(cloud, &pass, &tuning);
        let field = surveyed.field(&tuning);
        let nothing = Partition { parts: Vec::new(), labels: vec![NONE; 800] };
        let found = grown(nothing, &field, None);
        assert_eq!(found.parts.iter().map(|part| part.kind).collect::<Vec<_>>(), [PartKind::Plane; 2]);
        let of_one = |of: &[u32]| of.iter().filter(|label| **label == of[0]).count();
        assert!(of_one(&found.labels[..400]) > 380 && of_one(&found.labels[400..]) > 380);
        // the first face is settled with half of the second: what is its own stays, and the rest becomes a region
        let labels: Vec<u32> = (0..800).map(|i| if i < 600 { 0 } else { NONE }).collect();
        let settled = Partition { parts: vec![found.parts[found.labels[0] as usize]], labels };
        let again = grown(settled, &field, None);
        assert_eq!(again.parts.len(), 2);
        assert!(again.labels[..600].iter().all(|label| *label == 0));
    }

    /// A wall, and a ring on it of which some five contacts lie round its tube, one beside the other in no order; normals are off by 3
    /// degrees, places by a tenth of their spacing.
    fn wall_and_ring(seed: u64) -> (Vec<Vector>, Vec<Vector>) {
        let draws = EffectDraws::new(seed, "ring");
        let wall =
            (0..840_u32).map(|k| [f64::from(k % 30), f64::from(k / 30)]).map(|[x, y]| ([x, y, 0.0], [0.0, 0.0, 1.0]));
        let ring = (0..110_u32).map(|k| {
            let mut at = [0.0; 2];
            draws.uniforms(u64::from(k), 0, 2, &mut at);
            let (sin, cos) = (std::f64::consts::PI * at[0]).sin_cos();
            let (up, out) = (std::f64::consts::TAU * at[1]).sin_cos();
            let away = 7.0 + 0.75 * out;
            ([15.0 + away * cos, 15.0 + 0.75 * up, 0.5 + away * sin], [out * cos, up, out * sin])
        });
        let off = |k: usize, (p, n): (Vector, Vector)| {
            let mut noise = [0.0; 6];
            draws.gaussians(k as u64, 1, 6, &mut noise);
            let moved = |v: Vector, by: f64, from: usize| [0, 1, 2].map(|a| v[a] + by * noise[from + a]);
            (moved(p, 0.1, 0), unit(moved(n, 0.05, 3)))
        };
        wall.chain(ring).enumerate().map(|(k, contact)| off(k, contact)).unzip()
    }

    #[test]
    fn a_ring_of_few_contacts_round_is_a_part() {
        for seed in 1..=4 {
            let (points, normals) = wall_and_ring(seed);
            let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
            let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
            let [wall, ring] = &found.parts[..] else { panic!("{seed}: {:?}", found.parts) };
            assert_eq!([wall.kind, ring.kind], [PartKind::Plane, PartKind::Torus]);
            let off = (ring.geometry.minor_radius.unwrap() - 0.75).abs() / ring.u.minor_radius.unwrap();
            assert!(ring.points > 105 && off < 3.0, "{seed}: {off} {ring:?}");
        }
    }

    /// The rim of a mug's wall, two contacts wide, between its two sides.
    #[test]
    fn a_face_two_contacts_wide_is_one_part() {
        let draws = EffectDraws::new(2, "rim");
        let contact = |k: u32| -> (Vector, Vector) {
            let (mut at, mut off) = ([0.0; 2], [0.0; 3]);
            draws.uniforms(u64::from(k), 0, 2, &mut at);
            draws.gaussians(u64::from(k), 1, 3, &mut off);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let (radius, height, normal) = match k {
                0..600 => (10.0, 10.0 * at[1] - 10.0, [cos, sin, 0.0]),
                600..1000 => (7.5, 10.0 * at[1] - 10.0, [-cos, -sin, 0.0]),
                _ => (7.5 + 2.5 * at[1], 0.0, [0.0, 0.0, 1.0]),
            };
            let place = [radius * cos + 0.1 * off[0], radius * sin + 0.1 * off[1], height + 0.1 * off[2]];
            (place, unit([0, 1, 2].map(|a| normal[a] + 0.05 * off[(a + 1) % 3])))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..1130).map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        let told: Vec<(PartKind, usize)> = found.parts.iter().map(|part| (part.kind, part.points)).collect();
        let [(PartKind::Cylinder, outer), (PartKind::Cylinder, inner), (PartKind::Plane, rim)] = told[..] else {
            panic!("{told:?}")
        };
        assert!(outer > 590 && inner > 390 && rim > 120, "{told:?}");
    }
}
