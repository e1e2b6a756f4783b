//! From the partition to the answer: exact fits in the input's units, classes, joints, largest part first.

use super::cloud::{Cloud, DIGITS};
use super::delta_method::standard_uncertainties;
use super::evidence::Cells;
use super::exact::{Exact, StartNoise, simplest};
use super::free_form::{FreeForm, free_form};
use super::joint_angle::u_of_angle;
use super::joints::{FoundJoint, Joint, JointKind, joints};
use super::lack_of_fit_uncertainty::{is_free_form, is_rejected, reach};
use super::local::{LocalShape, LocalShapes, Noise};
use super::partition::{NONE, Partition};
use super::recognition_fallback::{Few, few};
use super::result::{Part, PartGeometry, PartUncertainty, Parts};
use super::sheet::SheetLimit;
use super::tuning::PartsTuning;
use super::unexplained_regions::label_leftover;
use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_geometry::curvature::{ShapeClass, curvedness, shape_index};
use palpate_numeric::linalg::small::Square;
use palpate_numeric::statistics::upper_median;
use palpate_numeric::threads;
use palpate_numeric::vector::{Vector, along, dot, minus, norm, scaled, unit_or_zero};

/// Where the parts are from.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// Regions that grew.
    Cut,
    /// Primitives of the whole cloud, fitted already.
    Whole,
    /// All contacts are one smooth surface.
    Free,
}

/// By what contacts were cut.
pub(super) struct CutBy {
    /// What contacts scatter by, with what is let pass.
    pub(super) coarse: Noise,
    /// What places are off by along the surface, where that turns their normals.
    pub(super) along: f64,
    pub(super) tolerance: f64,
    /// What the contacts of a surface scatter by.
    pub(super) limit: SheetLimit,
    /// Whether the normals are measurements.
    pub(super) measured: bool,
    /// Whether something tells which side is free.
    pub(super) side_known: bool,
    pub(super) origin: Origin,
}

/// What the answer is made of.
pub(super) struct Findings<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) shapes: &'a LocalShapes,
    pub(super) noise: Noise,
    pub(super) cells: &'a Cells,
    pub(super) by: &'a CutBy,
    pub(super) tuning: &'a PartsTuning,
}

