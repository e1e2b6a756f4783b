//! Which primitive a set of points shows, and how far about a point it reaches.
//!
//! ```text
//! cost(p) = min(d^2 / u_d^2 + |n(p) - n|^2 / (u_n^2 + R^2 s^2) + sum_k ln(1 + (k s / u_n)^2), c)        s: error along the surface
//! score = sum of d^2 / u_d^2 + |n(p) - n|^2 / u_n^2 + unknowns ln(rows)
//! grow: fit the region, take the connected points that cost less than c, at most twice as many, and fit again        c: `cost_of_none`
//! ```
//!
//! The kind is chosen anew at every size: what looks flat while it is small is a cylinder when it has grown. P. J. Besl and
//! R. C. Jain, *Segmentation through variable-order surface fitting*, IEEE PAMI 10 (1988) 167.

use super::cloud::{Cloud, LINKED, NEAREST};
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::primitives::descent::{Descended, Sample, descend_roughly, sum_of_squares};
use crate::primitives::placed::{PartKind, Primitive};
use crate::primitives::starts::starts;
use palpate_numeric::statistics::evenly_among;
use palpate_numeric::vector::{Vector, along, dot, minus, norm};

/// Points that a growing region is fitted to: with 4 rows each they settle 7 unknowns, and more only take time.
const SAMPLED: usize = 300;

/// Most rounds of growth; each may double the region.
const ROUNDS: usize = 40;

/// What a contact costs under a primitive. A place that is off `along` the surface has the normal of another foot: on a tube as thin as
/// ten such errors, normals are off by six degrees beside their own.
pub(super) fn cost(
    primitive: &Primitive,
    (p, n): (Vector, Vector),
    u: &Noise,
    along: f64,
    tuning: &PartsTuning,
) -> f64 {
    let most = tuning.cost_of_none;
    let (d, normal) = primitive.nearest(p);
    let off = minus(normal, n);
    let (distance, normals) = ((d / u.distance).powi(2), dot(off, off) / u.normal.powi(2));
    if primitive.kind == PartKind::Plane || distance >= most || along == 0.0 {
        return (distance + normals).min(most);
    }
    let [one, two] = primitive.curvatures(p).map(|k| (k * along / u.normal).powi(2));
    (distance + normals / (1.0 + 0.5 * (one + two)) + one.ln_1p() + two.ln_1p()).min(most)
}

/// A primitive with its score over the points that it was fitted to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scored {
    pub(super) primitive: Primitive,
    pub(super) score: f64,
}

/// Points and normals of some members, `most` at the most, evenly among them.
pub(super) fn sampled(cloud: &Cloud, members: &[u32], most: usize) -> (Vec<Vector>, Vec<Vector>) {
    let taken = evenly_among(members.len(), most).map(|k| members[k] as usize);
    taken.map(|i| (cloud.points[i], cloud.normals[i])).unzip()
}

/// The kind that explains these points with the least score; `before` is one more place to start from.
pub(super) fn best(sample: &Sample, before: &[Primitive], tuning: &PartsTuning) -> Option<Scored> {
    let rows = (4 * sample.points.len()) as f64;
    let extent = extent(sample.points);
    let mut found: Option<Scored> = None;
    for kind in PartKind::EXACT {
        let price = kind.free().len() as f64 * rows.ln();
        // a sum of zero would not pay for the unknowns
        if found.is_some_and(|best| price >= best.score) {
            continue;
        }
        let Some(descended) = descended(kind, sample, before, extent, tuning) else { continue };
        let score = descended.sum + price;
        if found.is_none_or(|best| score < best.score) {
            found = Some(Scored { primitive: descended.primitive, score });
        }
    }
    found
}

