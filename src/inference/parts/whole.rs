//! The whole cloud as one primitive, or as a few: what is one body is one part, however few or noisy its contacts are.
//!
//! ```text
//! primitives by `bodies`, with the contacts within four sds      the answer, if no longer to tell than the cut cloud:
//! length = sum over parts (n ln sd + sum min(d^2 / sd^2, c) / 2 + unknowns / 2 ln N) + agree (pairs of neighbours in different parts)
//!          sd by the median; contacts of no part 0, lengths in units of the cloud's size; c: `cost_of_none`
//!          where every contact has a normal of its own, which of the two tells more is asked as in `coarser_look.rs`
//! primitives by `bodies` that hold nearly all                    the answer where neighbours share errors
//! where normals are not measured, and the cut cloud has several parts:
//! one primitive that holds nearly all, and is as near            the answer, if the parts go over into each other without an edge
//! a smooth height field                                          the answer, if it is nearer to contacts left out than parts to their own
//! ```
//!
//! A departure that would be shape is no primitive, and an ellipsoid is no part. The length is that of J. Rissanen, *Automatica* 14 (1978)
//! 465: where contacts lie too far apart for regions to grow, few primitives that hold most of them tell more than one that holds all.

use super::cloud::Cloud;
use super::evidence::Residuals;
use super::free_form::predicted;
use super::hypothesis::sampled;
use super::joints::joints;
use super::partition::{Field, NONE, Partition, simplest};
use super::tuning::PartsTuning;
use crate::bodies::{self, BodySample, Thing, Tuning, Verdict};
use crate::primitives::descent::Sample;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::statistics::{MAD_TO_SD, mad, upper_median};
use palpate_numeric::vector::{Vector, dot};

/// Contacts that are looked at.
const LOOKED_AT: usize = 1000;

/// Distance, in units of the cloud, below which none is told from another: its numbers are rounded.
const ROUNDED: f64 = 1e-9;

impl Partition {
    /// Whether contacts lie close beside their noise, and the parts hold nearly all of them: regions then grew as far as faces reach, and what
    /// the whole shows is known.
    pub(super) fn is_beyond_doubt(&self, field: &Field) -> bool {
        let PartsTuning { held, close, .. } = *field.tuning;
        self.labels.len() > LOOKED_AT && self.holds(held) && field.coarse.distance < close * field.cloud.spacing
    }

    /// Whether so large a share of all contacts is in a part.
    fn holds(&self, share: f64) -> bool {
        let held = self.labels.iter().filter(|label| **label != NONE).count() as f64;
        held >= share * self.labels.len() as f64
    }

    /// Whether nearly all contacts are in a part.
    pub(super) fn holds_nearly_all(&self, tuning: &PartsTuning) -> bool {
        self.holds(tuning.nearly_all)
    }

    /// Whether its parts go over into each other: normals differ, where two of them meet, by no more than each may lean by.
    fn is_smooth(&self, field: &Field) -> bool {
        let beside = |part: u32, _, place| self.parts[part as usize].nearest(place);
        let most = (std::f64::consts::SQRT_2 * field.coarse.normal).to_degrees();
        let gap = field.tuning.whole_loose * field.coarse.distance;
        let joints = joints(field.cloud, &self.labels, gap, field.tuning, beside);
        joints.len() + 1 >= self.parts.len() && joints.iter().all(|found| found.joint.angle_deg < most)
    }

    /// Whether nearly all normals point to the free side of their part: two walls that face opposite ways are no one part, however near they
    /// are to each other.
    fn is_one_sided(&self, cloud: &Cloud, most_against: f64) -> bool {
        let against = |i: &usize| {
            let part = self.labels[*i];
            part != NONE && dot(self.parts[part as usize].nearest(cloud.points[*i]).1, cloud.normals[*i]) < 0.0
        };
        let count = cloud.len();
        (0..count).filter(against).count() as f64 <= most_against * count as f64
    }

