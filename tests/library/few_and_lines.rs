//! Contacts that positions alone do not make a surface of: one ring, two rows, one row, four to ten touches. Their normals tell.

use palpate::recognition::{Hypothesis, Recognition, RecognitionError, RecognitionOptions};
use palpate::{Contacts, Orientation};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use crate::binomial::{Coverage, assert_share};

const RADIUS: f64 = 20.0;

/// Contacts of a ball, or of a bar along y, with errors of positions along every axis and of normals.
fn touched(places: &[[f64; 2]], ball: bool, [sd, sd_deg]: [f64; 2], seed: u64) -> Contacts {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (place, tilt) = (Normal::new(0.0, sd).unwrap(), Normal::new(0.0, sd_deg.to_radians()).unwrap());
    let mut columns: [Vec<f64>; 6] = Default::default();
    for &[x, y] in places {
        let across = if ball { y } else { 0.0 };
        let up = (RADIUS * RADIUS - x * x - across * across).sqrt();
        let at = [x, y, up - RADIUS].map(|v| v + place.sample(&mut random));
        let normal = [x, across, up].map(|v| v / RADIUS + tilt.sample(&mut random));
        columns.iter_mut().zip(at.into_iter().chain(normal)).for_each(|(column, v)| column.push(v));
    }
    let [x, y, z, nx, ny, nz] = columns;
    Contacts::from_positions(x, y, z).with_normals(nx, ny, nz)
}

fn ring(radius: f64) -> Vec<[f64; 2]> {
    (0..40)
        .map(|k| (k as f64 * std::f64::consts::TAU / 40.0).sin_cos())
        .map(|(s, c)| [radius * c, radius * s])
        .collect()
}

fn rows(apart: f64) -> Vec<[f64; 2]> {
    (0..30).map(|k| [(k % 15) as f64 - 7.0, if k < 15 { -0.5 * apart } else { 0.5 * apart }]).collect()
}

fn of(contacts: &Contacts) -> Result<Recognition, RecognitionError> {
    Recognition::of(contacts, &RecognitionOptions::default())
}

/// All surfaces through a ring have the same positions there. A ring's normals say which it is, and were thrown away because they
/// contradicted the one that positions happened to lead to.
#[test]
fn a_ring_of_touches_shows_the_ball_by_its_normals() {
    for (radius, noise) in [(8.0, [1e-4, 0.05]), (8.0, [0.05, 2.0]), (15.0, [0.01, 2.0])] {
        for seed in 0..6 {
            let found = of(&touched(&ring(radius), true, noise, seed)).unwrap();
            assert_eq!((found.hypothesis, found.class.name()), (Hypothesis::Sphere, "cap"), "{noise:?} {seed}");
            let off = found.curvedness.mean * RADIUS - 1.0;
            assert!(off.abs() < 4e-4 + 0.04 * noise[1], "{radius} {noise:?} {seed}: {off}");
        }
    }
}

/// One in fifty of these, and one in fifteen of the bars, is refused as going round more than half a body, which counts as an interval
/// that holds nothing.
#[test]
fn two_rows_show_ball_and_bar_by_their_normals() {
    let (mut of_ball, mut of_bar) = (Coverage::default(), Coverage::default());
    for seed in 0..69 {
        match of(&touched(&rows(8.0), true, [0.05, 2.0], seed)) {
            Ok(ball) => {
                assert_eq!(ball.class.name(), "cap", "{seed}");
                curvedness(&mut of_ball, &ball, 1.0 / RADIUS);
            }
            Err(refused) => unanswered(&mut of_ball, &refused),
        }
        match of(&touched(&rows(4.0), false, [0.05, 2.0], seed)) {
            Ok(bar) => curvedness(&mut of_bar, &bar, std::f64::consts::FRAC_1_SQRT_2 / RADIUS),
            Err(refused) => unanswered(&mut of_bar, &refused),
        }
    }
    of_ball.assert(0.8, [1.0, 1.0], "R of a ball under two rows");
    of_bar.assert(0.8, [1.0, 1.4], "R of a bar under two rows");
}

fn curvedness(coverage: &mut Coverage, found: &Recognition, truth: f64) {
    let r = &found.curvedness;
    coverage.answer([r.mean, r.u], r.interval, truth);
}

fn unanswered(coverage: &mut Coverage, refused: &RecognitionError) {
    assert!(matches!(refused, RecognitionError::AllAround { .. }), "{refused}");
    coverage.refusal();
}

/// The path of one finger tells nothing of the bend across it, and its arc is no patch: the refusal says so.
#[test]
fn one_row_is_refused_as_a_line() {
    let row: Vec<[f64; 2]> = (0..30).map(|k| [0.6 * k as f64 - 8.7, 0.0]).collect();
    for (seed, noise) in [[1e-4, 0.05], [0.05, 2.0]].into_iter().enumerate() {
        for ball in [true, false] {
            let refused = of(&touched(&row, ball, noise, seed as u64)).unwrap_err();
            assert!(matches!(refused, RecognitionError::Collinear { .. }), "{refused}");
        }
    }
}

