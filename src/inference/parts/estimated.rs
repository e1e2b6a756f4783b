//! Normals of a cloud that has none: planes through neighbours, on one side, and at an edge the plane of the face that a contact lies on.
//!
//! ```text
//! n_i, s_i     least direction of the 13 contacts nearest to contact i, and their sd along it
//! n_i <- n_j   j nearest to i in s among those of the 13 with s_j < s_i / 2 whose plane passes contact i by less than 2 s_j
//! sign         carried from neighbour to neighbour; towards the viewpoint, contact by contact, where one is given
//! ```
//!
//! The plane of a neighbourhood that an edge cuts is of neither face, and its scatter is large. That of a neighbour that lies wholly on one
//! face is small: M. Kuwahara et al., *Processing of RI-angiocardiographic images* (1976) 187, took means so.

use super::cloud;
use super::tuning::PartsTuning;
use palpate_geometry::neighbours::{NEAREST, NeighbourLists, oriented_anew};
use palpate_numeric::linalg::small::{Square, eigen};
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along, dot, minus, scaled};

/// Share of a contact's own scatter below which that of a neighbour is rounding.
const ROUNDED: f64 = 1e-3;

/// The plane of a neighbourhood.
#[derive(Clone, Copy)]
pub(super) struct NeighbourPlane {
    middle: Vector,
    pub(super) normal: Vector,
    pub(super) sd: f64,
    /// The smaller sd in the plane.
    pub(super) along: f64,
}

/// A contact and those nearest to it.
fn about(near: &NeighbourLists<{ cloud::NEAREST }>, i: usize) -> impl Iterator<Item = usize> + Clone {
    let others = near.of(i)[..NEAREST - 1].iter().map(|j| *j as usize);
    std::iter::once(i).chain(others)
}

/// The plane of a contact and those nearest to it.
pub(super) fn plane_about(points: &[Vector], near: &NeighbourLists<{ cloud::NEAREST }>, i: usize) -> NeighbourPlane {
    plane(points, about(near, i))
}

/// A unit normal for each point, on one side.
pub(super) fn estimated(
    points: &[Vector],
    near: &NeighbourLists<{ cloud::NEAREST }>,
    viewpoint: Option<Vector>,
    tuning: &PartsTuning,
) -> Vec<Vector> {
    let planes = threads::map(points.len(), 256, |i| plane_about(points, near, i));
    let sharp = threads::map(points.len(), 256, |i| {
        let flat = |j: &usize| {
            let other = &planes[*j];
            let off = dot(other.normal, minus(points[i], other.middle)).abs();
            other.sd < tuning.flatter * planes[i].sd && off < tuning.near_plane * other.sd.max(ROUNDED * planes[i].sd)
        };
        let others = about(near, i).filter(flat);
        let flattest = others.min_by(|a, b| planes[*a].sd.total_cmp(&planes[*b].sd).then(a.cmp(b)));
        planes[flattest.unwrap_or(i)].normal
    });
    let upward = |normal: Vector| if normal[2] < 0.0 { scaled(-1.0, normal) } else { normal };
    let mut normals = oriented_anew(points, sharp.into_iter().map(upward).collect(), viewpoint, near).normals;
    if let Some(eye) = viewpoint {
        // what a viewpoint sees faces it
        let turn = |(n, p): (&mut Vector, &Vector)| *n = scaled(dot(*n, minus(eye, *p)).signum(), *n);
        normals.iter_mut().zip(points).for_each(turn);
    }
    normals
}

fn plane(points: &[Vector], near: impl Iterator<Item = usize> + Clone) -> NeighbourPlane {
    let count = near.clone().count().max(1) as f64;
    let middle = near.clone().fold([0.0; 3], |sum, j| along(sum, 1.0 / count, points[j]));
    let mut squares: Square<3> = [[0.0; 3]; 3];
    for j in near {
        let d = minus(points[j], middle);
        (0..3).for_each(|a| (0..3).for_each(|b| squares[a][b] += d[a] * d[b] / count));
    }
    let (values, axes) = eigen(&squares);
    let [sd, along, _] = values.map(|value| value.max(0.0).sqrt());
    NeighbourPlane { middle, normal: axes[0], sd, along }
}

#[cfg(test)]
mod tests {
    use super::{NeighbourLists, PartsTuning, estimated};
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_geometry::curvature::ShapeClass;
    use palpate_numeric::vector::Vector;

    /// Planes through neighbours lean by up to 45 degrees beside such an edge, in a tenth of the contacts. At the ends of the edge some
    /// find no neighbour that lies wholly on their face.
    #[test]
    fn normals_beside_an_edge_are_those_of_their_face() {
        let place = |k: u32| (f64::from(k % 20) * 0.5 + 0.25, f64::from(k / 20) * 0.5 + 0.13 * f64::from(k % 3));
        let top = (0..400).map(place).map(|(s, y)| [-s, y, 0.0]);
        let points: Vec<Vector> = top.chain((0..400).map(place).map(|(s, y)| [0.0, y, -s])).collect();
        let near = NeighbourLists::new(&points);
        let normals = estimated(&points, &near, Some([50.0, 5.0, 50.0]), &PartsTuning::default());
        let leaning = |normals: &[Vector], axis: usize| normals.iter().filter(|n| n[axis] < 0.99).count();
        let [top, side] = [leaning(&normals[..400], 2), leaning(&normals[400..], 0)];
        assert!(top < 20 && side < 20, "{top} and {side} of 400 lean");
    }

    /// A third of a bar, of which nothing tells whether it was touched from outside or from inside.
    #[test]
    fn a_side_that_nothing_tells_is_said_to_be_open() {
        let place = |k: u32| {
            let (sin, cos) = (2.0 * f64::from(k % 20) / 19.0 - 1.0_f64).sin_cos();
            [3.0 * sin, 0.3 * f64::from(k / 20), 3.0 * cos]
        };
        let contacts = Contacts::from_points(&(0..600).map(place).collect::<Vec<Vector>>());
        let open = Parts::of(&contacts, &PartsOptions::default()).unwrap().parts;
        assert_eq!((open.len(), open[0].kind), (1, PartKind::Cylinder));
        assert_eq!(open[0].other_class, open[0].class.map(ShapeClass::mirrored));
        let seen = PartsOptions { viewpoint: Some([0.0, 4.0, 40.0]), ..PartsOptions::default() };
        let seen = Parts::of(&contacts, &seen).unwrap().parts;
        assert_eq!((seen[0].class, seen[0].other_class), (Some(ShapeClass::Ridge), None));
    }
}
