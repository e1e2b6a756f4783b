//! Which two parts are one.
//!
//! ```text
//! joined where one primitive explains what both explain as well (`evidence.rs`), the pair that gains most first, until none does
//! ```
//!
//! What neither explains is of neither: it is left out of the comparison, lest contacts off an edge keep two halves of a face apart. Where
//! neighbours share errors it is not: most that stands off is of the surface then.

use std::collections::HashSet;

use super::cloud::Cloud;
use super::evidence::Residuals;
use super::hypothesis::{best, cost, sampled};
use super::partition::{Field, NONE, Partition};
use crate::primitives::descent::Sample;
use crate::primitives::placed::Primitive;
use palpate_numeric::threads;

/// Points that two parts are judged by when they are to be joined.
const JUDGED: usize = 200;

/// By how much one primitive beats two parts, if it does, and that primitive: of each part its number and inner contacts, and whether some
/// are next to each other.
pub(super) type PairGain<'a> =
    dyn Fn(&Partition, (usize, &[u32]), (usize, &[u32]), bool) -> Option<(f64, Primitive)> + Sync + 'a;

impl Partition {
    /// Joins pairs of parts, the one that lowers the energy most first, until none does.
    pub(super) fn join(&mut self, field: &Field) -> bool {
        self.join_by(field, &|parts, one, two, adjacent| parts.gain_of_joining(field, one, two, adjacent))
    }

    /// The same by any gain of a pair.
    pub(super) fn join_by(&mut self, field: &Field, gain: &PairGain) -> bool {
        let mut joined = false;
        let pairs: Vec<(usize, usize)> = (0..self.parts.len()).flat_map(|b| (0..b).map(move |a| (a, b))).collect();
        let mut gains = self.gains(field, &pairs, gain);
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
            gains.extend(self.gains(field, &new, gain));
        }
        joined
    }

    /// The pairs of which joining lowers the energy, by how much and to which primitive.
    fn gains(&self, field: &Field, pairs: &[(usize, usize)], gain: &PairGain) -> Vec<(f64, Primitive, (usize, usize))> {
        let cloud = field.cloud;
        let members = self.members();
        let inner = threads::map(members.len(), 1, |part| self.inner(cloud, &members[part], field.tuning));
        let adjacent = self.adjacent(cloud);
        let judged = threads::map(pairs.len(), 1, |k| {
            let (a, b) = pairs[k];
            gain(self, (a, &inner[a]), (b, &inner[b]), adjacent.contains(&(a as u32, b as u32)))
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
        let cloud = field.cloud;
        let [u, pass] = [field.coarse, field.pass].map(|noise| field.told(noise));
        let [one, two] = [self.parts[a], self.parts[b]];
        let (of_a, of_b) = (&field.judged(of_a, &one), &field.judged(of_b, &two));
        let (mut points, mut normals) = sampled(cloud, of_a, JUDGED);
        let first = points.len();
        let (more_points, more_normals) = sampled(cloud, of_b, JUDGED);
        points.extend(more_points);
        normals.extend(more_normals);
        let mean = |primitive: &Primitive, from: usize, to: usize| -> f64 {
            (from..to).map(|k| cost(primitive, (points[k], normals[k]), &u, field.along(), field.tuning)).sum::<f64>()
                / (to - from) as f64
        };
        // a primitive that explains nothing of the other part, nor the other way round, has nothing to do with it
        let foreign = if adjacent { 0.98 } else { 0.7 } * field.tuning.cost_of_none;
        if mean(&one, first, points.len()) > foreign && mean(&two, 0, first) > foreign {
            return None;
        }
        let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
        let joint = best(&sample, &[one, two], field.tuning)?.primitive;
        let (mut together, mut apart) = (Residuals::default(), Residuals::default());
        together.add(cloud, of_a, &joint);
        together.add(cloud, of_b, &joint);
        apart.add(cloud, of_a, &one);
        apart.add(cloud, of_b, &two);
        let unknowns = |p: &Primitive| p.kind.free().len();
        let more = (unknowns(&one) + unknowns(&two) + 1).saturating_sub(unknowns(&joint));
        let lost = together.lose_to(&apart, more, field.cells, &pass);
        (lost < 0.0).then_some((-lost, joint))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::surveyed::{LetPass, Surveyed};
    use crate::parts::tuning::PartsTuning;
    use crate::primitives::placed::PartKind;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, along, axes_along};

    /// How many parts are left of two halves of 20 by 20 contacts whose normals differ by so many degrees.
    fn left(degrees: f64) -> usize {
        let draws = EffectDraws::new(2, "halves");
        let half = |turn: f64, sign: f64| {
            let (sin, cos) = (0.5 * turn.to_radians()).sin_cos();
            let draws = &draws;
            (0..400_u32).map(move |k| {
                let mut off = [0.0];
                draws.gaussians(u64::from(sign > 0.0), u64::from(k), 1, &mut off);
                let [s, y] = [f64::from(k % 20) + 0.5, f64::from(k / 20)];
                let normal = [sign * sin, 0.0, cos];
                (along([sign * s * cos, y, -s * sin], 0.05 * off[0], normal), normal)
            })
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = half(degrees, -1.0).chain(half(degrees, 1.0)).unzip();
        let cloud = Cloud::new(&points, normals).unwrap();
        let tuning = PartsTuning::default();
        let pass = LetPass::new(&cloud, None, false, &tuning);
        let surveyed = Surveyed::new(cloud, &pass, &tuning);
        let field = surveyed.field(&tuning);
        let plane = |i: usize| Primitive {
            kind: PartKind::Plane,
            origin: field.cloud.points[i],
            axes: axes_along(field.cloud.normals[i]),
            sizes: [0.0; 3],
            side: 1.0,
        };
        let labels = (0..800).map(|i| u32::from(i >= 400)).collect();
        let mut cut = Partition { parts: vec![plane(210), plane(610)], labels };
        cut.refit(&field);
        cut.join(&field);
        cut.parts.len()
    }

    #[test]
    fn halves_of_one_plane_are_joined_and_faces_with_an_edge_are_not() {
        assert_eq!(left(0.0), 1);
        assert_eq!(left(20.0), 2);
    }
}
