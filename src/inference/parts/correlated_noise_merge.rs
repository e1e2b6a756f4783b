//! Small parts that are no more than the waves of the part around them.
//!
//! ```text
//! D_a, N_a     rms distance and rms change of the normal of part a's contacts under the primitive of its neighbour b
//! D_g, N_g     the same of groups g of as many connected contacts inside b
//! a joins b    where D_a <= max D_g and N_a <= max N_g
//! ```
//!
//! A scanner errs alike over many contacts, and how far it errs stands in the cloud: a part departs from its primitive by as
//! much in groups of every size. What departs from a neighbour no farther than the neighbour's own groups of the same size is
//! not seen to be another part. Independent errors leave groups with hardly a departure, so that a groove a few times
//! as deep as the noise stays a groove.

use super::cloud::Cloud;
use super::hypothesis::Walk;
use super::partition::{Field, NONE, Partition};
use crate::primitives::placed::Primitive;
use palpate_numeric::vector::{dot, minus};

/// A neighbour is asked when it holds so many groups of the part's size: fewer say little of its waves.
const GROUPS: usize = 5;

/// Places of groups in the neighbour, spread evenly over its contacts.
const PLACES: usize = 64;

/// Joins every part to a neighbour whose waves are as large, smallest parts first; gives back whether any was.
pub(super) fn absorb(partition: &mut Partition, field: &Field) -> bool {
    let cloud = field.cloud;
    let members = partition.members();
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by_key(|part| (members[*part].len(), *part));
    let inner: Vec<Vec<u32>> = members.iter().map(|of_part| partition.inner(cloud, of_part)).collect();
    let mut walk = Walk::new(cloud.len());
    let mut gone = vec![false; members.len()];
    for a in order {
        let around = neighbours(cloud, &partition.labels, &members[a], a as u32);
        // across a gap in the scan there is no contact next to it
        let others = (0..members.len()).filter(|b| *b != a && !around.contains(b)).collect::<Vec<_>>();
        let large = |b: &usize| !gone[*b] && inner[*b].len() >= GROUPS * members[a].len();
        let into = around.into_iter().chain(others).filter(large).find(|&b| {
            let primitive = &partition.parts[b];
            let own = departures(cloud, primitive, &members[a]);
            let is_within = |[distance, normal]: [f64; 2]| own[0] <= distance && own[1] <= normal;
            // most neighbours are seen to be other surfaces before any group is looked at
            is_within(most_possible(cloud, primitive, &inner[b], members[a].len()))
                && is_within(largest(cloud, &mut walk, primitive, &inner[b], members[a].len()))
        });
        if let Some(b) = into {
            gone[a] = true;
            members[a].iter().for_each(|&i| partition.labels[i as usize] = b as u32);
        }
    }
    partition.keep(|part| !gone[part]);
    gone.contains(&true)
}

/// Parts with contacts next to these, the one with the most of them first.
fn neighbours(cloud: &Cloud, labels: &[u32], members: &[u32], own: u32) -> Vec<usize> {
    let mut met: Vec<u32> =
        members.iter().flat_map(|&i| cloud.linked(i as usize)).map(|&j| labels[j as usize]).collect();
    met.retain(|label| *label != own && *label != NONE);
    met.sort_unstable();
    let mut counts: Vec<(usize, u32)> = met.chunk_by(|a, b| a == b).map(|run| (run.len(), run[0])).collect();
    counts.sort_by_key(|(count, label)| (std::cmp::Reverse(*count), *label));
    counts.into_iter().map(|(_, label)| label as usize).collect()
}

/// Squares of the distance and of the change of the normal of a contact.
fn squares(cloud: &Cloud, primitive: &Primitive, i: u32) -> [f64; 2] {
    let (d, normal) = primitive.nearest(cloud.points[i as usize]);
    let off = minus(normal, cloud.normals[i as usize]);
    [d * d, dot(off, off)]
}

/// Their means.
fn departures(cloud: &Cloud, primitive: &Primitive, members: &[u32]) -> [f64; 2] {
    let sums = members.iter().fold([0.0; 2], |sums, &i| {
        let of_contact = squares(cloud, primitive, i);
        [0, 1].map(|k| sums[k] + of_contact[k])
    });
    sums.map(|sum| sum / members.len().max(1) as f64)
}

/// What no group of `size` or half as many can have more of: the means of the largest.
fn most_possible(cloud: &Cloud, primitive: &Primitive, inner: &[u32], size: usize) -> [f64; 2] {
    let all: Vec<[f64; 2]> = inner.iter().map(|&i| squares(cloud, primitive, i)).collect();
    let fewest = size.div_ceil(2).min(all.len());
    [0, 1].map(|k| {
        let mut of: Vec<f64> = all.iter().map(|both| both[k]).collect();
        if fewest < of.len() {
            of.select_nth_unstable_by(fewest, |a, b| b.total_cmp(a));
        }
        of[..fewest].iter().sum::<f64>() / fewest.max(1) as f64
    })
}

/// The largest of both over connected groups of `size` contacts.
fn largest(cloud: &Cloud, walk: &mut Walk, primitive: &Primitive, inner: &[u32], size: usize) -> [f64; 2] {
    let mut is_inner = vec![false; cloud.len()];
    inner.iter().for_each(|&i| is_inner[i as usize] = true);
    let mut largest = [0.0_f64; 2];
    for k in 0..PLACES.min(inner.len()) {
        let place = inner[k * inner.len() / PLACES.min(inner.len())];
        let group = walk.reach(cloud, &[place], size, |i| is_inner[i]);
        if 2 * group.len() < size {
            continue;
        }
        let found = departures(cloud, primitive, &group);
        largest = [0, 1].map(|k| largest[k].max(found[k]));
    }
    largest
}