impl Findings<'_> {
    /// The whole answer.
    pub(super) fn parts(&self, mut partition: Partition, notes: Vec<String>) -> Parts {
        let (cloud, tuning) = (self.cloud, self.tuning);
        let exact_parts = partition.parts.len() as u32;
        let patches = self.regions(&mut partition.labels, exact_parts);
        let members = partition_members(&partition.labels, (exact_parts + patches) as usize);
        let begin = StartNoise {
            coarse: self.by.coarse,
            is_known: self.by.origin == Origin::Whole,
            measured: self.by.measured,
            along: self.by.along,
            tuning,
        };
        let exact = threads::map(exact_parts as usize, 1, |part| {
            let inner = partition.inner(cloud, &members[part], tuning);
            simplest(cloud, &inner, &partition.parts[part], &begin, self.cells)
        });
        let few = few(cloud, self.by.measured, &members, &exact, tuning);
        let found = |k: usize| exact[k].map_or(partition.parts[k], |e| e.descended.primitive);
        let told = |k: usize| self.likely(found(k), &members[k], few[k].as_ref());
        let surface: Vec<Option<Primitive>> = (0..exact.len()).map(told).collect();
        let beside = |part: u32, i: usize, place: Vector| match surface.get(part as usize) {
            Some(Some(primitive)) => primitive.nearest(place),
            _ => (dot(minus(place, cloud.points[i]), cloud.normals[i]), cloud.normals[i]),
        };
        let found = joints(cloud, &partition.labels, self.by.coarse.distance, tuning, beside);
        let mut joints: Vec<Joint> = found.into_iter().map(|found| with_u_of_angle(found, &exact)).collect();
        let is_free_form = is_free_form(&exact, tuning);
        let part = |(k, members): (usize, &Vec<u32>)| match (surface.get(k), few.get(k).and_then(Option::as_ref)) {
            (Some(Some(primitive)), few) => {
                self.widened_part(primitive, exact[k].as_ref(), members, (is_free_form, few))
            }
            (_, Some(few)) => Part { class: Some(few.class()), ..self.patch_part(members, Some(few.free_form())) },
            (_, None) => self.patch_part(members, free_form(cloud, members, tuning)),
        };
        let mut parts: Vec<Part> = members.iter().enumerate().map(part).collect();
        let number = largest_first(&mut parts, &mut joints);
        let labels = partition.labels.iter().map(|l| (*l != NONE).then(|| number[*l as usize] as u32));
        self.answer(parts, joints, labels, notes)
    }

    /// The primitive, where what few touches tell does not contradict it.
    fn likely(&self, primitive: Primitive, members: &[u32], few: Option<&Few>) -> Option<Primitive> {
        let [s, r] = mean_shape(self.cloud, &primitive, members);
        let class = class_of(&primitive, s);
        let contradicts = few.is_some_and(|few| few.contradicts(primitive.kind, class, r, self.tuning));
        (!contradicts).then_some(primitive)
    }

    /// Labels regions that no primitive explains, from this number on; gives back how many there are.
    fn regions(&self, labels: &mut [u32], first: u32) -> u32 {
        match self.by.origin {
            Origin::Free => {
                labels.fill(first);
                1
            }
            Origin::Cut | Origin::Whole => {
                label_leftover(self.cloud, self.shapes, labels, first, (&self.by.limit, self.tuning))
            }
        }
    }

    fn answer(
        &self,
        mut parts: Vec<Part>,
        joints: Vec<Joint>,
        labels: impl Iterator<Item = Option<u32>>,
        notes: Vec<String>,
    ) -> Parts {
        let other = |class: &ShapeClass| Some(class.mirrored()).filter(|other| other != class);
        let open = parts.iter_mut().filter(|part| !self.by.side_known || part.other_class.is_some());
        open.for_each(|part| part.other_class = part.class.as_ref().and_then(other));
        let scale = self.cloud.scale;
        Parts {
            parts,
            joints,
            labels: labels.collect(),
            spacing: self.cloud.spacing * scale,
            noise: self.noise.distance * scale,
            normal_noise_deg: self.noise.normal.to_degrees(),
            tolerance: self.by.tolerance * scale,
            notes,
        }
    }

    /// A primitive with the uncertainties that few touches leave, where these are all.
    fn widened_part(
        &self,
        primitive: &Primitive,
        exact: Option<&Exact>,
        members: &[u32],
        (free_form, few): (bool, Option<&Few>),
    ) -> Part {
        let mut part = self.primitive_part(primitive, exact, members, free_form);
        if let Some(few) = few {
            few.widen(self.cloud, part.kind, part.geometry.radius, &mut part.u);
        }
        part
    }

    fn primitive_part(&self, primitive: &Primitive, exact: Option<&Exact>, members: &[u32], free_form: bool) -> Part {
        let cloud = self.cloud;
        let [s, r] = mean_shape(cloud, primitive, members);
        let mean = (primitive.kind != PartKind::Plane).then_some(s);
        let rejected = exact.and_then(|e| is_rejected(e, self.tuning));
        let mut u = exact.map_or(PartUncertainty::default(), |e| uncertainty(cloud, e, members));
        reach(cloud, members, exact, (mean, r), free_form || rejected == Some(true), self.tuning, &mut u);
        Part {
            id: 0,
            kind: primitive.kind,
            hollow: primitive.side < 0.0 && primitive.kind != PartKind::Plane,
            geometry: geometry(cloud, primitive),
            u,
            class: Some(class_of(primitive, s)),
            other_class: self.is_side_doubted(primitive, members).then(|| class_of(primitive, s)),
            shape_index: mean,
            curvedness: r / cloud.scale,
            points: members.len(),
            extent: extent(cloud, members) * cloud.scale,
            misfit: exact.map_or(0.0, |e| e.noise.distance * cloud.scale),
            rejected,
            p: exact.and_then(|e| e.p),
            departure: exact.map_or(0.0, |e| e.departure * cloud.scale),
        }
    }

    /// Whether many normals of a part point to its other side: signs were carried to it along ways that contradict each other.
    fn is_side_doubted(&self, primitive: &Primitive, members: &[u32]) -> bool {
        share_against(self.cloud, primitive, members) > self.tuning.side_doubted
    }

    /// By what was found of the region as a whole, else by the means over its contacts.
    fn patch_part(&self, members: &[u32], found: Option<FreeForm>) -> Part {
        let cloud = self.cloud;
        let middle = members.iter().fold([0.0; 3], |sum, &i| along(sum, 1.0, cloud.points[i as usize]));
        let point = cloud.outside(scaled(1.0 / members.len() as f64, middle));
        let (shape_index, curvedness, misfit) = match &found {
            Some(f) => (f.shape_index.map(|(mean, _)| mean), f.curvedness.0, f.misfit),
            None => self.means_over(members),
        };
        let u = found.map_or(PartUncertainty::default(), |f| PartUncertainty {
            shape_index: f.shape_index.and_then(|(_, u)| u),
            curvedness: f.curvedness.1.map(|u| u / cloud.scale),
            ..PartUncertainty::default()
        });
        // what no primitive was found for may be a plane all the same
        let axis = if shape_index.is_none() && curvedness <= DIGITS { common_normal(cloud, members) } else { None };
        let is_flat = axis.is_some();
        let class = if is_flat { Some(ShapeClass::Plane) } else { shape_index.map(ShapeClass::of_shape_index) };
        Part {
            id: 0,
            kind: if is_flat { PartKind::Plane } else { PartKind::Patch },
            hollow: false,
            geometry: PartGeometry { point, axis, ..PartGeometry::default() },
            u,
            class,
            other_class: None,
            shape_index,
            curvedness: curvedness / cloud.scale,
            points: members.len(),
            extent: extent(cloud, members) * cloud.scale,
            misfit: misfit * cloud.scale,
            rejected: None,
            p: None,
            departure: 0.0,
        }
    }

    /// S, R and the median misfit as the surfaces through neighbours have them.
    fn means_over(&self, members: &[u32]) -> (Option<f64>, f64, f64) {
        let known: Vec<&LocalShape> = self.shapes.of(self.cloud, members);
        let of_s: Vec<f64> = known.iter().filter_map(|s| s.principal.and_then(|p| p.shape_index())).collect();
        let of_r: Vec<f64> = known.iter().filter_map(|s| s.principal.map(|p| p.curvedness())).collect();
        let mean = |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let variances: Vec<f64> = known.iter().map(|s| s.variance[0]).collect();
        (mean(&of_s), mean(&of_r).unwrap_or(0.0), upper_median(variances).unwrap_or(0.0).sqrt())
    }
}

