//! Parts of a body: what must not depend on how it lies, and how large its numbers are.

use palpate::parts::{JointKind, PartKind, Parts, PartsOptions};
use palpate::scene::{Effect, Solid, Surface, Sweep, World};
use palpate::{Contacts, Orientation};

/// A bar with a ball on top, beside a ring.
fn body() -> Contacts {
    let ball = Solid::ball(5.0).moved([0.0, 0.0, 7.0]);
    let ring = Solid::ring(9.0, 1.9).moved([0.0, 0.0, -4.0]);
    let surface = Surface::solids(vec![Solid::bar(5.0, 14.0), ball, ring]);
    let world = World::new(surface, Sweep::scan(0.7, None))
        .with(Effect::position_noise([0.02; 3]))
        .with(Effect::normal_noise(2.0));
    world.compile().unwrap().simulate(11, 0).0
}

fn found(contacts: &Contacts) -> Parts {
    Parts::of(contacts, &PartsOptions::default()).unwrap()
}

fn vectors(contacts: &Contacts) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let Orientation::Normals { nx, ny, nz } = &contacts.orientation else { panic!("no normals") };
    (0..contacts.len()).map(|r| ([contacts.x[r], contacts.y[r], contacts.z[r]], [nx[r], ny[r], nz[r]])).unzip()
}

/// Share of the contacts with the same part, parts being numbered alike.
fn same_labels(a: &Parts, b: &Parts, order: impl Fn(usize) -> usize) -> f64 {
    let same = (0..a.labels.len()).filter(|&i| a.labels[i] == b.labels[order(i)]).count();
    same as f64 / a.labels.len() as f64
}

fn radii(parts: &Parts) -> Vec<f64> {
    parts.parts.iter().filter_map(|part| part.geometry.radius).collect()
}

#[test]
fn the_body_is_found_with_its_sizes() {
    let parts = found(&body());
    let mut kinds: Vec<PartKind> = parts.parts.iter().map(|part| part.kind).collect();
    kinds.sort();
    assert_eq!(kinds, [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Torus]);
    for (radius, u) in parts.parts.iter().filter_map(|part| part.geometry.radius.zip(part.u.radius)) {
        let nearest = [5.0, 9.0].into_iter().fold(f64::INFINITY, |least: f64, r: f64| least.min((r - radius).abs()));
        assert!(nearest < 4.0 * u && u < 0.01, "{radius} +- {u}");
    }
    assert!(parts.parts.iter().all(|part| part.rejected != Some(true)));
    assert!(parts.joints.iter().any(|joint| joint.kind == JointKind::Smooth));
}

#[test]
fn rotation_and_unit_change_nothing_but_coordinates() {
    let contacts = body();
    let (points, normals) = vectors(&contacts);
    let before = found(&contacts);
    // a rotation by a third of a turn about (1, 1, 1), one by an odd angle about z, a shift, and metres
    let (sin, cos) = 0.7_f64.sin_cos();
    let turned = |[x, y, z]: [f64; 3]| [cos * z - sin * x, sin * z + cos * x, y];
    let moved = |p: [f64; 3]| turned(p).map(|v| 1e-3 * (v + 40.0));
    let again = Contacts::from_points(&points.iter().map(|p| moved(*p)).collect::<Vec<_>>())
        .with_normal_vectors(&normals.iter().map(|n| turned(*n)).collect::<Vec<_>>());
    let after = found(&again);
    assert!(same_labels(&before, &after, |i| i) > 0.999);
    assert_eq!(before.parts.len(), after.parts.len());
    for (a, b) in before.parts.iter().zip(&after.parts) {
        assert_eq!((a.kind, a.class, a.hollow), (b.kind, b.class, b.hollow));
    }
    for (a, b) in radii(&before).iter().zip(radii(&after)) {
        assert!((a - 1e3 * b).abs() < 1e-3 * a, "{a} {b}");
    }
}

#[test]
fn the_order_of_the_contacts_does_not_matter() {
    let contacts = body();
    let count = contacts.len();
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by(|a, b| (f64::from(*a) * 0.618).fract().total_cmp(&(f64::from(*b) * 0.618).fract()));
    let mut place = vec![0; count];
    order.iter().enumerate().for_each(|(k, i)| place[*i as usize] = k);
    let (before, after) = (found(&contacts), found(&contacts.in_order(&order)));
    assert!(same_labels(&before, &after, |i| place[i]) > 0.999);
    for (a, b) in radii(&before).iter().zip(radii(&after)) {
        assert!((a - b).abs() < 1e-3 * a, "{a} {b}");
    }
}

