//! Touches too few for neighbourhoods: the primitive that they are of, where they tell one.
//!
//! ```text
//! primitives and their probabilities by `bodies`           part: the likeliest;  u: root mean squares over draws of its kind
//! ```
//!
//! A part is grown over the neighbours of its contacts, which takes some two dozen of these. A ball of five touches is one part all the same.

use super::answer::{class_of, extent, geometry, mean_shape, share_against};
use super::cloud::Cloud;
use super::ordered_contacts::places;
use super::result::{Part, PartUncertainty, Parts};
use crate::bodies::{self, BodyPosterior, BodySample, Tuning, Verdict};
use crate::primitives::placed::{PartKind, Primitive};
use palpate_geometry::contact::{Contacts, Rounding};
use palpate_numeric::vector::{Vector, along, cross, dot, minus, norm};

/// Draws of the posterior come from this stream.
const SEED: u64 = 1;

/// One primitive for all contacts; `None` where none is sure. `normals` are those of the file, or empty.
pub(super) fn one_of_few(
    contacts: &Contacts,
    normals: &[Vector],
    notes: Vec<String>,
    tuning: &Tuning,
) -> Option<Parts> {
    let points = &places(contacts);
    let blank = vec![[0.0, 0.0, 1.0]; points.len()];
    let cloud = Cloud::new(points, if normals.is_empty() { blank } else { normals.to_vec() })?;
    let cloud = cloud.rounded(Rounding::of_contacts(contacts));
    let sample = BodySample::new(&cloud.points, normals, cloud.rounding)?;
    let Verdict::One(found) = bodies::infer_primitives(&sample, tuning) else { return None };
    let kind = found.kind();
    let is_sure = found.weight_of(kind) >= tuning.sure_of_few && kind != PartKind::Ellipsoid;
    let primitive = found.likeliest(kind).filter(|_| is_sure)?;
    let members: Vec<u32> = found.members_of(kind).iter().map(|i| *i as u32).collect();
    let is_turned = !normals.is_empty() && share_against(&cloud, &primitive, &members) > 0.5;
    let primitive = Primitive { side: if is_turned { -primitive.side } else { primitive.side }, ..primitive };
    let node = found.best_of(kind)?;
    let drawn = drawn_beside(&primitive, &found, tuning);
    let mut labels = vec![None; points.len()];
    members.iter().for_each(|i| labels[*i as usize] = Some(0));
    Some(Parts {
        parts: vec![part(&cloud, &primitive, &members, &drawn, normals.is_empty())],
        joints: Vec::new(),
        labels,
        spacing: cloud.spacing * cloud.scale,
        noise: node.scatter() * cloud.scale,
        normal_noise_deg: if normals.is_empty() { 0.0 } else { node.sd_of_normals().to_degrees() },
        tolerance: 0.0,
        notes,
    })
}

fn part(cloud: &Cloud, primitive: &Primitive, members: &[u32], drawn: &[Primitive], is_open: bool) -> Part {
    let [s, r] = mean_shape(cloud, primitive, members);
    let class = class_of(primitive, s);
    let off = |i: &u32| primitive.nearest(cloud.points[*i as usize]).0;
    let square = members.iter().map(|i| off(i).powi(2)).sum::<f64>() / members.len().max(1) as f64;
    Part {
        id: 0,
        kind: primitive.kind,
        hollow: primitive.side < 0.0 && primitive.kind != PartKind::Plane,
        geometry: geometry(cloud, primitive),
        u: uncertainty(cloud, primitive, members, drawn),
        class: Some(class),
        other_class: Some(class.mirrored()).filter(|other| is_open && *other != class),
        shape_index: (primitive.kind != PartKind::Plane).then_some(s),
        curvedness: r / cloud.scale,
        points: members.len(),
        extent: extent(cloud, members) * cloud.scale,
        misfit: square.sqrt() * cloud.scale,
        rejected: None,
        p: None,
        departure: 0.0,
    }
}

/// Draws of the posterior that are of the likeliest primitive's kind, on its side.
fn drawn_beside(likeliest: &Primitive, found: &BodyPosterior, tuning: &Tuning) -> Vec<Primitive> {
    bodies::drawn(found, tuning, SEED)
        .iter()
        .map(|draw| Primitive { side: likeliest.side, ..draw.primitive })
        .filter(|primitive| primitive.kind == likeliest.kind)
        .collect()
}

