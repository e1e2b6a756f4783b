//! The whole cloud as one primitive, or as a few: what is one body is one part, however few or noisy its contacts are.
//!
//! ```text
//! primitives by `bodies`, which hold 97 % of the contacts within four sds        else the cloud is cut
//! ```
//!
//! A departure that would be shape is no primitive, and an ellipsoid is no part.

use super::cloud::Cloud;
use super::local::Noise;
use super::partition::{NONE, Partition};
use crate::bodies::{self, BodySample, Thing, Tuning, Verdict};
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::vector::Vector;

/// Share of the contacts that the primitives must hold.
const WHOLE: f64 = 0.97;

/// Contacts that are looked at.
const LOOKED_AT: usize = 1000;

/// Root mean square departure, in units of the cloud, beyond which the primitive is none.
const DEPARTS: f64 = 0.02;

/// Scatter about a primitive over what neighbourhoods show, beyond which it is none of the contacts' own.
const LOOSE: f64 = 3.0;

/// A partition of a few parts; `None` where these do not hold nearly all. `measured` says whether the normals are, and `noise`
/// what neighbourhoods show, with what is let pass.
pub(super) fn whole(cloud: &Cloud, measured: bool, noise: &Noise) -> Option<Partition> {
    let normals: &[Vector] = if measured { &cloud.normals } else { &[] };
    let sample = BodySample::new(&cloud.points, normals, [0.0; 2])?;
    let tuning = Tuning::default();
    let things: Vec<Thing> = match bodies::infer(&sample.at_most(LOOKED_AT), &tuning) {
        Verdict::One(posterior) => {
            let kind = posterior.kind();
            let node = posterior.best_of(kind).filter(|node| node.departure_size() < DEPARTS)?;
            let (primitive, scatter) = (posterior.likeliest(kind)?, node.scatter().hypot(node.departure_size()));
            vec![Thing { primitive, contacts: posterior.members_of(kind).len(), scatter }]
        }
        Verdict::Several(things) => things,
        Verdict::None => return None,
    };
    // of many things a ring follows what lies between the others, and other contacts give others
    if things.len() > 2 && things.iter().any(|thing| thing.primitive.kind == PartKind::Torus) {
        return None;
    }
    let is_loose = |thing: &Thing| thing.scatter > LOOSE * noise.distance;
    if things.iter().any(|thing| thing.primitive.kind == PartKind::Ellipsoid || is_loose(thing)) {
        return None;
    }
    let label = |p: &Vector| {
        let away = |thing: &Thing| thing.primitive.nearest(*p).0.abs() / thing.scatter;
        let nearest = (0..things.len()).min_by(|a, b| away(&things[*a]).total_cmp(&away(&things[*b])));
        nearest.filter(|k| away(&things[*k]) <= tuning.belongs).map_or(NONE, |k| k as u32)
    };
    let labels: Vec<u32> = sample.points.iter().map(label).collect();
    let held = labels.iter().filter(|label| **label != NONE).count() as f64;
    let parts = things.iter().zip(0..).map(|(thing, k)| facing(thing.primitive, k, &labels, cloud)).collect();
    (held >= WHOLE * cloud.len() as f64).then_some(Partition { parts, labels })
}

/// The primitive on the side to which the normals of its contacts point.
fn facing(primitive: Primitive, part: u32, labels: &[u32], cloud: &Cloud) -> Primitive {
    let own = (0..cloud.len()).filter(|i| labels[*i] == part);
    let towards = |i: usize| {
        let outwards = primitive.nearest(cloud.points[i]).1;
        (0..3).map(|k| outwards[k] * cloud.normals[i][k]).sum::<f64>().signum()
    };
    Primitive { side: if own.map(towards).sum::<f64>() < 0.0 { -1.0 } else { 1.0 }, ..primitive }
}
