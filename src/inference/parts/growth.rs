//! Region after region, from the smoothest place that none explains.
//!
//! ```text
//! region(p)    grown from p over contacts that cost less in it than `steals` of what they cost now; in no part CAP
//! kept where   sum of what its contacts then cost less > (unknowns + 1) ln(rows)
//! ```

use super::cloud::{FEWEST_POINTS, NEAREST};
use super::hypothesis::{CAP, Walk, cost, grow};
use super::partition::{Field, NONE, Partition};
use super::sheet::SheetLimit;
use crate::primitives::placed::Primitive;

/// Region after region, beside the parts that there are; with a `limit` only from contacts that lie on a sheet by it.
pub(super) fn grown(from: Partition, field: &Field, limit: Option<&SheetLimit>) -> Partition {
    let mut walk = Walk::new(field.cloud.len());
    let mut growing = Growing::new(from, field);
    for seed in smoothest_first(field, limit) {
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

/// Contacts from which regions may begin, that with the least misfit of the surface through its neighbours first.
fn smoothest_first(field: &Field, limit: Option<&SheetLimit>) -> impl Iterator<Item = usize> {
    let (shapes, u) = (field.shapes, &field.coarse);
    let misfit = |i: usize| {
        let [z, n] = shapes[i].variance;
        z / u.distance.powi(2) + 2.0 * n / u.normal.powi(2)
    };
    let begins = |i: &usize| limit.is_none_or(|limit| limit.holds_contact(&shapes[*i]));
    let mut order: Vec<(f64, u32)> = (0..shapes.len()).filter(begins).map(|i| (misfit(i), i as u32)).collect();
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
        let cloud = field.cloud;
        let cost_of = |i: usize| match found.labels[i] {
            NONE => CAP,
            part => cost(&found.parts[part as usize], cloud.points[i], cloud.normals[i], &field.coarse),
        };
        let costs = (0..cloud.len()).map(cost_of).collect();
        Growing { field, costs, tried: vec![false; cloud.len()], known: found.parts.len() as u32, found }
    }

    /// What a contact may cost in a region that takes it; none takes contacts of a settled part.
    fn most_of(&self, i: usize) -> f64 {
        match self.found.labels[i] {
            NONE => CAP,
            _ if self.field.shared => CAP,
            part if part < self.known => 0.0,
            _ => self.field.tuning.steals * self.costs[i],
        }
    }

    /// The region about a contact, if it lowers the energy.
    fn region(&self, seed: usize, walk: &mut Walk) -> Option<GrownRegion> {
        let (cloud, u) = (self.field.cloud, &self.field.coarse);
        let parallel = if self.field.shared { f64::NEG_INFINITY } else { self.field.tuning.parallel };
        let (primitive, members) = grow((cloud, u, parallel), seed, walk, |i| self.most_of(i))?;
        let costs =
            members.iter().map(|i| *i as usize).map(|i| (i, cost(&primitive, cloud.points[i], cloud.normals[i], u)));
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
    use crate::primitives::placed::PartKind;
    use palpate_numeric::vector::Vector;

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
        let pass = LetPass::new(&cloud, None, false);
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
}
