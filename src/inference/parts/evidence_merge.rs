//! Parts that are one surface, and kinds that are simpler, where neighbours may share errors.
//!
//! ```text
//! one        ln p(one primitive) - ln p(two) > -price(unknowns of two + 1 - unknowns of one) - ln 2 (steps of the boundary)
//! simpler    ln p(simpler kind) - ln p(kind) > -price(unknowns that it has less)             ln p: `correlated_likelihood.rs`
//! ```
//!
//! Regions grow along waves of errors with whatever ring or cone is near, and each tells its own contacts better than the surface does that
//! they are of. What that surface leaves over is probable all the same where errors are shared as it shows, and improbable where a part has
//! an edge. A boundary is drawn from contact to contact, and every step goes one of two ways.

use std::f64::consts::LN_2;

use super::cell_means::NeighbourCells;
use super::correlated_likelihood::CorrelatedErrors;
use super::evidence::Residuals;
use super::hypothesis::{descended, extent, sampled};
use super::local::{Noise, ROUNDING};
use super::partition::{Field, Partition, SWEEPS};
use crate::primitives::descent::{Sample, descend};
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::threads;

/// Contacts that a kind is fitted to before it is known to be near.
const FITTED: usize = 400;

/// Contacts, and the primitives that tell them now, each so many of them in their order: of two parts that may be one, or of one whose kind
/// may be simpler.
struct MergeCandidate<'a> {
    field: &'a Field<'a>,
    cells: NeighbourCells,
    now: Vec<(Primitive, usize)>,
    /// What contacts scatter by about these, with what is let pass.
    scatter: Noise,
}

impl<'a> MergeCandidate<'a> {
    /// Of the contacts that each primitive explains, among these.
    fn new(field: &'a Field<'a>, parts: &[(Primitive, &[u32])]) -> MergeCandidate<'a> {
        let (mut now, mut members, mut residuals) = (Vec::new(), Vec::new(), Residuals::default());
        for (primitive, of_part) in parts {
            let own = field.judged(of_part, primitive);
            residuals.add(field.cloud, &own, primitive);
            now.push((*primitive, own.len()));
            members.extend(own);
        }
        let scatter = residuals.spread(&field.told(field.pass), 1.0);
        // where nothing is let pass, contacts may lie on their parts to the last digit
        let scatter = Noise { distance: scatter.distance.max(ROUNDING), normal: scatter.normal.max(ROUNDING) };
        MergeCandidate { field, cells: NeighbourCells::new(field.cloud, members), now, scatter }
    }

    /// The kind with most evidence over these primitives, among those with fewer unknowns than they have together, and by how much, where the
    /// boundary between them costs so much.
    fn best_instead(&self, boundary: f64) -> Option<(f64, Primitive)> {
        let unknowns = self.now.iter().map(|(primitive, _)| primitive.kind.free().len() + 1).sum::<usize>() - 1;
        let kinds = PartKind::EXACT.into_iter().filter(|kind| kind.free().len() < unknowns);
        let near: Vec<(Primitive, f64)> = kinds.filter_map(|kind| self.fitted(kind)).collect();
        if near.is_empty() {
            return None;
        }
        let errors = CorrelatedErrors::new(&self.cells, &self.scatter, self.field.tuning);
        let means = |told: &[(Primitive, usize)]| self.cells.means(self.field.cloud, told, &self.scatter);
        let own = means(&self.now);
        let law = errors.likeliest(&own)?;
        let most = errors.log_density(&own, &law);
        let gain = |(primitive, independent): (Primitive, f64)| {
            let less = unknowns - primitive.kind.free().len();
            let found = errors.log_density(&means(&[(primitive, self.cells.members.len())]), &law);
            (found - most + self.field.cells.price(less, independent) + boundary, primitive)
        };
        let gains = near.into_iter().map(gain).filter(|(gain, _)| *gain > 0.0);
        gains.reduce(|a, b| if b.0 > a.0 { b } else { a })
    }

    /// A kind where it is near, and how many residuals are then independent.
    fn fitted(&self, kind: PartKind) -> Option<(Primitive, f64)> {
        let (field, members) = (self.field, &self.cells.members);
        let before: Vec<Primitive> = self.now.iter().map(|(primitive, _)| *primitive).collect();
        let u = field.told(field.coarse);
        let (points, normals) = sampled(field.cloud, members, FITTED);
        let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: u.normal };
        let rough = descended(kind, &sample, &before, extent(&points), field.tuning)?.primitive;
        self.residuals_if_near(&rough)?;
        let (points, normals) = sampled(field.cloud, members, usize::MAX);
        let sample = Sample { points: &points, normals: &normals, ..sample };
        let primitive = descend(&rough, &sample)?.primitive;
        let residuals = self.residuals_if_near(&primitive)?;
        Some((primitive, residuals.independent(field.cells)))
    }

    fn residuals_if_near(&self, primitive: &Primitive) -> Option<Residuals> {
        let mut residuals = Residuals::default();
        residuals.add(self.field.cloud, &self.cells.members, primitive);
        let own = residuals.spread(&self.field.told(self.field.pass), 1.0);
        let most = self.field.tuning.merged_scatter;
        let is_near = own.distance < most * self.scatter.distance;
        let leans_alike = !own.normal.is_finite() || own.normal < most * self.scatter.normal;
        (is_near && leans_alike).then_some(residuals)
    }
}