    /// How long it is to tell, in natural units of information.
    pub(super) fn description_length(&self, cloud: &Cloud, tuning: &PartsTuning) -> f64 {
        let mut off = vec![Vec::new(); self.parts.len()];
        for (place, label) in cloud.points.iter().zip(&self.labels).filter(|(_, label)| **label != NONE) {
            let part = *label as usize;
            off[part].push(self.parts[part].nearest(*place).0.abs());
        }
        let price = 0.5 * (cloud.len() as f64).ln();
        let of_part = |(part, off): (&Primitive, &Vec<f64>)| {
            let sd = (MAD_TO_SD * upper_median(off.clone()).unwrap_or(0.0)).max(ROUNDED);
            let squares: f64 = off.iter().map(|d| (d / sd).powi(2).min(tuning.cost_of_none)).sum();
            off.len() as f64 * sd.ln() + 0.5 * squares + price * part.kind.free().len() as f64
        };
        let pairs = (0..cloud.len()).flat_map(|i| cloud.linked(i).iter().map(move |j| (i, *j as usize)));
        // nearly all links are from both sides, and a pair is one boundary
        let edges = 0.5 * pairs.filter(|(i, j)| self.labels[*i] != self.labels[*j]).count() as f64;
        self.parts.iter().zip(&off).map(of_part).sum::<f64>() + tuning.agree * edges
    }
}

/// A partition of a few parts, which may hold few of the contacts; `None` where no primitive is near. `measured` says whether the
/// normals are.
pub(super) fn whole(field: &Field, measured: bool) -> Option<Partition> {
    let cloud = field.cloud;
    let PartsTuning { whole_departs, whole_loose, .. } = *field.tuning;
    let normals: &[Vector] = if measured { &cloud.normals } else { &[] };
    let sample = BodySample::new(&cloud.points, normals, cloud.rounding)?;
    // normals of a scan are computed from its places
    let tuning = Tuning { own_normals: 0.0, ..field.tuning.recognition.clone() };
    let mut things: Vec<Thing> = match bodies::infer_primitives(&sample.at_most(LOOKED_AT), &tuning) {
        Verdict::One(posterior) => {
            let kind = posterior.kind();
            let node = posterior.best_of(kind).filter(|node| node.departure_size() < whole_departs)?;
            let (primitive, scatter) = (posterior.likeliest(kind)?, node.scatter().hypot(node.departure_size()));
            vec![Thing { primitive, contacts: posterior.members_of(kind).len(), scatter }]
        }
        Verdict::Several(things) => things,
        Verdict::Free { .. } | Verdict::None => return None,
    };
    // of many things a ring follows what lies between the others, and other contacts give others
    let are_many = things.len() > 2;
    let follows_any = |kind: PartKind| kind == PartKind::Ellipsoid || are_many && kind == PartKind::Torus;
    things.retain(|thing| !follows_any(thing.primitive.kind) && thing.scatter <= whole_loose * field.coarse.distance);
    let reached: Vec<Vec<u32>> = sample.points.iter().map(|p| within_reach(*p, &things, tuning.belongs)).collect();
    let mut labels: Vec<u32> = (0..cloud.len()).map(|i| label(i, &reached, &things, cloud, measured)).collect();
    let things = with_contacts(things, &mut labels);
    let parts: Vec<Primitive> =
        things.iter().zip(0..).map(|(thing, k)| facing(thing.primitive, k, &labels, cloud)).collect();
    let whole = Partition { parts, labels };
    let stands = !things.is_empty() && (!measured || whole.is_one_sided(cloud, tuning.decisive));
    stands.then_some(whole)
}