/// The best descent of one kind, to the digits that tell it from others.
pub(super) fn descended(
    kind: PartKind,
    sample: &Sample,
    before: &[Primitive],
    extent: f64,
    tuning: &PartsTuning,
) -> Option<Descended> {
    let mut all = starts(kind, sample);
    all.extend(before.iter().filter(|p| p.kind == kind));
    all.retain(|start| start.is_sound(1e3 * extent));
    // of several starts the two nearest to the points are worth a descent
    let mut rated: Vec<(f64, Primitive)> =
        all.into_iter().map(|start| (sum_of_squares(&start, sample), start)).collect();
    rated.sort_by(|a, b| a.0.total_cmp(&b.0));
    let found = rated.iter().take(2).filter_map(|(_, start)| descend_roughly(start, sample));
    let is_sound = |d: &Descended| d.primitive.is_sound(extent) && d.sum.is_finite();
    let least = |a: Descended, b: Descended| if b.sum < a.sum { b } else { a };
    let found = found.filter(is_sound).reduce(least)?;
    // rows of a whole ring are nowhere near those of its dual, and a descent would be for nothing
    let dual = found.primitive.dual_ring(middle(sample.points));
    let most = tuning.cost_of_none * sample.points.len() as f64;
    let near = dual.filter(|dual| dual.is_sound(extent) && sum_of_squares(dual, sample) < most);
    let other = near.and_then(|dual| descend_roughly(&dual, sample)).filter(is_sound);
    Some(other.map_or(found, |other| least(found, other)))
}

/// The mean of some points.
fn middle(points: &[Vector]) -> Vector {
    points.iter().fold([0.0; 3], |sum, p| along(sum, 1.0 / points.len() as f64, *p))
}

/// The largest side of the points' box.
pub(super) fn extent(points: &[Vector]) -> f64 {
    let range = |k: usize| {
        let (lo, hi) =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p[k]), hi.max(p[k])));
        hi - lo
    };
    (0..3).map(range).fold(0.0, f64::max)
}

/// Walks through the cloud, from a contact to those next to it, and to the nearest that face as it does: on a strip of a face that is two
/// contacts wide most of those next to one are of other faces.
#[derive(Debug)]
pub(super) struct Walk {
    visited: Vec<u32>,
    walk: u32,
    /// Cosine from which on two contacts face the same way.
    parallel: f64,
}

impl Walk {
    /// From each contact to those next to it alone.
    pub(super) fn new(points: usize) -> Walk {
        Walk::along_faces(points, f64::NEG_INFINITY)
    }

    /// To the nearest that face alike, too: within this cosine.
    pub(super) fn along_faces(points: usize, parallel: f64) -> Walk {
        Walk { visited: vec![0; points], walk: 0, parallel }
    }

    /// The connected points about `from` for which `takes` holds, nearest first in links, at most `most`.
    pub(super) fn reach(
        &mut self,
        cloud: &Cloud,
        from: &[u32],
        most: usize,
        takes: impl Fn(usize) -> bool,
    ) -> Vec<u32> {
        self.walk += 1;
        let mut found = Vec::new();
        for &i in from {
            if self.visited[i as usize] != self.walk && takes(i as usize) {
                self.visited[i as usize] = self.walk;
                found.push(i);
            }
        }
        let mut next = 0;
        while next < found.len() && found.len() < most {
            let i = found[next] as usize;
            next += 1;
            let faces_alike = |j: &&u32| dot(cloud.normals[i], cloud.normals[**j as usize]) > self.parallel;
            let beyond = cloud.near(i).iter().filter(faces_alike).take(LINKED);
            for &j in cloud.linked(i).iter().chain(beyond) {
                if self.visited[j as usize] != self.walk {
                    self.visited[j as usize] = self.walk;
                    if takes(j as usize) {
                        found.push(j);
                    }
                }
            }
        }
        found
    }
}

/// Contacts that a region begins with: neighbours whose normals are nearly the first's own, since on a narrow face most neighbours are of
/// others. Where these are hardly any, the face is a few contacts wide, and a walk from one of them to the next follows it.
pub(super) fn begun_alike(
    (cloud, parallel): (&Cloud, f64),
    seed: usize,
    walk: &mut Walk,
    free: impl Fn(usize) -> bool,
) -> Option<Vec<u32>> {
    let is_alike = |j: usize| free(j) && dot(cloud.normals[seed], cloud.normals[j]) > parallel;
    let near = cloud.near(seed).iter().copied().filter(|j| is_alike(*j as usize));
    let first: Vec<u32> = std::iter::once(seed as u32).chain(near).collect();
    let first = if first.len() > LINKED { first } else { walk.reach(cloud, &[seed as u32], NEAREST, is_alike) };
    (first.len() > LINKED).then_some(first)
}

