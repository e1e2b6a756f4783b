//! Where parts meet: between which, by how much the normal turns there, and to which side.
//!
//! ```text
//! joint a, b: pairs of linked points, one of each part; at the middle m of a pair
//! turn = +- angle(n_a(m), n_b(m)),  + where (n_b - n_a) . (p_b - p_a) > 0: the body is convex there
//! ```
//!
//! The normals are those of the fitted primitives, not those of points, which an edge may have blurred.

use std::collections::BTreeMap;

use super::cloud::Cloud;
use super::partition::NONE;
use palpate_numeric::vector::{Vector, cross, dot, minus, norm};

/// Fewest pairs of points that make a joint: a corner where parts meet in one point has fewer.
const FEWEST_PAIRS: usize = 6;

/// Normals that turn by less than this are one smooth surface to a reader, in degrees: boundaries are known to half a
/// spacing, which on a body 12 spacings wide turns a normal by as much.
const SMOOTH_DEG: f64 = 5.0;

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
}

/// Every joint of the labelled cloud; `normal` is that of a part at a place.
pub(super) fn joints(cloud: &Cloud, labels: &[u32], normal: impl Fn(u32, usize, Vector) -> Vector) -> Vec<Joint> {
    let mut turns: BTreeMap<[u32; 2], Vec<f64>> = BTreeMap::new();
    for i in 0..cloud.len() {
        for &j in cloud.linked(i) {
            let (a, b) = (labels[i], labels[j as usize]);
            if a == NONE || b == NONE || a >= b {
                continue;
            }
            let (p, q) = (cloud.points[i], cloud.points[j as usize]);
            let middle = [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]));
            let (one, two) = (normal(a, i, middle), normal(b, j as usize, middle));
            let angle = norm(cross(one, two)).atan2(dot(one, two));
            let outwards = dot(minus(two, one), minus(q, p));
            turns.entry([a, b]).or_default().push(if outwards < 0.0 { -angle } else { angle });
        }
    }
    let joint = |([a, b], turns): ([u32; 2], Vec<f64>)| {
        let count = turns.len() as f64;
        let signed = turns.iter().sum::<f64>() / count;
        let unsigned = turns.iter().map(|turn| turn.abs()).sum::<f64>() / count;
        // a boundary that is off by half a spacing turns the normals of a smooth joint either way, and the signs cancel; at an edge
        // noise may reverse the sign of a pair, but not its angle
        let is_smooth = signed.abs().to_degrees() < SMOOTH_DEG && unsigned.to_degrees() < 3.0 * SMOOTH_DEG;
        let (kind, angle) = match signed {
            _ if is_smooth => (JointKind::Smooth, signed.abs()),
            turn if turn > 0.0 => (JointKind::Convex, unsigned),
            _ => (JointKind::Concave, unsigned),
        };
        Joint { parts: [a as usize, b as usize], kind, angle_deg: angle.to_degrees() }
    };
    turns.into_iter().filter(|(_, turns)| turns.len() >= FEWEST_PAIRS).map(joint).collect()
}