/// A joint with what the fits of both parts leave open of its angle.
fn with_u_of_angle(FoundJoint { joint, meetings }: FoundJoint, exact: &[Option<Exact>]) -> Joint {
    let ends = joint.parts.map(|part| exact.get(part).and_then(Option::as_ref));
    let u = u_of_angle(&meetings, ends, joint.kind == JointKind::Smooth);
    Joint { u_angle_deg: u.map(f64::to_degrees), ..joint }
}

/// The normal that all of these contacts have but for rounding.
fn common_normal(cloud: &Cloud, members: &[u32]) -> Option<Vector> {
    let along = |at: usize| members.iter().map(|&i| cloud.normals[i as usize][at]).sum::<f64>();
    let mean = unit_or_zero([0, 1, 2].map(along));
    members.iter().all(|&i| norm(minus(cloud.normals[i as usize], mean)) <= DIGITS).then_some(mean)
}

/// Numbers the parts anew, the largest first, and their joints with them; gives back the new number of each.
fn largest_first(parts: &mut [Part], joints: &mut [Joint]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|k| (std::cmp::Reverse(parts[*k].points), *k));
    let mut number = vec![0; parts.len()];
    order.iter().enumerate().for_each(|(id, k)| number[*k] = id);
    parts.iter_mut().zip(&number).for_each(|(part, id)| part.id = *id);
    parts.sort_by_key(|part| part.id);
    for joint in joints.iter_mut() {
        joint.parts = joint.parts.map(|k| number[k]);
        joint.parts.sort_unstable();
    }
    joints.sort_by_key(|joint| joint.parts);
    number
}

/// Share of the normals of a primitive's contacts that point to its other side.
pub(super) fn share_against(cloud: &Cloud, primitive: &Primitive, members: &[u32]) -> f64 {
    let is_against = |i: usize| dot(primitive.nearest(cloud.points[i]).1, cloud.normals[i]) < 0.0;
    members.iter().filter(|i| is_against(**i as usize)).count() as f64 / members.len().max(1) as f64
}

/// Mean S and R of a primitive over the places of its contacts, in the cloud's units.
pub(super) fn mean_shape<'a>(
    cloud: &Cloud,
    primitive: &Primitive,
    members: impl IntoIterator<Item = &'a u32>,
) -> [f64; 2] {
    let (mut s_sum, mut r_sum, mut count) = (0.0, 0.0, 0.0);
    for &i in members {
        let [k1, k2] = primitive.curvatures(cloud.points[i as usize]);
        s_sum += shape_index(k1 + k2, k1 - k2).unwrap_or(0.0);
        r_sum += curvedness(k1, k2);
        count += 1.0;
    }
    [s_sum / count, r_sum / count]
}

