//! Sides of parts whose normals were estimated: those of two parts that meet agree across their joint.
//!
//! ```text
//! w_ab = sum over places where a and b meet of n_a . n_b - step_weight (n_a . e)(n_b . e)      e: direction from a contact of a to one of b
//! ```
//!
//! Below 0 one face has the other on its free side, and the other not; where they touch smoothly, the normals alone tell.
//! Signs that are carried from contact to contact take a wrong turn at an edge of more than a right angle, where the planes of neighbours are
//! of neither face. The fitted primitives know the edge. Parts are joined by a spanning tree, largest |w| first, and of a tree the side
//! holds that most of its contacts have.

use super::cloud::Cloud;
use super::joint_angle::MeetingPlace;
use super::joints::joints;
use super::partition::Partition;
use super::sided_normals::points_inwards;
use super::tuning::PartsTuning;
use palpate_numeric::vector::{Vector, dot, scaled};

/// Turns the parts that contradict those they meet, with the normals of their contacts, and what goes all round outwards; gives back the
/// normals as their parts have them. `gap` is what parts leave where they meet.
pub(super) fn agree(partition: &mut Partition, cloud: &mut Cloud, gap: f64, tuning: &PartsTuning) -> Vec<Vector> {
    let members = partition.members();
    let is_turned = turned(partition, cloud, gap, &members, tuning);
    for part in (0..members.len()).filter(|part| is_turned[*part]) {
        partition.parts[part].side *= -1.0;
        members[part].iter().for_each(|i| reverse(&mut cloud.normals[*i as usize]));
    }
    let mut normals = cloud.normals.clone();
    for (part, members) in partition.parts.iter().zip(&members) {
        for i in members.iter().map(|i| *i as usize) {
            let sign = dot(part.nearest(cloud.points[i]).1, normals[i]).signum();
            normals[i] = scaled(sign, normals[i]);
        }
    }
    if points_inwards(&cloud.points, &normals) {
        partition.parts.iter_mut().for_each(|part| part.side *= -1.0);
        cloud.normals.iter_mut().chain(&mut normals).for_each(reverse);
    }
    normals
}

fn reverse(normal: &mut Vector) {
    *normal = scaled(-1.0, *normal);
}

/// Which parts contradict most of those that they hang together with.
fn turned(partition: &Partition, cloud: &Cloud, gap: f64, members: &[Vec<u32>], tuning: &PartsTuning) -> Vec<bool> {
    let parts = &partition.parts;
    let surface = |part: u32, _: usize, place: Vector| parts[part as usize].nearest(place);
    let meeting = joints(cloud, &partition.labels, gap, tuning, surface);
    let mut weights: Vec<([usize; 2], f64)> = meeting
        .iter()
        .map(|found| {
            let both = found.joint.parts;
            let [a, b] = both.map(|part| parts[part]);
            let agreement = |m: &MeetingPlace| {
                let [one, other] = [a, b].map(|part| part.nearest(m.place).1);
                let square = dot(m.across, m.across);
                let crossing = if square > 0.0 { dot(one, m.across) * dot(other, m.across) / square } else { 0.0 };
                dot(one, other) - tuning.step_weight * crossing
            };
            (both, found.meetings.iter().map(agreement).sum())
        })
        .collect();
    weights.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
    // the tree that each part is of, and whether it is turned against the others of that tree
    let mut tree: Vec<(usize, bool)> = (0..parts.len()).map(|part| (part, false)).collect();
    for ([a, b], weight) in weights {
        let ((of_a, a_is_turned), (of_b, b_is_turned)) = (tree[a], tree[b]);
        if of_a != of_b {
            let turn = (a_is_turned != b_is_turned) != (weight < 0.0);
            tree.iter_mut().filter(|(of, _)| *of == of_b).for_each(|part| *part = (of_a, part.1 != turn));
        }
    }
    let mut contacts = vec![[0, 0]; parts.len()];
    for ((of, is_turned), members) in tree.iter().zip(members) {
        contacts[*of][usize::from(*is_turned)] += members.len();
    }
    let most = |of: usize| contacts[of][1] > contacts[of][0];
    tree.into_iter().map(|(of, is_turned)| is_turned != most(of)).collect()
}

#[cfg(test)]
mod tests {
    use crate::parts::{JointKind, PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// Places on a frustum and on its wider end, where the normal turns by 114 degrees, off by a fifth of their spacing. Which side of both is
    /// free nothing tells, and yet the turn is no other.
    #[test]
    fn a_cone_and_its_end_have_one_side() {
        let (sin, cos) = 24.0_f64.to_radians().sin_cos();
        let told = |seed: u64| {
            let draws = EffectDraws::new(seed, "frustum");
            let place = |k: u64| -> Vector {
                let (mut at, mut off) = ([0.0; 3], [0.0]);
                draws.uniforms(k, 0, 3, &mut at);
                draws.gaussians(k, 1, 1, &mut off);
                let (s, c) = (std::f64::consts::TAU * at[0]).sin_cos();
                let error = 0.015 * off[0];
                if at[2] < 0.6 {
                    let rho = 1.0 - at[1] * sin / cos + error * cos;
                    [rho * c, rho * s, at[1] + error * sin]
                } else {
                    [at[1].sqrt() * c, at[1].sqrt() * s, error]
                }
            };
            let points: Vec<Vector> = (0..900).map(place).collect();
            let found = Parts::of(&Contacts::from_points(&points), &PartsOptions::default()).unwrap();
            let kinds: Vec<PartKind> = found.parts.iter().map(|part| part.kind).collect();
            let joint = found.joints.first().map(|joint| (joint.kind, joint.angle_deg));
            (kinds, joint)
        };
        for seed in 1..9 {
            let (kinds, joint) = told(seed);
            assert_eq!(kinds, [PartKind::Cone, PartKind::Plane]);
            assert!(
                matches!(joint, Some((JointKind::Convex, angle)) if (angle - 114.0).abs() < 2.0),
                "{seed}: {joint:?}"
            );
        }
    }
}