/// A dozen contacts of the top, too few to be a part, have the cone's label and must not turn its half angle.
#[test]
fn a_face_too_small_to_be_a_part_leaves_the_cone_as_it_is() {
    const BODIES: u64 = 8;
    let half_angle = (6.0_f64 - 1.2).atan2(10.0).to_degrees();
    let cone = || Solid::frustum(6.0, 1.2, 10.0).moved([0.0, 0.0, 10.0]);
    let mut squares = 0.0;
    for seed in 1..=BODIES {
        let world = World::new(Surface::solids(vec![Solid::bar(6.0, 10.0), cone()]), Sweep::scan(0.6, None))
            .with(Effect::position_noise([0.02; 3]))
            .with(Effect::normal_noise(2.0));
        let parts = found(&world.compile().unwrap().simulate(seed, 0).0);
        let part = parts.parts.iter().find(|part| part.kind == PartKind::Cone).unwrap();
        let error = part.geometry.half_angle_deg.unwrap() - half_angle;
        assert_ne!(part.rejected, Some(true), "seed {seed}: p = {:?}", part.p);
        squares += (error / part.u.half_angle_deg.unwrap()).powi(2);
    }
    // chi-square of 8 exceeds 26.1 once in a thousand
    assert!(squares < 26.1, "{squares}");
}

/// Faces of a box of side 4, turned, exact but for `step`, to which numbers are written; with the face of each contact.
fn faces(count: usize, step: f64) -> (Contacts, Vec<usize>) {
    let (sin, cos) = 0.5_f64.sin_cos();
    let turned = |[x, y, z]: [f64; 3]| {
        let [x, y] = [cos * x - sin * y, sin * x + cos * y];
        let [y, z] = [cos * y - sin * z, sin * y + cos * z];
        [x, y, z].map(|v| if step > 0.0 { (v / step).round() * step } else { v })
    };
    let place = |k: usize| {
        let [p, q] = [0.754_877_666_246_693, 0.569_840_290_998_053].map(|share: f64| 4.0 * (k as f64 * share).fract());
        turned([[p, q, 0.0], [0.0, p, q], [p, 0.0, q], [p, q, 4.0], [4.0, p, q], [p, 4.0, q]][k % count])
    };
    let points: Vec<[f64; 3]> = (0..3000).map(place).collect();
    (Contacts::from_points(&points), (0..3000).map(|k| k % count).collect())
}

/// A corner of a room and a cube, sampled without normals and without noise. Normals that are estimated across an edge lean, and tilted
/// planes that were exact: an exact corner fell into eleven parts.
#[test]
fn exact_faces_are_planes_to_their_last_contact() {
    for count in [3, 6] {
        for step in [0.0, 1e-6, 1e-3] {
            let (contacts, face) = faces(count, step);
            let parts = found(&contacts);
            let kinds: Vec<PartKind> = parts.parts.iter().map(|part| part.kind).collect();
            assert_eq!(kinds, vec![PartKind::Plane; count], "{count} faces, written to {step}");
            let misfit = parts.parts.iter().map(|part| part.misfit).fold(0.0, f64::max);
            assert!(misfit < step.max(1e-8), "{count} faces, written to {step}: {misfit}");
            // at an edge a contact may be of either face within the step, and at a corner far from all others of its own
            let of_face = |f: usize| {
                let labels: Vec<u32> = (0..3000).filter(|k| face[*k] == f).filter_map(|k| parts.labels[k]).collect();
                let most = (0..count as u32).map(|part| labels.iter().filter(|label| **label == part).count()).max();
                most.unwrap_or(0)
            };
            let right: usize = (0..count).map(of_face).sum();
            assert!(right + if step > 1e-4 { 30 } else { 10 } >= 3000, "{count} faces, written to {step}: {right}");
        }
    }
}

/// A column with six faces, seen without normals: of one face a ball of radius 99 was as near, and the face was called that ball.
#[test]
fn faces_with_noise_are_planes() {
    let chance = |k: usize, salt: f64| ((k as f64 * 12.9898 + salt).sin() * 43_758.547).rem_euclid(1.0);
    for (noise, salt) in [(0.001, 1.0), (0.01, 2.0), (0.01, 3.0)] {
        let place = |k: usize| {
            let (sin, cos) = ((k % 6) as f64 * std::f64::consts::FRAC_PI_3).sin_cos();
            let along = (2.0 * chance(k, salt) - 1.0) / 3.0_f64.sqrt();
            // of the variance of a gaussian
            let off = noise * ((0..12).map(|n| chance(k, salt + 7.0 + f64::from(n))).sum::<f64>() - 6.0);
            let [x, y] = [(1.0 + off) * cos - along * sin, (1.0 + off) * sin + along * cos];
            [x, 0.8 * y - 0.6 * 4.0 * chance(k, salt + 4.0), 0.6 * y + 0.8 * 4.0 * chance(k, salt + 4.0)]
        };
        let points: Vec<[f64; 3]> = (0..3000).map(place).collect();
        let kinds: Vec<PartKind> = found(&Contacts::from_points(&points)).parts.iter().map(|part| part.kind).collect();
        assert_eq!(kinds, [PartKind::Plane; 6], "noise {noise}");
    }
}
