//! Answers that are as uncertain as their noise and no more: a saddle beyond doubt, the axis of a cylinder.

use palpate::Contacts;
use palpate::recognition::{Recognition, RecognitionOptions};
use palpate_numeric::draws::EffectDraws;

use crate::binomial::{Coverage, assert_share};

type Vector = [f64; 3];

/// Uniform numbers between -1 and 1, and a gaussian one, of a contact.
fn drawn(seed: u64, contact: usize) -> ([f64; 2], f64) {
    let draws = EffectDraws::new(seed, "recognition tests");
    let (mut uniforms, mut gaussian) = ([0.0; 2], [0.0]);
    draws.uniforms(contact as u64, 0, 2, &mut uniforms);
    draws.gaussians(contact as u64, 9, 1, &mut gaussian);
    (uniforms.map(|v| 2.0 * v - 1.0), gaussian[0])
}

/// 60 contacts at random places of a square of half width 4, height noise `sd`.
fn patch(height: impl Fn(f64, f64) -> f64, sd: f64, seed: u64) -> Vec<Vector> {
    let contact = |i: usize| {
        let (place, noise) = drawn(seed, i);
        let [x, y] = place.map(|v| 4.0 * v);
        [x, y, height(x, y) + sd * noise]
    };
    (0..60).map(contact).collect()
}

fn recognised(points: &[Vector]) -> Recognition {
    Recognition::of(&Contacts::from_points(points), &RecognitionOptions::default()).unwrap()
}

/// A saddle that the contacts show beyond doubt has the uncertainty of its noise: departures from a torus, which they speak against,
/// would put the interval's end where these lie. On a lattice its mean S is zero by symmetry, and its axis is the frame's.
#[test]
fn a_certain_saddle_is_as_uncertain_as_its_noise() {
    let (mut coverage, mut narrow) = (Coverage::default(), 0);
    for seed in 0..69 {
        let lattice = (0..100).map(|i| [i / 10, i % 10].map(|k| 4.0 * (2.0 * k as f64 - 9.0) / 9.0));
        let points = lattice.enumerate().map(|(i, [x, y])| [x, y, 0.1 * x * y + 0.002 * drawn(700 + seed, i).1]);
        let found = recognised(&points.collect::<Vec<_>>());
        let (s, r) = (found.shape_index.unwrap(), found.curvedness);
        narrow += u64::from(s.u < 1.4 * s.u_noise && r.u < 1.4 * r.u_noise);
        coverage.answer([s.mean, s.u], s.interval, 0.0);
    }
    assert_share(narrow, 69, [0.95, 0.8], "saddles as uncertain as their noise");
    coverage.assert(0.8, [1.0, 1.0], "S of a certain saddle");
}

/// The bounds of the axis hold it about nineteen times in twenty, and narrow with the noise.
#[test]
fn the_axis_lies_within_its_bounds() {
    let cylinder = |x: f64, y: f64| (100.0 - (0.8 * x - 0.6 * y).powi(2)).sqrt() - 10.0;
    let bounds = |sd: f64| {
        let (mut coverage, mut sum) = (Coverage::default(), 0.0);
        for seed in 0..69 {
            let found = recognised(&patch(cylinder, sd, 100 + seed));
            let ([x, y, _], within) = (found.axis.unwrap(), found.axis_within_deg.unwrap());
            let off = (0.6 * x + 0.8 * y).abs().min(1.0).acos().to_degrees();
            // the bounds are 1.96 u of an angle in the plane of the patch
            coverage.answer([off, within / 1.96], [off - within, off + within], 0.0);
            sum += within / 69.0;
        }
        coverage.assert(0.8, [1.0, 1.0], "the axis of a cylinder");
        sum
    };
    let (wide, narrow) = (bounds(0.02), bounds(0.005));
    assert!(narrow < 0.5 * wide && wide < 5.0, "{narrow} and {wide} degrees");
    let sphere = |x: f64, y: f64| (100.0 - x * x - y * y).sqrt() - 10.0;
    assert_eq!(recognised(&patch(sphere, 0.02, 1)).axis_within_deg, None);
}
