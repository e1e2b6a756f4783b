//! Where parts meet: between which, by how much the normal turns there, and to which side.
//!
//! ```text
//! joint a, b: pairs of linked points, one of each part, at which the parts meet; at the middle m of a pair
//! meet  least over x of (d_a(x)^2 + d_b(x)^2) / gap^2 + |x - m|^2 / reach^2, and there |d| <= gap and |x - m| <= reach
//! turn = +- angle(n_a(m), n_b(m)),  + where (n_b - n_a) . (p_b - p_a) > 0: the body is convex there
//! ```
//!
//! Contacts of two walls, or of the two levels of a step, are linked as well, but no place near them lies on both surfaces.
//! The normals are those of the fitted primitives, not those of points, which an edge may have blurred.

use std::collections::BTreeMap;

use super::cloud::Cloud;
use super::joint_angle::{MeetingPlace, turn_at};
use super::partition::NONE;
use super::tuning::PartsTuning;
use palpate_numeric::linalg::small::{Square, cholesky, solve};
use palpate_numeric::vector::{Vector, along, minus, norm};

/// Newton's steps to the place where two parts meet: each squares what is left of their bend within the reach.
const STEPS: usize = 3;

/// How two parts meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum JointKind {
    /// An edge that stands out, as of a box.
    Convex,
    /// An edge that lies inside, as where a handle meets a mug.
    Concave,
    /// Normals go over into each other.
    Smooth,
}

impl JointKind {
    /// The word used in every output.
    pub fn name(self) -> &'static str {
        match self {
            JointKind::Convex => "convex",
            JointKind::Concave => "concave",
            JointKind::Smooth => "smooth",
        }
    }
}

/// Two parts that meet.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Joint {
    /// Their ids, the smaller first.
    pub parts: [usize; 2],
    /// How.
    pub kind: JointKind,
    /// By how much the normal turns from one to the other, degrees.
    pub angle_deg: f64,
    /// Standard uncertainty of it, degrees; `None` where one of them is no primitive.
    pub u_angle_deg: Option<f64>,
}

/// A joint between two parts of a cloud, by their numbers there, with where they meet.
pub(super) struct FoundJoint {
    pub(super) joint: Joint,
    pub(super) meetings: Vec<MeetingPlace>,
}

/// Every joint of the labelled cloud; `surface` is the distance from a part and its normal at a place beside a contact, and parts meet that
/// leave no more than a `gap`.
pub(super) fn joints(
    cloud: &Cloud,
    labels: &[u32],
    gap: f64,
    tuning: &PartsTuning,
    surface: impl Fn(u32, usize, Vector) -> (f64, Vector),
) -> Vec<FoundJoint> {
    let mut pairs: BTreeMap<[u32; 2], MeetingParts> = BTreeMap::new();
    for i in 0..cloud.len() {
        for &j in cloud.linked(i) {
            let (a, b) = (labels[i], labels[j as usize]);
            if a == NONE || b == NONE || a >= b {
                continue;
            }
            let (p, q) = (cloud.points[i], cloud.points[j as usize]);
            let middle = [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]));
            let both = |place: Vector| [surface(a, i, place), surface(b, j as usize, place)];
            let found = pairs.entry([a, b]).or_default();
            found.pairs += 1;
            if meet(middle, tuning.joint_reach * norm(minus(q, p)), gap, both) {
                let [(_, one), (_, two)] = both(middle);
                found.turns.push(turn_at(one, two, minus(q, p)));
                found.meetings.push(MeetingPlace { place: middle, across: minus(q, p) });
            }
        }
    }
    let meeting = pairs.into_iter().filter(|(_, found)| found.is_joint(tuning.joint_pairs));
    meeting.map(|(parts, found)| found.joint(parts, tuning.joint_smooth_deg)).collect()
}

/// Linked contacts of two parts, and what the normal turns by where the parts meet beside them.
#[derive(Default)]
struct MeetingParts {
    pairs: usize,
    turns: Vec<f64>,
    meetings: Vec<MeetingPlace>,
}

