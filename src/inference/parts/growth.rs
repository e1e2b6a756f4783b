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