/// Root mean squares of what the draws of the kind differ by from the likeliest.
fn uncertainty(cloud: &Cloud, likeliest: &Primitive, members: &[u32], drawn: &[Primitive]) -> PartUncertainty {
    let kind = likeliest.kind;
    let rms = |of: &dyn Fn(&Primitive) -> f64| {
        (drawn.iter().map(|p| of(p).powi(2)).sum::<f64>() / drawn.len().max(1) as f64).sqrt()
    };
    let has = |free: usize| kind.free().contains(&free);
    let size = |k: usize| move |p: &Primitive| p.sizes[k] - likeliest.sizes[k];
    let [of_s, of_r] = [0, 1].map(|k| {
        let middle = mean_shape(cloud, likeliest, members)[k];
        rms(&move |p| mean_shape(cloud, p, members)[k] - middle)
    });
    let (axis, origin) = (likeliest.axes[2], likeliest.origin);
    // of two directions across an axis, or of three, each has its share
    let (fixed, directions): (fn(Vector, Vector) -> f64, f64) = match kind {
        PartKind::Plane => (|off, axis| dot(off, axis), 1.0),
        PartKind::Cylinder | PartKind::Cone => (|off, axis| norm(along(off, -dot(off, axis), axis)), 2.0),
        _ => (|off, _| norm(off), 3.0),
    };
    let point = rms(&|p| fixed(minus(p.origin, origin), axis)) / directions.sqrt();
    let turned = |p: &Primitive| norm(cross(p.axes[2], axis)).atan2(dot(p.axes[2], axis).abs());
    let length = |v: f64| v * cloud.scale;
    PartUncertainty {
        point: Some(length(point)),
        axis_deg: has(3).then(|| rms(&turned).to_degrees() / 2.0_f64.sqrt()),
        radius: has(5).then(|| length(rms(&size(0)))),
        minor_radius: (kind == PartKind::Torus).then(|| length(rms(&size(1)))),
        half_angle_deg: (kind == PartKind::Cone).then(|| rms(&size(1)).to_degrees()),
        shape_index: (kind == PartKind::Torus).then_some(of_s),
        curvedness: (kind != PartKind::Plane).then(|| of_r / cloud.scale),
    }
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsError, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, unit};

    /// Touches of a bar of radius 3 from outside, with errors of 0.01.
    fn of_bar(count: u64) -> (Vec<Vector>, Vec<Vector>) {
        let draws = EffectDraws::new(4, "few of a bar");
        let touch = |k: u64| {
            let (mut at, mut off) = ([0.0; 2], [0.0; 4]);
            draws.uniforms(k, 0, 2, &mut at);
            draws.gaussians(k, 1, 4, &mut off);
            let (sin, cos) = (std::f64::consts::TAU * at[0]).sin_cos();
            let radius = 3.0 + 0.01 * off[0];
            let normal = [cos + 0.01 * off[1], sin + 0.01 * off[2], 0.01 * off[3]];
            ([radius * cos, radius * sin, 8.0 * at[1]], unit(normal))
        };
        (0..count).map(touch).unzip()
    }

    #[test]
    fn ten_touches_of_a_bar_are_one_part() {
        let (points, normals) = of_bar(10);
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Parts::of(&contacts, &PartsOptions::default()).unwrap();
        let [part] = &found.parts[..] else { panic!("{found:?}") };
        let (off, u) = ((part.geometry.radius.unwrap() - 3.0).abs(), part.u.radius.unwrap());
        assert!(part.kind == PartKind::Cylinder && !part.hollow && part.points == 10, "{part:?}");
        assert!(off < 3.0 * u && u < 0.05, "{off} {u}");
        assert_eq!(part.other_class, None);
    }

    #[test]
    fn touches_from_which_no_primitive_is_sure_are_refused() {
        let (points, _) = of_bar(4);
        let found = Parts::of(&Contacts::from_points(&points), &PartsOptions::default());
        assert!(matches!(found, Err(PartsError::TooFew { contacts: 4, .. })), "{found:?}");
    }
}