/// One primitive for all contacts, begun at the parts, where it holds nearly all of them, they scatter little about it, and no edge lies
/// between the parts. Distances alone tell: normals of planes through neighbours tell the same again, and on the wrong side lead astray.
pub(super) fn one(cut: &Partition, field: &Field) -> Option<Partition> {
    let (cloud, u) = (field.cloud, &field.coarse);
    let all: Vec<u32> = (0..cloud.len() as u32).collect();
    let (points, normals) = sampled(cloud, &all, LOOKED_AT);
    let sample = Sample { points: &points, normals: &normals, u_distance: u.distance, u_normal: f64::INFINITY };
    let blind = field.pass.blind();
    let loses = |simpler: &Residuals, richer: &Residuals, more| simpler.lose_to_kind(richer, more, field.cells, &blind);
    let primitive = simplest((cloud, &all), &sample, &cut.parts, field.tuning, loses)?;
    let off: Vec<f64> = cloud.points.iter().map(|p| primitive.nearest(*p).0).collect();
    let sd = mad(off.iter().copied());
    let most = field.tuning.recognition.belongs * sd;
    let labels: Vec<u32> = off.iter().map(|d| if d.abs() <= most { 0 } else { NONE }).collect();
    let found = Partition { parts: vec![facing(primitive, 0, &labels, cloud)], labels };
    let PartsTuning { loose, one_spacings, .. } = *field.tuning;
    let is_near = sd < one_spacings * cloud.spacing && (sd < loose * u.distance || cut.is_smooth(field));
    (is_near && found.holds_nearly_all(field.tuning)).then_some(found)
}

/// Whether the cloud is one smooth surface of no kind rather than these parts: a height field is nearer to contacts that it was not told of
/// than the parts are to their own.
pub(super) fn is_free(cut: &Partition, field: &Field) -> bool {
    let cloud = field.cloud;
    let held = (0..cloud.len()).filter(|i| cut.labels[*i] != NONE);
    let off = |i: usize| cut.parts[cut.labels[i] as usize].nearest(cloud.points[i]).0;
    let (squares, count) = held.fold((0.0, 0.0), |(sum, count), i| (sum + off(i).powi(2), count + 1.0));
    predicted(cloud, LOOKED_AT, field.tuning).is_some_and(|error| error * error * count < squares)
}

/// Numbers of the things that a place is near enough to, the nearest first.
fn within_reach(place: Vector, things: &[Thing], most: f64) -> Vec<u32> {
    let away = |k: usize| things[k].primitive.nearest(place).0.abs() / things[k].scatter;
    let mut near: Vec<(f64, u32)> =
        (0..things.len()).map(|k| (away(k), k as u32)).filter(|(d, _)| *d <= most).collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.into_iter().map(|(_, k)| k).collect()
}

/// The thing that a contact is of. Where two meet, or one goes on through the other, its normal tells, or else the most of those
/// beside it that only one thing reaches.
fn label(i: usize, reached: &[Vec<u32>], things: &[Thing], cloud: &Cloud, measured: bool) -> u32 {
    let own = &reached[i];
    let [first, _, ..] = own[..] else { return own.first().copied().unwrap_or(NONE) };
    if measured {
        let along = |k: &u32| dot(things[*k as usize].primitive.nearest(cloud.points[i]).1, cloud.normals[i]).abs();
        return own.iter().copied().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(first);
    }
    let beside = |k: &u32| cloud.near(i).iter().filter(|j| reached[**j as usize] == [*k]).count();
    // of equally many the nearest, which stands first
    own.iter().rev().copied().max_by_key(|k| beside(k)).unwrap_or(first)
}

/// The things of which some contact is, with their labels.
fn with_contacts(things: Vec<Thing>, labels: &mut [u32]) -> Vec<Thing> {
    let is_held: Vec<bool> = (0..things.len() as u32).map(|k| labels.contains(&k)).collect();
    let number = |k: u32| is_held[..k as usize].iter().filter(|held| **held).count() as u32;
    labels.iter_mut().filter(|label| **label != NONE).for_each(|label| *label = number(*label));
    things.into_iter().zip(is_held).filter(|(_, held)| *held).map(|(thing, _)| thing).collect()
}