/// Without normals a ring and two rows lie on many surfaces: one of them was the answer, a pipe of radius 736,755 "47 % sure".
#[test]
fn rings_and_rows_without_normals_are_refused() {
    let [exact, rough] = [[1e-4, 0.05], [0.05, 2.0]];
    // rows that lie near each other are blurred by rough errors, and then tell something of the bend, with much doubt
    for (places, noises) in [(rows(8.0), vec![exact, rough]), (rows(3.0), vec![exact]), (ring(5.0), vec![exact, rough])]
    {
        for noise in noises {
            let given = touched(&places, true, noise, 3);
            assert!(of(&given).is_ok());
            let positions: Vec<[f64; 3]> = (0..given.len()).map(|r| [given.x[r], given.y[r], given.z[r]]).collect();
            let refused = of(&Contacts::from_points(&positions)).unwrap_err();
            assert!(matches!(refused, RecognitionError::OnConic), "{refused}");
        }
    }
}

/// A third of such patches was refused as several things, because one of six parameters' few residuals is always far off.
#[test]
fn seven_to_ten_touches_are_not_refused() {
    for seed in 0..30 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let count = 7 + (seed % 4) as usize;
        let places: Vec<[f64; 2]> = (0..count).map(|_| [0; 2].map(|_| random.random_range(-5.0..5.0))).collect();
        let found = of(&touched(&places, true, [0.05, 2.0], seed));
        assert!(found.as_ref().is_ok_and(|found| found.outliers == 0), "{count} {seed}: {:?}", found.err());
    }
}

/// Four contacts always lie on a sphere: they do not say that positions have no errors, and R was known to five digits and wrong.
#[test]
fn few_touches_have_errors_too() {
    let mut coverage = Coverage::default();
    for seed in 0..200 {
        let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
        let count = 4 + (seed % 3) as usize;
        let places: Vec<[f64; 2]> = (0..count).map(|_| [0; 2].map(|_| random.random_range(-5.0..5.0))).collect();
        let Ok(found) = of(&touched(&places, true, [0.05, 2.0], seed)) else {
            coverage.refusal();
            continue;
        };
        let [lo, hi] = found.curvedness.interval;
        assert!(hi - lo > 0.02 / RADIUS, "{count} {seed}: {lo} {hi}");
        curvedness(&mut coverage, &found, 1.0 / RADIUS);
    }
    coverage.assert(0.85, [1.0, 1.25], "R of four to six touches");
}

/// A normal that is not known says nothing of the errors of the others. It was a normal without errors, and those that scatter by 2
/// degrees had 0.01.
#[test]
fn normals_that_are_not_known_have_no_errors() {
    let (mut coverage, mut told) = (Coverage::default(), 0);
    for seed in 0..69 {
        let mut contacts = touched(&rows(8.0), true, [0.05, 2.0], seed);
        let more = touched(&rows(3.0), true, [0.05, 2.0], 1000 + seed);
        let Orientation::Normals { nx, ny, nz } = &mut contacts.orientation else { panic!("no normals") };
        let zeros = || std::iter::repeat_n(0.0, more.len());
        [nx, ny, nz].into_iter().for_each(|column| column.extend(zeros()));
        contacts.x.extend(&more.x);
        contacts.y.extend(&more.y);
        contacts.z.extend(&more.z);
        let found = of(&contacts).unwrap();
        assert_eq!(found.normals_of_length_zero, more.len());
        let sd = found.noise.sd_normal_deg.unwrap();
        told += u64::from((1.4..2.6).contains(&sd));
        curvedness(&mut coverage, &found, 1.0 / RADIUS);
    }
    assert_share(told, 69, [0.99, 0.88], "errors of normals within 30 %");
    coverage.assert(0.8, [1.0, 1.0], "R beside normals that are not known");
}

/// Waves of 0.47 rms whose neighbours differ by 0.01 are no errors of a sensor, and what they are on is not flat.
#[test]
fn dense_waves_are_no_plane() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let noise = Normal::new(0.0, 0.01).unwrap();
    let wave = |v: f64| (std::f64::consts::TAU * v / 4.0).sin();
    let point = |k: i32| {
        let [x, y] = [k % 40, k / 40].map(|v| 12.0 * f64::from(v) / 39.0 - 6.0);
        [x, y, wave(x) * wave(y)]
    };
    let points: Vec<[f64; 3]> = (0..1600).map(point).map(|[x, y, z]| [x, y, z + noise.sample(&mut random)]).collect();
    let found = of(&Contacts::from_points(&points)).unwrap();
    assert!(found.misfit.p < 1e-3 && found.misfit.percent_of_relief > 200.0, "{:?}", found.misfit);
}
