//! The posterior against numbers that are known otherwise: evidence by integration, ranks of the truth, false contacts, two things.

use super::evidence::LinearisedBase;
use super::free_surface::free_surface;
use super::inference::{Verdict, infer};
use super::mode::{FalseContacts, Mode};
use super::posterior::{draws, spread};
use super::prior::log_prior;
use super::sample::BodySample;
use super::search::{ModeSearch, modes};
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_geometry::contact::Rounding;
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::{Vector, along, axes_along, unit};
use statrs::function::gamma::ln_gamma;

pub(super) fn gaussian(generator: &mut Lcg) -> f64 {
    let angle = std::f64::consts::TAU * generator.uniform();
    (-2.0 * (1.0 - generator.uniform()).ln()).sqrt() * angle.cos()
}

/// A primitive of some kind in some place, its sizes about 1.
fn body(kind: PartKind, generator: &mut Lcg) -> Primitive {
    let axis = unit([gaussian(generator), gaussian(generator), gaussian(generator)]);
    let sizes = match kind {
        PartKind::Cone => [1.0, 0.3, 0.0],
        PartKind::Torus => [1.0, 0.4, 0.0],
        PartKind::Ellipsoid => [1.0, 0.8, 0.6],
        _ => [1.0, 0.0, 0.0],
    };
    let origin = [4.0 * generator.uniform(), 2.0, -3.0 * generator.uniform()];
    Primitive { kind, origin, axes: axes_along(axis), sizes, side: 1.0 }
}

/// Places on a body, over so much of the way round, with noise along the normal, and the normals.
fn touched(body: &Primitive, count: usize, turn: f64, noise: f64, generator: &mut Lcg) -> (Vec<Vector>, Vec<Vector>) {
    let one = |_| {
        let (angle, rise) = (turn * (generator.uniform() - 0.5), 2.0 * generator.uniform() - 1.0);
        let own = match body.kind {
            PartKind::Sphere | PartKind::Ellipsoid => {
                let across = (1.0 - rise * rise).sqrt();
                [across * angle.cos(), across * angle.sin(), rise]
            }
            _ => [1.2 * angle.cos(), 1.2 * angle.sin(), rise],
        };
        let place = along(body.origin, 1.0, body.out(own));
        let (d, normal) = body.nearest(place);
        let error = noise * gaussian(generator);
        (along(place, error - d, normal), normal)
    };
    (0..count).map(one).unzip()
}

/// ln of the integral over theta of p(contacts | theta) p(theta), s integrated: importance sampling by the posterior's own draws, made
/// twice as wide.
fn by_integration(sample: &BodySample, start: &Primitive, tuning: &Tuning, generator: &mut Lcg) -> f64 {
    const DRAWS: usize = 20_000;
    const WIDE: f64 = 1.3;
    let found = modes(sample, tuning);
    let mode = found.iter().find(|m| m.primitive.kind == start.kind && m.strays == FalseContacts::None).unwrap();
    let linearised = LinearisedBase::new(mode, sample, tuning);
    let node = linearised.nodes(0, tuning).remove(0);
    let unknowns = node.step().len();
    let likelihood = |primitive: &Primitive| {
        let sum: f64 = sample.points.iter().map(|p| primitive.nearest(*p).0.powi(2)).sum();
        let half = 0.5 * sample.len() as f64;
        ln_gamma(half) - half * (std::f64::consts::PI * sum).ln() + log_prior(primitive, tuning)
    };
    let root = node.lower_determinant();
    let mut logs: Vec<f64> = Vec::new();
    for _ in 0..DRAWS {
        let z: Vec<f64> = (0..unknowns).map(|_| WIDE * gaussian(generator)).collect();
        let density = -0.5 * z.iter().map(|z| (z / WIDE).powi(2)).sum::<f64>()
            - unknowns as f64 * (WIDE * (2.0 * std::f64::consts::PI).sqrt() * node.scatter()).ln()
            + root;
        logs.push(likelihood(&linearised.drawn(&node, &z)) - density);
    }
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + (logs.iter().map(|l| (l - most).exp()).sum::<f64>() / DRAWS as f64).ln()
}