impl Partition {
    /// Joins pairs of neighbouring parts and simplifies kinds while that has more evidence, and gives contacts to what the parts have become.
    pub(super) fn merge_by_evidence(&mut self, field: &Field) {
        let mut merged = self.clone();
        if merged.merge(field) && merged.outtells(self, field) {
            *self = merged;
        }
    }

    fn merge(&mut self, field: &Field) -> bool {
        let joined = self.join_by(field, &|partition, (a, of_a), (b, of_b), adjacent| {
            let pair = [(partition.parts[a], of_a), (partition.parts[b], of_b)];
            if adjacent {
                MergeCandidate::new(field, &pair).best_instead(partition.boundary(field, a, b))
            } else {
                None
            }
        });
        let members = self.members();
        let simpler = threads::map(members.len(), 1, |part| {
            let (_, primitive) = MergeCandidate::new(field, &[(self.parts[part], &members[part])]).best_instead(0.0)?;
            Some(primitive)
        });
        let any = joined || simpler.iter().any(Option::is_some);
        if any {
            self.replace(simpler);
            let scatter = self.scatter(field);
            (0..SWEEPS).for_each(|_| self.relabel(field, &scatter));
            self.drop_small();
        }
        any
    }

    /// What the boundary between two parts costs; half of the contacts beside it are on either side.
    fn boundary(&self, field: &Field, a: usize, b: usize) -> f64 {
        let [a, b] = [a as u32, b as u32];
        let is_beside = |i: &usize| {
            let other = match self.labels[*i] {
                own if own == a => b,
                own if own == b => a,
                _ => return false,
            };
            field.cloud.linked(*i).iter().any(|j| self.labels[*j as usize] == other)
        };
        0.5 * LN_2 * (0..field.cloud.len()).filter(is_beside).count() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::cloud::Cloud;
    use crate::parts::surveyed::{LetPass, Surveyed};
    use crate::parts::tuning::PartsTuning;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, axes_along, unit};

    const SIDE: u32 = 32;

    /// Kinds that are left of two halves of a face that waves by `waves` and of which one leans by so many degrees.
    fn left(waves: f64, degrees: f64) -> Vec<PartKind> {
        let draws = EffectDraws::new(4, "halves");
        let lean = degrees.to_radians().tan();
        let contact = |k: u32| -> (Vector, Vector) {
            let [x, y] = [k % SIDE, k / SIDE].map(|i| f64::from(i) - 15.5);
            let mut own = [0.0; 3];
            draws.gaussians(0, u64::from(k), 3, &mut own);
            let (phase, other) = (0.8 * x + 0.3 * y, 0.4 * x - 0.9 * y);
            let slope = if x > 0.0 { lean } else { 0.0 };
            let height = waves * (phase.sin() + other.cos()) + slope * x + 0.15 * own[0];
            let leans = [
                waves * (0.8 * phase.cos() - 0.4 * other.sin()) + slope + 0.03 * own[1],
                waves * (0.3 * phase.cos() + 0.9 * other.sin()) + 0.03 * own[2],
            ];
            ([x, y, height], unit([-leans[0], -leans[1], 1.0]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..SIDE * SIDE).map(contact).unzip();
        let cloud = Cloud::new(&points, normals).unwrap();
        let tuning = PartsTuning::default();
        let pass = LetPass::new(&cloud, None, false, &tuning);
        let surveyed = Surveyed::new(cloud, &pass, &tuning);
        let field = surveyed.field(&tuning);
        let plane = |normal: Vector| Primitive {
            kind: PartKind::Plane,
            origin: field.cloud.points[(SIDE * SIDE / 2 + SIDE / 2) as usize],
            axes: axes_along(unit(normal)),
            sizes: [0.0; 3],
            side: 1.0,
        };
        let labels = (0..SIDE * SIDE).map(|k| u32::from(k % SIDE >= SIDE / 2)).collect();
        let mut cut = Partition { parts: vec![plane([0.0, 0.0, 1.0]), plane([-lean, 0.0, 1.0])], labels };
        cut.merge_by_evidence(&field);
        cut.parts.iter().map(|part| part.kind).collect()
    }

    #[test]
    fn halves_of_a_face_that_waves_are_one_and_faces_with_an_edge_are_two() {
        assert_eq!(left(0.0, 0.0), [PartKind::Plane]);
        assert_eq!(left(0.1, 0.0), [PartKind::Plane]);
        assert_eq!(left(0.0, 8.0), [PartKind::Plane; 2]);
        assert_eq!(left(0.1, 15.0), [PartKind::Plane; 2]);
    }
}