/// The primitive on the side to which the normals of its contacts point.
fn facing(primitive: Primitive, part: u32, labels: &[u32], cloud: &Cloud) -> Primitive {
    let own = (0..cloud.len()).filter(|i| labels[*i] == part);
    let towards = |i: usize| {
        let outwards = primitive.nearest(cloud.points[i]).1;
        (0..3).map(|k| outwards[k] * cloud.normals[i][k]).sum::<f64>().signum()
    };
    let turned = if own.map(towards).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    Primitive { side: turned * primitive.side, ..primitive }
}

#[cfg(test)]
mod tests {
    use crate::parts::{Part, PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    const RADIUS: f64 = 2.0;

    /// Places on a can of radius 2 and height 5, two thirds of them on its side, or on the side alone.
    fn places(count: u64, with_ends: bool) -> Vec<Vector> {
        let draws = EffectDraws::new(21, "sparse can");
        let one = |k: u64| {
            let mut at = [0.0; 3];
            draws.uniforms(k, 0, 3, &mut at);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let (rho, z) = match k % 6 {
                0 if with_ends => (RADIUS * at[2].sqrt(), 5.0),
                3 if with_ends => (RADIUS * at[2].sqrt(), 0.0),
                _ => (RADIUS, 5.0 * at[1]),
            };
            [rho * cos, rho * sin, z]
        };
        (0..count).map(one).collect()
    }

    fn of(points: &[Vector]) -> Vec<Part> {
        Parts::of(&Contacts::from_points(points), &PartsOptions::default()).unwrap().parts
    }

    /// Planes through neighbours that lie far apart are no normals: such a can was one ball, and such a bar a patch.
    #[test]
    fn sparse_places_are_the_parts_that_recognition_names() {
        let kinds: Vec<PartKind> = of(&places(80, true)).iter().map(|part| part.kind).collect();
        assert_eq!(kinds, [PartKind::Cylinder, PartKind::Plane, PartKind::Plane]);
        let bar = of(&places(30, false));
        assert_eq!((bar.len(), bar[0].kind), (1, PartKind::Cylinder));
        assert!((bar[0].geometry.radius.unwrap() - RADIUS).abs() < 1e-6, "{bar:?}");
    }

    /// Waves of three spacings each way are of no primitive, and were a cone for every crest; two faces with an edge are no waves.
    #[test]
    fn waves_without_normals_are_one_smooth_surface_and_faces_are_not() {
        let lattice = |k: u32| [f64::from(k % 20) * 0.5, f64::from(k / 20) * 0.5];
        let waves = |k: u32| {
            let [x, y] = lattice(k);
            [x, y, x.cos() + y.sin().powi(2)]
        };
        let one = of(&(0..400).map(waves).collect::<Vec<Vector>>());
        assert_eq!((one.len(), one[0].kind, one[0].points), (1, PartKind::Patch, 400));
        let roof = |k: u32| {
            let [x, y] = lattice(k);
            [x, y, -(x - 4.8).abs()]
        };
        let kinds: Vec<PartKind> = of(&(0..400).map(roof).collect::<Vec<Vector>>()).iter().map(|p| p.kind).collect();
        assert_eq!(kinds, [PartKind::Plane; 2]);
    }

    /// A stem that is not quite round, without normals: what parts there are of it, one cylinder holds as well.
    #[test]
    fn a_stem_that_is_not_quite_round_is_one_part() {
        let draws = EffectDraws::new(22, "stem");
        let place = |k: u64| {
            let mut at = [0.0; 14];
            draws.uniforms(k, 0, 14, &mut at);
            let turn = std::f64::consts::TAU * at[0];
            let radius = 0.25 + 0.003 * (3.0 * turn).cos() + 0.002 * (at[2..].iter().sum::<f64>() - 6.0);
            [radius * turn.cos(), radius * turn.sin(), at[1]]
        };
        let stem = of(&(0..2000).map(place).collect::<Vec<Vector>>());
        assert_eq!((stem.len(), stem[0].kind), (1, PartKind::Cylinder));
        assert!((stem[0].geometry.radius.unwrap() - 0.25).abs() < 0.002, "{stem:?}");
    }
}
