//! A few touches all over things with faces and walls: each is told as what it is made of.

use super::faces::faces;
use super::inference::{Verdict, infer, infer_primitives};
use super::sample::BodySample;
use super::tests::gaussian;
use super::thing::Thing;
use super::tuning::Tuning;
use crate::primitives::placed::PartKind;
use palpate_geometry::contact::Rounding;
use palpate_numeric::draws::Lcg;
use palpate_numeric::vector::{Vector, along, unit};

/// Places and normals on every side of a box in turn, with errors.
fn touched_box(count: usize, [place, degrees]: [f64; 2], generator: &mut Lcg) -> BodySample {
    let half = [0.5, 0.7, 0.9];
    let one = |i: usize| {
        let (axis, side) = (i % 3, if i % 6 < 3 { 1.0 } else { -1.0 });
        let inside = half.map(|h| h * (2.0 * generator.uniform() - 1.0));
        let at = |k: usize| if k == axis { side * half[k] } else { inside[k] };
        let normal: Vector = [0, 1, 2].map(|k| if k == axis { side } else { 0.0 });
        let mut noise = |sd: f64| [0; 3].map(|_| sd * gaussian(generator));
        let found = along([0, 1, 2].map(at), 1.0, noise(place));
        (found, unit(along(normal, 1.0, noise(degrees.to_radians()))))
    };
    let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..count).map(one).unzip();
    BodySample::new(&points, &normals, Rounding::NONE).unwrap()
}

/// Two walls about one axis, their normals facing each other, and some places that belong to neither.
fn touched_walls(count: usize, generator: &mut Lcg) -> BodySample {
    let one = |i: usize| {
        let (radius, side) = if i.is_multiple_of(2) { (1.0, 1.0) } else { (0.8, -1.0) };
        let (sin, cos) = (std::f64::consts::TAU * generator.uniform()).sin_cos();
        let off = if i.is_multiple_of(20) { 0.4 } else { 0.005 };
        let (along_axis, r) = (2.0 * generator.uniform(), radius + off * gaussian(generator));
        ([r * cos, r * sin, along_axis], [side * cos, side * sin, 0.0])
    };
    let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..count).map(one).unzip();
    BodySample::new(&points, &normals, Rounding::NONE).unwrap()
}

fn things_of(sample: &BodySample) -> Vec<Thing> {
    match infer(sample, &Tuning::default()) {
        Verdict::Several(things) => things,
        other => panic!("{other:?}"),
    }
}

#[test]
fn four_touches_of_every_side_of_a_box_are_its_six_faces() {
    let mut generator = Lcg::new(3);
    for errors in [[0.003, 3.0], [0.01, 1.0]] {
        let sample = touched_box(24, errors, &mut generator);
        let six = faces(&sample, &Tuning::default()).into_iter().find(|known| known.len() == 6).unwrap();
        assert!(six.iter().all(|face| face.members.len() == 4));
        assert!(six.iter().all(|face| face.members.iter().all(|i| i % 6 == face.members[0] % 6)));
        let things = things_of(&sample);
        assert_eq!(things.len(), 6, "{things:?}");
        assert!(things.iter().all(|thing| thing.primitive.kind == PartKind::Plane && thing.contacts == 4));
    }
}

/// Fingers that slide along a trough leave rows, each of which lies in a plane with its normals.
#[test]
fn rows_along_a_trough_are_no_planes() {
    let mut generator = Lcg::new(6);
    for fingers in [3, 4] {
        let one = |i: usize| {
            let x = (i % fingers) as f64 - 0.5 * (fingers - 1) as f64;
            ([x, 0.4 * (i / fingers) as f64, 0.1 * x * x + 1e-6 * gaussian(&mut generator)], unit([-0.2 * x, 0.0, 1.0]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..7 * fingers).map(one).unzip();
        let sample = BodySample::new(&points, &normals, Rounding::NONE).unwrap();
        assert!(!matches!(infer(&sample, &Tuning::default()), Verdict::Several(_)));
    }
}

/// What a first thing leaves out may be one face.
#[test]
fn a_bar_with_an_end_is_two_things() {
    let mut generator = Lcg::new(5);
    let one = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * generator.uniform()).sin_cos();
        let (place, normal) = if i.is_multiple_of(3) {
            let r = 0.5 * generator.uniform().sqrt();
            ([r * cos, r * sin, 1.0], [0.0, 0.0, 1.0])
        } else {
            ([0.5 * cos, 0.5 * sin, generator.uniform()], [cos, sin, 0.0])
        };
        let mut noise = |sd: f64| [0; 3].map(|_| sd * gaussian(&mut generator));
        (along(place, 1.0, noise(0.003)), unit(along(normal, 1.0, noise(0.05))))
    };
    let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..18).map(one).unzip();
    let things = things_of(&BodySample::new(&points, &normals, Rounding::NONE).unwrap());
    let mut found: Vec<(PartKind, usize)> = things.iter().map(|thing| (thing.primitive.kind, thing.contacts)).collect();
    found.sort_by_key(|(_, contacts)| *contacts);
    assert_eq!(found, [(PartKind::Plane, 6), (PartKind::Cylinder, 12)]);
}

#[test]
fn walls_that_face_each_other_are_two_though_some_places_are_false() {
    let mut generator = Lcg::new(8);
    for count in [40, 80] {
        let things = things_of(&touched_walls(count, &mut generator));
        let mut radii: Vec<f64> = things.iter().map(|thing| thing.primitive.sizes[0]).collect();
        radii.sort_by(f64::total_cmp);
        assert_eq!(things.len(), 2, "{things:?}");
        assert!(things.iter().all(|thing| thing.primitive.kind == PartKind::Cylinder), "{things:?}");
        assert!((radii[1] / radii[0] - 1.25).abs() < 0.02, "{radii:?}");
    }
}

/// The farther two sheets are apart, the likelier they are two things: where that is open, one answer says so.
#[test]
fn two_sheets_that_are_hardly_apart_are_said_to_be_possible() {
    let touched = |apart: f64| {
        let mut generator = Lcg::new(21);
        let one = |i: usize| {
            let side = if i % 4 == 3 { -1.0 } else { 1.0 };
            let place = [2.0 * generator.uniform(), 2.0 * generator.uniform(), 0.5 * side * apart];
            let mut noise = |sd: f64| [0; 3].map(|_| sd * gaussian(&mut generator));
            (along(place, 1.0, noise(0.02)), unit(along([0.0, 0.0, side], 1.0, noise(0.05))))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..16).map(one).unzip();
        BodySample::new(&points, &normals, Rounding::NONE).unwrap()
    };
    let probability = |k: i32| match infer_primitives(&touched(0.02 * f64::from(k)), &Tuning::default()) {
        Verdict::One(one) => one.instead.as_ref().map_or(0.0, |instead| instead.probability),
        Verdict::Several(_) => 1.0,
        other => panic!("{other:?}"),
    };
    let all: Vec<f64> = (0..=15).map(probability).collect();
    assert!(all[0] == 0.0 && all[15] == 1.0, "{all:?}");
    assert!(all.iter().any(|p| (0.05..0.5).contains(p)), "{all:?}");
    assert!(all.iter().all(|p| *p <= 0.5 || *p == 1.0), "{all:?}");
}
