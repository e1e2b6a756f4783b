//! Whether contacts lie on a surface at all: where a depth camera sees an edge, it puts contacts between two faces, or between the body
//! and what is behind it, and these fill a strip of space.
//!
//! ```text
//! r_i = (d_i - mean of d over the linked contacts of the part) / sqrt(1 + 1/m)      m: how many these are; d: distance from the primitive
//! a part is a sheet     median |r_i| <= loose hypot(noise of distances, let pass),  normals alike
//! a region is a sheet   median misfit of the surfaces through neighbours, alike
//! ```
//!
//! A departure from the primitive that neighbours share leaves r alone, so that the fit need not be good. What is no sheet is no part.

use super::cloud::Cloud;
use super::local::{LocalShape, LocalShapes, Noise};
use super::tuning::PartsTuning;
use crate::primitives::placed::Primitive;
use palpate_geometry::curvature::curvedness;
use palpate_numeric::statistics::{MAD_TO_SD, RAYLEIGH_TO_SD, upper_median};
use palpate_numeric::vector::{dot, minus, norm};

/// What the contacts of a sheet may scatter by.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheetLimit {
    pub(super) noise: Noise,
    /// What places may be off by along the surface, where that turns their normals.
    along: f64,
    /// Share of their linked neighbours that are among them.
    coherent: f64,
    /// Cosine between normals from which on a neighbour is asked for: one beyond an edge is of another face, where normals are measured.
    facing: f64,
    /// Fewest contacts of a region.
    fewest: usize,
}

impl SheetLimit {
    /// From what all contacts scatter by, what is let pass beside it, and how many contacts a region has at least.
    pub(super) fn new(
        common: &Noise,
        beside: &Noise,
        (fewest, blurred): (usize, bool),
        tuning: &PartsTuning,
    ) -> SheetLimit {
        let PartsTuning { loose, coherent, parallel, back_to_back, .. } = *tuning;
        let facing = if blurred { back_to_back } else { parallel };
        let distance = loose * common.distance.hypot(beside.distance);
        let noise = Noise { distance, normal: loose * common.normal.hypot(beside.normal) };
        let along = if blurred { 0.0 } else { loose * common.distance };
        SheetLimit { noise, along, coherent, facing, fewest }
    }

    /// Whether the contacts of a part lie on a sheet about its primitive.
    pub(super) fn holds_part(&self, cloud: &Cloud, labels: &[u32], members: &[u32], primitive: &Primitive) -> bool {
        let off = |i: u32| primitive.nearest(cloud.points[i as usize]);
        let roughness = |i: &u32| {
            let beside = linked_alike(cloud, labels, *i);
            let (sum, count) = beside.fold((0.0, 0.0), |(sum, count), j| (sum + off(j).0, count + 1.0));
            let own = off(*i).0;
            if count > 0.0 { (own - sum / count).abs() / (1.0_f64 + 1.0 / count).sqrt() } else { own.abs() }
        };
        // a place that is off along a bent surface has the normal of another foot
        let turned = |i: &u32| {
            let [one, two] = primitive.curvatures(cloud.points[*i as usize]);
            let limit = self.noise.normal.hypot(curvedness(one, two) * self.along);
            norm(minus(off(*i).1, cloud.normals[*i as usize])) / limit
        };
        self.coheres(cloud, labels, members)
            && MAD_TO_SD * median(members, roughness) <= self.noise.distance
            && RAYLEIGH_TO_SD * median(members, turned) <= 1.0
    }

    /// Whether one contact and its neighbours lie on a sheet.
    pub(super) fn holds_contact(&self, shape: &LocalShape) -> bool {
        let [distance, normal] = shape.variance;
        distance <= self.noise.distance.powi(2) && normal <= self.noise.normal.powi(2)
    }

    /// Whether the contacts of a region lie on a sheet, as the surfaces through their neighbours have it.
    pub(super) fn holds_region(&self, cloud: &Cloud, shapes: &LocalShapes, labels: &[u32], members: &[u32]) -> bool {
        let sd = |k: usize| median(members, |i| shapes.at(cloud, *i as usize).variance[k]).sqrt();
        members.len() >= self.fewest
            && self.coheres(cloud, labels, members)
            && sd(0) <= self.noise.distance
            && sd(1) <= self.noise.normal
    }

    /// Whether these contacts have enough of each other as neighbours. What faces another way is another face or wall, however near it is.
    fn coheres(&self, cloud: &Cloud, labels: &[u32], members: &[u32]) -> bool {
        let facing = |i: &u32| {
            let normal = cloud.normals[*i as usize];
            cloud.linked(*i as usize).iter().filter(|j| dot(normal, cloud.normals[**j as usize]) > self.facing).count()
        };
        let alike: usize = members.iter().map(|i| linked_alike(cloud, labels, *i).count()).sum();
        alike as f64 >= self.coherent * members.iter().map(facing).sum::<usize>() as f64
    }
}

fn median(members: &[u32], of: impl Fn(&u32) -> f64) -> f64 {
    upper_median(members.iter().map(of).collect::<Vec<f64>>()).unwrap_or(0.0)
}

/// The linked contacts of one that have its label.
fn linked_alike<'a>(cloud: &'a Cloud, labels: &'a [u32], i: u32) -> impl Iterator<Item = u32> + 'a {
    cloud.linked(i as usize).iter().copied().filter(move |j| labels[*j as usize] == labels[i as usize])
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// Two faces at a right angle, and contacts between them as a camera puts them: on lines from one face to the other.
    #[test]
    fn what_a_camera_puts_between_two_faces_is_no_part() {
        let draws = EffectDraws::new(8, "strip");
        let drawn = |k: u64| {
            let mut at = [0.0; 4];
            draws.uniforms(k, 0, 4, &mut at);
            at
        };
        let face = |k: u64| {
            let [s, y, ..] = drawn(k).map(|v| 20.0 * v);
            if k.is_multiple_of(2) { [-s, y, 0.0] } else { [0.0, y, -s] }
        };
        let between = |k: u64| {
            let [a, b, w, y] = drawn(k);
            [-2.0 * a * (1.0 - w), 20.0 * y, -2.0 * b * w]
        };
        let points: Vec<Vector> = (0..1200).map(face).chain((1200..1270).map(between)).collect();
        let found = Parts::of(&Contacts::from_points(&points), &PartsOptions::default()).unwrap();
        assert_eq!(found.parts.iter().map(|part| part.kind).collect::<Vec<_>>(), [PartKind::Plane; 2]);
    }

    /// A pipe whose wall is a third as thick as its contacts are apart: half of the neighbours of each are on the other wall.
    #[test]
    fn both_walls_of_a_thin_pipe_are_parts() {
        let draws = EffectDraws::new(9, "pipe");
        let contact = |k: u64| -> (Vector, Vector) {
            let mut at = [0.0; 2];
            draws.uniforms(k, 0, 2, &mut at);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let (radius, side) = if k.is_multiple_of(2) { (2.5, 1.0) } else { (2.2, -1.0) };
            ([radius * cos, radius * sin, 60.0 * at[1]], [side * cos, side * sin, 0.0])
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..2000).map(contact).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        let told: Vec<(PartKind, bool, usize)> =
            found.parts.iter().map(|part| (part.kind, part.hollow, part.points)).collect();
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told.iter().all(|(kind, _, points)| *kind == PartKind::Cylinder && *points > 900), "{told:?}");
        assert!(told[0].1 != told[1].1, "{told:?}");
    }
}