/// Distance between the contact that is farthest from the middle and the contact farthest from it: at least half of the largest between
/// two contacts, and nearly always that.
pub(super) fn extent(cloud: &Cloud, members: &[u32]) -> f64 {
    let sum = members.iter().fold([0.0; 3], |sum, &i| along(sum, 1.0, cloud.points[i as usize]));
    let middle = scaled(1.0 / members.len().max(1) as f64, sum);
    let farthest = |from: Vector| {
        let away = members.iter().map(|&i| minus(cloud.points[i as usize], from)).map(|off| dot(off, off));
        away.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let Some((end, _)) = farthest(middle) else { return 0.0 };
    farthest(cloud.points[members[end] as usize]).map_or(0.0, |(_, square)| square.sqrt())
}

/// Class of a primitive of this mean S.
pub(super) fn class_of(primitive: &Primitive, shape_index: f64) -> ShapeClass {
    if primitive.kind == PartKind::Plane { ShapeClass::Plane } else { ShapeClass::of_shape_index(shape_index) }
}

fn partition_members(labels: &[u32], parts: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); parts];
    for (i, label) in labels.iter().enumerate().filter(|(_, l)| **l != NONE) {
        members[*label as usize].push(i as u32);
    }
    members
}

/// In the input's units, with directions made unique: the largest component of an axis is positive, a cone widens along its own.
pub(super) fn geometry(cloud: &Cloud, primitive: &Primitive) -> PartGeometry {
    let [one, two, _] = primitive.sizes;
    let axis = primitive.axes[2];
    let largest = (0..3).fold(0, |best, k| if axis[k].abs() > axis[best].abs() { k } else { best });
    let upward = if axis[largest] < 0.0 { scaled(-1.0, axis) } else { axis };
    let point = cloud.outside(primitive.origin);
    let length = |v: f64| Some(v * cloud.scale);
    let base = PartGeometry { point, ..PartGeometry::default() };
    match primitive.kind {
        PartKind::Plane => PartGeometry { axis: Some(scaled(primitive.side, axis)), ..base },
        PartKind::Sphere => PartGeometry { radius: length(one), ..base },
        PartKind::Cylinder => PartGeometry { axis: Some(upward), radius: length(one), ..base },
        PartKind::Cone => PartGeometry {
            axis: Some(scaled(if two < 0.0 { -1.0 } else { 1.0 }, axis)),
            radius: length(one),
            half_angle_deg: Some(two.abs().to_degrees()),
            apex: (two != 0.0).then(|| cloud.outside(along(primitive.origin, -one / two.tan(), axis))),
            ..base
        },
        PartKind::Torus => PartGeometry { axis: Some(upward), radius: length(one), minor_radius: length(two), ..base },
        PartKind::Patch | PartKind::Ellipsoid => base,
    }
}

fn uncertainty(cloud: &Cloud, exact: &Exact, members: &[u32]) -> PartUncertainty {
    let Some(covariance) = exact.covariance() else { return PartUncertainty::default() };
    let kind = exact.descended.primitive.kind;
    let free = kind.free();
    let sd = |k: usize| free.contains(&k).then(|| covariance[k][k].max(0.0).sqrt());
    let length = |v: Option<f64>| v.map(|v| v * cloud.scale);
    // one number for several directions: the root mean square
    let joint = |of: &[usize]| {
        let sds: Vec<f64> = of.iter().filter_map(|k| sd(*k)).collect();
        (!sds.is_empty()).then(|| (sds.iter().map(|s| s * s).sum::<f64>() / sds.len() as f64).sqrt())
    };
    let [of_s, of_r] = of_shape(cloud, &exact.descended.primitive, &covariance, members);
    PartUncertainty {
        point: length(joint(&[0, 1, 2])),
        axis_deg: joint(&[3, 4]).map(f64::to_degrees),
        radius: length(sd(5)),
        minor_radius: if kind == PartKind::Torus { length(sd(6)) } else { None },
        half_angle_deg: if kind == PartKind::Cone { sd(6).map(f64::to_degrees) } else { None },
        shape_index: (kind == PartKind::Torus).then_some(of_s),
        curvedness: (kind != PartKind::Plane).then_some(of_r / cloud.scale),
    }
}

/// Standard uncertainties of mean S and R.
fn of_shape(cloud: &Cloud, primitive: &Primitive, covariance: &Square<MOST_UNKNOWNS>, members: &[u32]) -> [f64; 2] {
    /// Contacts over which the means are taken; they hardly change with more.
    const MEAN_CONTACTS: usize = 200;
    let some = || members.iter().step_by(members.len().div_ceil(MEAN_CONTACTS).max(1));
    standard_uncertainties(primitive, covariance, |moved| mean_shape(cloud, moved, some()))
}