#[test]
fn evidence_is_that_of_integration() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(11);
    for case in 0..20 {
        let kind = [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone][case % 4];
        let truth = body(kind, &mut generator);
        let count = 16 + 4 * (case % 5);
        let (points, _) = touched(&truth, count, 6.0, 0.01, &mut generator);
        let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
        let found = modes(&sample, &tuning);
        let mode = found.iter().find(|m| m.primitive.kind == kind && m.strays == FalseContacts::None).unwrap();
        let linearised = LinearisedBase::new(mode, &sample, &tuning);
        let laplace =
            linearised.without_departure(&tuning).unwrap() - tuning.exact.ln() - linearised.of_no_false(&tuning);
        let integral = by_integration(&sample, &truth, &tuning, &mut generator);
        assert!((laplace - integral).abs() < 0.05, "{kind:?} of {count}: {laplace} for {integral}");
    }
}

/// Far from its mode the equations promise distances that no step reaches: a thing beside others once had evidence by them.
#[test]
fn a_primitive_away_from_its_contacts_has_no_evidence() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(12);
    let ball = Primitive { sizes: [1.0, 0.0, 0.0], ..body(PartKind::Sphere, &mut generator) };
    let (points, _) = touched(&ball, 40, 6.0, 0.01, &mut generator);
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let found = modes(&sample, &tuning);
    let near = found.iter().find(|m| m.primitive.kind == PartKind::Sphere && m.strays == FalseContacts::None).unwrap();
    assert!(LinearisedBase::new(near, &sample, &tuning).without_departure(&tuning).is_some());
    let origin = along(near.primitive.origin, 2.0, [1.0, 0.0, 0.0]);
    let far = Mode { primitive: Primitive { origin, ..near.primitive }, ..near.clone() };
    assert!(LinearisedBase::new(&far, &sample, &tuning).without_departure(&tuning).is_none());
}

/// The rank of the true radius among the draws is even: over ten bins of 120 bodies.
#[test]
fn the_truth_is_a_draw_of_the_posterior() {
    const BODIES: usize = 120;
    let tuning = Tuning { draws: 200, ..Tuning::default() };
    let mut generator = Lcg::new(23);
    for kind in [PartKind::Sphere, PartKind::Cylinder] {
        let mut bins = [0.0; 10];
        for number in 0..BODIES {
            let truth = body(kind, &mut generator);
            let (points, _) = touched(&truth, 20, 4.0, 0.02, &mut generator);
            let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
            let Verdict::One(posterior) = infer(&sample, &tuning) else { panic!("{kind:?} {number}: no answer") };
            let found = draws(&posterior, &tuning, number as u64);
            let own: Vec<f64> = found
                .iter()
                .filter(|d| d.primitive.kind == kind)
                .map(|d| d.primitive.sizes[0] * sample.frame.scale)
                .collect();
            assert!(own.len() > 100, "{kind:?} {number}: {}", own.len());
            let below = own.iter().filter(|r| **r < 1.0).count() as f64 / own.len() as f64;
            bins[((10.0 * below) as usize).min(9)] += 1.0;
        }
        let even = BODIES as f64 / 10.0;
        let square: f64 = bins.iter().map(|n| (n - even).powi(2) / even).sum();
        // chi-square of 9 exceeds 27.9 once in a thousand
        assert!(square < 27.9, "{kind:?}: {bins:?}");
    }
}

#[test]
fn a_third_of_false_contacts_moves_a_ball_by_no_more_than_noise() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(5);
    let truth = body(PartKind::Sphere, &mut generator);
    let (mut points, _) = touched(&truth, 60, 6.0, 0.01, &mut generator);
    points.extend((0..30).map(|_| [0, 1, 2].map(|k| truth.origin[k] + 4.0 * (generator.uniform() - 0.5))));
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let Verdict::One(posterior) = infer(&sample, &tuning) else { panic!("no answer") };
    assert_eq!(posterior.kind(), PartKind::Sphere);
    let members = posterior.members_of(PartKind::Sphere);
    assert!((55..=68).contains(&members.len()), "{}", members.len());
    let drawn = draws(&posterior, &tuning, 1);
    let balls = drawn.iter().filter(|d| d.primitive.kind == PartKind::Sphere);
    let radii: Vec<(f64, f64)> = balls.map(|d| (d.primitive.sizes[0] * sample.frame.scale, d.share)).collect();
    let found = spread(&radii, 0.95).unwrap();
    let [lo, hi] = found.interval;
    // 60 contacts that err by 0.01 leave the radius to some thousandths
    assert!(lo < 1.0 && 1.0 < hi && found.sd < 0.01 && hi - lo < 0.03, "{found:?}");
}