/// Contacts that a thin thing begins with, where a few of them reach all round a bar, ring or pin: neighbours whose normals cancel to
/// `round` and less of their number.
pub(super) fn begun_round(
    (cloud, round): (&Cloud, f64),
    seed: usize,
    free: impl Fn(usize) -> bool,
) -> Option<Vec<u32>> {
    let near = cloud.near(seed).iter().copied().filter(|j| free(*j as usize));
    let first: Vec<u32> = std::iter::once(seed as u32).chain(near).collect();
    let sum = first.iter().fold([0.0; 3], |sum, i| along(sum, 1.0, cloud.normals[*i as usize]));
    (first.len() > LINKED && norm(sum) < round * first.len() as f64).then_some(first)
}

/// Whether a contact lies singly among those of other parts; no region begins there.
pub(super) fn is_single(cloud: &Cloud, seed: usize, free: impl Fn(usize) -> bool) -> bool {
    2 * cloud.linked(seed).iter().filter(|j| free(**j as usize)).count() < LINKED
}

/// The primitive about the contacts that a region begins with, and the connected ones that it explains at less than `most_of` each.
pub(super) fn grow(
    (cloud, u, along, tuning): (&Cloud, &Noise, f64, &PartsTuning),
    first: &[u32],
    walk: &mut Walk,
    most_of: impl Fn(usize) -> f64,
) -> Option<(Primitive, Vec<u32>)> {
    let free = |i: usize| most_of(i) > 0.0;
    let mut members = first.to_vec();
    let mut before: Vec<Primitive> = Vec::new();
    let mut stable = 0;
    for _ in 0..ROUNDS {
        let (points, normals) = sampled(cloud, &members, SAMPLED);
        let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
        let primitive = best(&sample, &before, tuning)?.primitive;
        let most = 2 * members.len() + NEAREST;
        let takes = |i: usize| free(i) && cost(&primitive, cloud.contact(i), u, along, tuning) < most_of(i);
        let taken = walk.reach(cloud, first, most, takes);
        if 2 * taken.len() < first.len() {
            return None;
        }
        let settled = taken.len() < most && taken.len().abs_diff(members.len()) <= members.len() / 50;
        stable = if settled { stable + 1 } else { 0 };
        members = taken;
        before = vec![primitive];
        if stable == 2 {
            break;
        }
    }
    before.pop().map(|primitive| (primitive, members))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::EffectDraws;

    /// A tenth of a groove, begun at the ring that has the groove's axis for its tube.
    #[test]
    fn a_piece_of_a_groove_is_fitted_by_its_own_ring_whichever_it_begins_with() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let groove = Primitive { kind: PartKind::Torus, origin: [0.0; 3], axes, sizes: [10.0, 1.5, 0.0], side: -1.0 };
        let draws = EffectDraws::new(3, "groove");
        let contact = |k: u32| {
            let mut off = [0.0; 1];
            draws.gaussians(0, u64::from(k), 1, &mut off);
            let [u, v] = [f64::from(k % 25) / 40.0 - 0.3, f64::from(k / 25) / 5.0 - 0.9];
            let out = [-v.cos() * u.cos(), -v.cos() * u.sin(), v.sin()];
            let tube = 1.5 + 0.01 * off[0];
            let place = [10.0 * u.cos() + tube * out[0], 10.0 * u.sin() + tube * out[1], tube * out[2]];
            (place, out.map(|c| -c))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..250).map(contact).unzip();
        let sample = Sample { points: &points, normals: &normals, u_distance: 0.01, u_normal: 0.02 };
        let dual = groove.dual_ring([8.5, 0.0, 0.0]).unwrap();
        let alone = descend_roughly(&dual, &sample).unwrap().primitive;
        assert!(alone.sizes[1] > 3.0, "{alone:?}");
        let tuning = PartsTuning::default();
        let found = descended(PartKind::Torus, &sample, &[dual], extent(&points), &tuning).unwrap().primitive;
        assert!((found.sizes[0] - 10.0).abs() < 0.3 && (found.sizes[1] - 1.5).abs() < 0.02, "{found:?}");
    }
}
