//! Half bodies under errors that neighbours share: what a patch of no cone takes for such errors may be a cone.

use palpate::Contacts;
use palpate::recognition::{Hypothesis, Recognition, RecognitionOptions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Sds of a contact's own error and of the one that it shares, and the length over which it does.
const OWN: f64 = 0.003;
const SHARED: f64 = 0.01;
const SHARED_OVER: f64 = 0.4;

/// Waves of which the shared error is the sum: a gaussian process in the manner of A. Rahimi and B. Recht, *NIPS* 20 (2007).
const WAVES: usize = 60;

/// Two thirds of the way round a cone of this half angle, radius 1 half way up, between heights -1 and 1.
fn half_cone(degrees: f64, shared: f64, seed: u64) -> Contacts {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let waves: Vec<([f64; 3], f64)> = (0..WAVES)
        .map(|_| {
            let wave = [0, 1, 2].map(|_| normal.sample(&mut random) / SHARED_OVER);
            (wave, std::f64::consts::TAU * random.random::<f64>())
        })
        .collect();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let points: Vec<[f64; 3]> = (0..60)
        .map(|_| {
            let (across, along) = (1.2 * (2.0 * random.random::<f64>() - 1.0_f64)).sin_cos();
            let h = 2.0 * random.random::<f64>() - 1.0;
            let r = 1.0 - h * sin / cos;
            let place = [r * along, r * across, h];
            let wave = |(w, from): &([f64; 3], f64)| (w[0] * place[0] + w[1] * place[1] + w[2] * place[2] + from).cos();
            let alike: f64 = waves.iter().map(wave).sum::<f64>() * (2.0 / WAVES as f64).sqrt();
            let off = shared * alike + OWN * normal.sample(&mut random);
            let outwards = [cos * along, cos * across, sin];
            [0, 1, 2].map(|k| place[k] + off * outwards[k])
        })
        .collect();
    Contacts::from_points(&points)
}

fn kinds(degrees: f64, shared: f64) -> Vec<Hypothesis> {
    let recognised = |seed| Recognition::of(&half_cone(degrees, shared, seed), &RecognitionOptions::default()).unwrap();
    (0..12).map(|seed| recognised(seed).hypothesis).collect()
}

/// They were rings and bars, more than 95 % sure, in 20 of 64 touches.
#[test]
fn half_a_cone_is_one_whatever_its_neighbours_share() {
    for degrees in [10.0, 20.0] {
        for shared in [0.0, SHARED] {
            let found = kinds(degrees, shared);
            let cones = found.iter().filter(|kind| **kind == Hypothesis::Cone).count();
            assert!(cones >= 11, "{degrees} degrees, {shared} shared: {found:?}");
        }
    }
}

#[test]
fn half_a_bar_is_no_cone() {
    let found = kinds(0.0, SHARED);
    let bars = found.iter().filter(|kind| **kind == Hypothesis::Cylinder).count();
    assert!(bars >= 11 && !found.contains(&Hypothesis::Cone), "{found:?}");
}