#[test]
fn two_walls_about_one_axis_are_two_things() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(8);
    let outer = body(PartKind::Cylinder, &mut generator);
    let inner = Primitive { sizes: [0.9, 0.0, 0.0], ..outer };
    let (mut points, _) = touched(&outer, 150, 6.0, 0.003, &mut generator);
    points.extend(touched(&inner, 150, 6.0, 0.003, &mut generator).0);
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let Verdict::Several(things) = infer(&sample, &tuning) else { panic!("one thing, or none") };
    let mut radii: Vec<f64> = things.iter().map(|thing| thing.primitive.sizes[0] * sample.frame.scale).collect();
    radii.sort_by(f64::total_cmp);
    assert!(radii.len() == 2 && (radii[0] - 0.9).abs() < 0.01 && (radii[1] - 1.0).abs() < 0.01, "{radii:?}");
}

/// Faces of a cube whose middles stand out by `bulge`, with noise, its normals with errors of `lean`, in a random pose.
fn cube(count: usize, bulge: f64, lean: f64, generator: &mut Lcg) -> (Vec<Vector>, Vec<Vector>) {
    let pose = body(PartKind::Plane, generator);
    let one = |k: usize| {
        let (axis, side) = (k % 3, if k.is_multiple_of(2) { 1.0 } else { -1.0 });
        let mut own = [0, 1, 2].map(|_| 2.0 * generator.uniform() - 1.0);
        let [u, v] = [1, 2].map(|next| own[(axis + next) % 3]);
        own[axis] = side * (1.0 + bulge * (1.0 - u * u) * (1.0 - v * v) + 0.003 * gaussian(generator));
        let mut normal = [0.0; 3];
        normal[axis] = side;
        normal[(axis + 1) % 3] = 2.0 * bulge * u * (1.0 - v * v);
        normal[(axis + 2) % 3] = 2.0 * bulge * v * (1.0 - u * u);
        let normal = unit(unit(normal).map(|n| n + lean * gaussian(generator)));
        (along(pose.origin, 1.0, pose.out(own)), pose.out(normal))
    };
    (0..count).map(one).unzip()
}

/// A bar or a cone follows four faces about an axis, however well the faces are told by their planes.
#[test]
fn a_cube_is_six_planes() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(41);
    for lean in [0.0, 0.02, 0.06, 0.06] {
        let (points, normals) = cube(300, 0.0, lean, &mut generator);
        let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
        let Verdict::Several(things) = infer(&sample, &tuning) else { panic!("one thing, or none") };
        assert!(things.iter().all(|thing| thing.primitive.kind == PartKind::Plane), "{things:?}");
        assert_eq!(things.len(), 6);
    }
}

/// A box of cardboard: no face is a plane to within the noise, and no smooth surface has its edges.
#[test]
fn a_cube_of_faces_that_bulge_is_several_things() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(42);
    for count in [150, 400] {
        let (points, normals) = cube(count, 0.03, 0.0, &mut generator);
        let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
        assert!(matches!(infer(&sample, &tuning), Verdict::Several(_)), "{count}");
    }
}

