//! Whether the normals of a file contradict its places: a mesh program that writes directions from the origin tells nothing of a surface.
//!
//! ```text
//! flat     contacts whose 13 nearest have an sd across of a tenth of that along or less
//! off      median angle there between normal and plane;  u: the median angle between normals of contacts next to each other
//! contradict     off > 10 degrees and off > 3 u, and most contacts are flat
//! ```
//!
//! Normals that are only poor differ from those next to them by as much as from the planes. Of very many contacts some thousands are asked,
//! evenly among all.

use super::cloud::NEAREST;
use super::estimated::plane_about;
use super::tuning::PartsTuning;
use palpate_geometry::neighbours::NeighbourLists;
use palpate_numeric::statistics::{ENOUGH_FOR_RANKS, evenly_among, upper_median};
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, dot};

/// Whether these normals are not those of the surface on which the places lie.
pub(super) fn contradict(
    points: &[Vector],
    normals: &[Vector],
    near: &NeighbourLists<NEAREST>,
    tuning: &PartsTuning,
) -> bool {
    let asked: Vec<usize> = evenly_among(points.len(), ENOUGH_FOR_RANKS).collect();
    let angle = |a: Vector, b: Vector| dot(a, b).abs().min(1.0).acos();
    let at = |k: usize| {
        let i = asked[k];
        let (plane, other) = (plane_about(points, near, i), near.of(i)[0] as usize);
        let is_flat = plane.sd <= tuning.flat_places * plane.along;
        is_flat.then(|| [angle(normals[i], plane.normal), angle(normals[i], normals[other])])
    };
    let flat: Vec<[f64; 2]> = threads::map(asked.len(), 64, at).into_iter().flatten().collect();
    let [off, own] = [0, 1].map(|of| upper_median(flat.iter().map(|angles| angles[of]).collect::<Vec<f64>>()));
    let [least, times] = tuning.contradicts;
    let are_most = 2 * flat.len() > asked.len();
    off.zip(own).is_some_and(|(off, own)| are_most && off > least.to_radians() && off > times * own)
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, along, unit};

    /// A bar of radius 1 and length 6 about z, with normals of its own or from its middle, each off by so much.
    fn bar(from_middle: bool, off: f64) -> Contacts {
        let draws = EffectDraws::new(6, "against places");
        let touch = |k: u64| -> (Vector, Vector) {
            let (mut at, mut error) = ([0.0; 2], [0.0; 3]);
            draws.uniforms(k, 0, 2, &mut at);
            draws.gaussians(k, 1, 3, &mut error);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let place = [cos, sin, 6.0 * (at[1] - 0.5)];
            (place, unit(along(if from_middle { unit(place) } else { [cos, sin, 0.0] }, off, error)))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..1500).map(touch).unzip();
        Contacts::from_points(&points).with_normal_vectors(&normals)
    }

    fn told(contacts: &Contacts) -> (Vec<PartKind>, bool) {
        let found = Parts::of(contacts, &PartsOptions::default()).unwrap();
        let are_left_out = found.notes.iter().any(|note| note.contains("contradict"));
        (found.parts.iter().map(|part| part.kind).collect(), are_left_out)
    }

    #[test]
    fn normals_from_the_middle_of_a_bar_are_left_out_and_poor_ones_are_not() {
        assert_eq!(told(&bar(true, 0.0)), (vec![PartKind::Cylinder], true));
        assert_eq!(told(&bar(false, 0.0)), (vec![PartKind::Cylinder], false));
        assert_eq!(told(&bar(false, 0.15)), (vec![PartKind::Cylinder], false));
    }
}