/// Whether a place within `reach` of the middle lies on both surfaces, but for a `gap`.
fn meet(middle: Vector, reach: f64, gap: f64, both: impl Fn(Vector) -> [(f64, Vector); 2]) -> bool {
    let mut place = middle;
    for _ in 0..STEPS {
        let home = reach.powi(-2);
        let mut matrix: Square<3> = std::array::from_fn(|a| std::array::from_fn(|b| if a == b { home } else { 0.0 }));
        let mut right = minus(middle, place).map(|v| v * home);
        for (d, n) in both(place) {
            let heavy = gap.powi(-2);
            right = along(right, -d * heavy, n);
            (0..3).for_each(|a| (0..3).for_each(|b| matrix[a][b] += heavy * n[a] * n[b]));
        }
        let Some(lower) = cholesky(&matrix) else { return false };
        place = along(place, 1.0, solve(&lower, right));
    }
    norm(minus(place, middle)) <= reach && both(place).iter().all(|(d, _)| d.abs() <= gap)
}

impl MeetingParts {
    fn is_joint(&self, fewest_pairs: usize) -> bool {
        self.turns.len() >= fewest_pairs && 2 * self.turns.len() >= self.pairs
    }

    /// What the turns make of their joint, which is smooth where they are no more than so many degrees.
    fn joint(self, [a, b]: [u32; 2], smooth_deg: f64) -> FoundJoint {
        let count = self.turns.len() as f64;
        let signed = self.turns.iter().sum::<f64>() / count;
        let unsigned = self.turns.iter().map(|turn| turn.abs()).sum::<f64>() / count;
        // a boundary that is off by half a spacing turns the normals of a smooth joint either way, and the signs cancel; at an edge
        // noise may reverse the sign of a pair, but not its angle
        let is_smooth = signed.abs().to_degrees() < smooth_deg && unsigned.to_degrees() < 3.0 * smooth_deg;
        let (kind, angle) = match signed {
            _ if is_smooth => (JointKind::Smooth, signed.abs()),
            turn if turn > 0.0 => (JointKind::Convex, unsigned),
            _ => (JointKind::Concave, unsigned),
        };
        let joint = Joint { parts: [a as usize, b as usize], kind, angle_deg: angle.to_degrees(), u_angle_deg: None };
        FoundJoint { joint, meetings: self.meetings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;

    /// The kinds and joints of a tread beside which a second surface begins.
    fn told(second: impl Fn(f64, f64) -> (Vector, Vector)) -> (Vec<PartKind>, Vec<(JointKind, f64)>) {
        let place = |k: u32| (0.5 * f64::from(k % 20) + 0.25, 0.5 * f64::from(k / 20) + 0.13 * f64::from(k % 3));
        let first = (0..400).map(place).map(|(s, y)| ([-s, y, 0.0], [0.0, 0.0, 1.0]));
        let (points, normals): (Vec<Vector>, Vec<Vector>) =
            first.chain((0..400).map(place).map(|(s, y)| second(s, y))).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        let kinds = found.parts.iter().map(|part| part.kind).collect();
        (kinds, found.joints.iter().map(|joint| (joint.kind, joint.angle_deg)).collect())
    }

    #[test]
    fn two_levels_of_a_step_do_not_meet() {
        let (kinds, joints) = told(|s, y| ([s, y, 0.4], [0.0, 0.0, 1.0]));
        assert_eq!((kinds, joints), (vec![PartKind::Plane; 2], Vec::new()));
    }

    #[test]
    fn an_edge_and_a_smooth_joint_are_joints() {
        let (sin, cos) = 0.5_f64.sin_cos();
        let (kinds, joints) = told(|s, y| ([s * cos, y, s * sin], [-sin, 0.0, cos]));
        assert_eq!(kinds, [PartKind::Plane; 2]);
        assert!(matches!(joints[..], [(JointKind::Concave, angle)] if (angle - 28.648).abs() < 1e-3), "{joints:?}");
        let (kinds, joints) = told(|s, y| {
            let (sin, cos) = (s / 8.0).sin_cos();
            ([8.0 * sin, y, 8.0 * (cos - 1.0)], [sin, 0.0, cos])
        });
        assert_eq!(kinds.len(), 2);
        assert!(matches!(joints[..], [(JointKind::Smooth, _)]), "{joints:?}");
    }
}