/// A ball with a bulge, which no primitive comes near.
#[test]
fn a_pear_is_a_free_surface_and_lies_where_it_is() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(43);
    let radius = |n: Vector| 1.0 + 0.25 * n[2] + 0.15 * n[2].powi(3) + 0.1 * (2.0 * n[0]).sin() * n[1];
    let mut points: Vec<Vector> = Vec::new();
    for _ in 0..300 {
        let direction = unit([gaussian(&mut generator), gaussian(&mut generator), gaussian(&mut generator)]);
        let r = radius(direction) + 0.002 * gaussian(&mut generator);
        points.push(direction.map(|v| r * v));
    }
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let posterior = free_surface(&sample, &ModeSearch::new(&tuning)).expect("a free surface");
    let drawn = draws(&posterior, &tuning, 1);
    let mut square = 0.0;
    for k in 0..100 {
        let (turn, h) = (2.4 * f64::from(k), f64::from(k) / 50.0 - 0.99);
        let across = (1.0 - h * h).sqrt();
        let direction = [across * turn.cos(), across * turn.sin(), h];
        let place = sample.frame.to_patch(direction.map(|v| radius(direction) * v));
        square += drawn[k as usize].distance(place).powi(2) / 100.0;
    }
    // noise is 0.002 of a body whose radius varies by 0.4
    assert!(square.sqrt() * sample.frame.scale < 0.01, "{}", square.sqrt());
}

/// A side of it does not go all round, and is told all the same from whatever primitive is next to it.
#[test]
fn one_side_of_a_pear_is_no_closed_surface() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(44);
    let radius = |n: Vector| 1.0 + 0.25 * n[2] + 0.15 * n[2].powi(3) + 0.1 * (2.0 * n[0]).sin() * n[1];
    let mut points: Vec<Vector> = Vec::new();
    while points.len() < 200 {
        let direction = unit([gaussian(&mut generator), gaussian(&mut generator), gaussian(&mut generator)]);
        if direction[0] > 0.3 {
            points.push(direction.map(|v| radius(direction) * v));
        }
    }
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let posterior = free_surface(&sample, &ModeSearch::new(&tuning)).expect("a free surface");
    assert!(!posterior.closes(&sample, &tuning));
}

/// Places on a bar of radius 1 and length 3 with half a ball at each end, each with its error.
fn capsule(count: usize, noise: f64, generator: &mut Lcg) -> Vec<Vector> {
    let place = |generator: &mut Lcg| {
        let direction = unit([gaussian(generator), gaussian(generator), gaussian(generator)]);
        // areas: 6 pi of the bar, 4 pi of both balls
        if generator.uniform() < 0.4 {
            along(direction, 1.5 * direction[2].signum(), [0.0, 0.0, 1.0])
        } else {
            let across = direction[0].hypot(direction[1]);
            [direction[0] / across, direction[1] / across, 3.0 * generator.uniform() - 1.5]
        }
    };
    (0..count).map(|_| place(generator).map(|v| v + noise * gaussian(generator))).collect()
}

#[test]
fn a_capsule_is_a_bar_and_two_balls_and_a_wave_is_one_thing() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(45);
    let points = capsule(160, 0.004, &mut generator);
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    let Verdict::Several(things) = infer(&sample, &tuning) else { panic!("one thing") };
    let of_kind = |kind: PartKind| things.iter().filter(move |thing| thing.primitive.kind == kind);
    assert_eq!((of_kind(PartKind::Cylinder).count(), of_kind(PartKind::Sphere).count(), things.len()), (1, 2, 3));
    for thing in &things {
        assert!((thing.primitive.sizes[0] * sample.frame.scale - 1.0).abs() < 0.01, "{thing:?}");
    }
    let mut wave = || {
        let [x, y] = [0, 1].map(|_| 3.0 * generator.uniform() - 1.5);
        [x, y, 0.2 * (3.0 * x).sin() + 0.003 * gaussian(&mut generator)]
    };
    let points: Vec<Vector> = (0..200).map(|_| wave()).collect();
    let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
    assert!(!matches!(infer(&sample, &tuning), Verdict::Several(_)));
}

#[test]
fn the_order_of_contacts_and_the_unit_of_length_change_no_kind() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(17);
    for kind in [PartKind::Sphere, PartKind::Cone, PartKind::Torus, PartKind::Ellipsoid] {
        let truth = body(kind, &mut generator);
        let (points, normals) = touched(&truth, 60, 6.0, 0.005, &mut generator);
        let scaled: Vec<Vector> = points.iter().rev().map(|p| p.map(|v| 1e3 * v)).collect();
        let reversed: Vec<Vector> = normals.iter().rev().copied().collect();
        for (points, normals) in [(points, normals), (scaled, reversed)] {
            let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
            let Verdict::One(posterior) = infer(&sample, &tuning) else { panic!("{kind:?}: no answer") };
            assert_eq!(posterior.kind(), kind);
            assert!(posterior.weight_of(kind) > 0.9, "{kind:?}: {}", posterior.weight_of(kind));
        }
    }
}

/// Residuals of the best primitive are what a departure can explain: none is larger, of whichever length and size.
#[test]
fn a_departure_is_no_larger_than_what_the_primitive_leaves() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(61);
    for kind in [PartKind::Cylinder, PartKind::Sphere, PartKind::Cone] {
        let truth = body(kind, &mut generator);
        let (mut points, _) = touched(&truth, 120, 1.6, 0.02, &mut generator);
        points.iter_mut().for_each(|p| p[2] += 0.03 * (2.0 * p[0]).sin());
        let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
        let found = modes(&sample, &tuning);
        let mode = found.iter().find(|m| m.primitive.kind == kind && m.strays == FalseContacts::None).unwrap();
        let left: f64 =
            points.iter().enumerate().map(|(i, _)| mode.primitive.nearest(sample.points[i]).0.powi(2)).sum();
        let rms = (left / points.len() as f64).sqrt();
        for node in LinearisedBase::new(mode, &sample, &tuning).departing(&tuning).nodes(0, &tuning) {
            assert!(node.departure_size() <= 1.001 * rms, "{kind:?} {:?}: {}", node.length(), node.departure_size());
        }
    }
}

/// A quarter of a pipe whose contacts err together and of which a tenth belong to nothing.
#[test]
fn a_part_of_a_pipe_that_departs_is_a_pipe_or_a_cone() {
    let tuning = Tuning::default();
    let mut generator = Lcg::new(71);
    for number in 0..4 {
        let truth = body(PartKind::Cylinder, &mut generator);
        let (mut points, _) = touched(&truth, 200, 1.8, 0.01, &mut generator);
        points.iter_mut().for_each(|p| p[2] += 0.015 * (3.0 * p[0]).sin());
        let off = |generator: &mut Lcg| 0.3 * gaussian(generator);
        (0..20).for_each(|i| points[10 * i] = points[10 * i].map(|v| v + off(&mut generator)));
        let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
        let Verdict::One(posterior) = infer(&sample, &tuning) else { panic!("{number}: no answer") };
        let straight = posterior.weight_of(PartKind::Cylinder) + posterior.weight_of(PartKind::Cone);
        assert!(straight > 0.9, "{number}: {straight}");
        let every = posterior.nodes.iter().map(|node| node.likeliest(&posterior.primitives[node.of]));
        every.into_iter().for_each(|p| assert!(super::mode::is_possible(&p), "{p:?}"));
    }
}

/// Bumps on a ball whose normals follow them are likelier shape. The same heights with the normals of the ball are errors that neighbours share.
#[test]
fn normals_tell_shape_from_an_error_that_neighbours_share() {
    let tuning = Tuning::default();
    for follow in [true, false] {
        let mut generator = Lcg::new(61);
        let one = |_| {
            let from = unit([0, 1, 2].map(|_| gaussian(&mut generator)));
            let (height, slope) = (0.06 * (4.0 * from[0]).sin(), 0.24 * (4.0 * from[0]).cos());
            let uphill = along([slope, 0.0, 0.0], -slope * from[0], from).map(|g| g / (2.0 + height));
            let normal = if follow { unit(along(from, -1.0, uphill)) } else { from };
            let off = [0, 1, 2].map(|_| 0.01 * gaussian(&mut generator));
            (from.map(|v| v * (2.0 + height + 0.004 * gaussian(&mut generator))), unit(along(normal, 1.0, off)))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..80).map(one).unzip();
        let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
        let (Verdict::One(found) | Verdict::Free { one: Some(found), .. }) = infer(&sample, &tuning) else {
            panic!("{follow}")
        };
        let departing: f64 = draws(&found, &tuning, 7).iter().filter(|d| d.departs()).map(|d| d.share).sum();
        assert!(if follow { departing > 0.6 } else { departing < 0.05 }, "{follow}: {departing}");
    }
}
