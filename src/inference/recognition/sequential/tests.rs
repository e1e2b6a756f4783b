use super::*;
use crate::recognition::{Hypothesis, RecognitionOptions};
use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::norm;
use statrs::function::erf::erf;

const NOISE: f64 = 0.03;

/// Touch k of a pipe of radius 10 along y, over 12 by 12 in any order.
fn on_pipe(seed: u64, k: u64) -> Vector {
    let draws = EffectDraws::new(seed, "sequential");
    let mut drawn = [0.0; 3];
    draws.gaussians(k, 0, 3, &mut drawn);
    // a gaussian's own share of its law is even from 0 to 1
    let even = |at: f64| 6.0 * erf(at / std::f64::consts::SQRT_2);
    let (x, y) = (even(drawn[0]), even(drawn[1]));
    [x, y, (100.0 - x * x).sqrt() + NOISE * drawn[2]]
}

/// Touch k of a whole ball of radius 5.
fn on_ball(seed: u64, k: u64) -> Vector {
    let draws = EffectDraws::new(seed, "ball");
    let mut drawn = [0.0; 4];
    draws.gaussians(k, 0, 4, &mut drawn);
    let [x, y, z, error] = drawn;
    let length = norm([x, y, z]);
    [x, y, z].map(|v| v / length * (5.0 + NOISE * error))
}

fn recognised(touches: &[Vector]) -> Recognition {
    let options = RecognitionOptions::default().with_up([0.0, 0.0, 1.0]);
    Recognition::of(&Contacts::from_points(touches), &options).unwrap()
}

fn posterior(found: &Recognition) -> SequentialPosterior {
    SequentialPosterior::after(found)
}

/// Means of R at the recognition, as touches move it, and of all touches at once, with the last one's uncertainty; `None` where a touch
/// called for a recognition.
fn three_ways(touches: &[Vector], first: usize) -> Option<([f64; 3], [f64; 2])> {
    let mut found = recognised(&touches[..first]);
    let (before, mut posterior) = (found.curvedness.mean, posterior(&found));
    for touch in &touches[first..] {
        if posterior.update(&mut found, *touch, None) != TouchUpdate::Moved {
            return None;
        }
    }
    assert_eq!((found.contacts, posterior.touches()), (touches.len(), touches.len() - first));
    // both curvatures move with S and R
    let size = found.k1.hypot(found.k2) * std::f64::consts::FRAC_1_SQRT_2;
    assert!((size / found.curvedness.mean - 1.0).abs() < 0.02, "{size} for {}", found.curvedness.mean);
    let all = recognised(touches);
    Some(([before, found.curvedness.mean, all.curvedness.mean], [found.curvedness.u, all.curvedness.u]))
}

/// Touches one by one must come to what all at once come to, and nearer to it than the answer before them.
fn touches_one_by_one_come_to_the_batch(of: fn(u64, u64) -> Vector) {
    let (mut standing, mut moved, mut widths, mut count) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..40 {
        let touches: Vec<Vector> = (0..50).map(|k| of(seed, k)).collect();
        let Some(([before, after, all], [u_after, u_all])) = three_ways(&touches, 40) else { continue };
        standing += ((before - all) / u_all).powi(2);
        moved += ((after - all) / u_all).powi(2);
        widths += (u_after / u_all).ln();
        count += 1.0;
    }
    assert!(count >= 24.0, "{count} of 40 sequences were answered to their end");
    assert!(moved < 0.5 * standing, "squares of errors {moved} for {standing} where the answer stands");
    assert!((widths / count).abs() < 0.15, "uncertainty by a factor of {}", (widths / count).exp());
}

#[test]
fn touches_of_a_pipe_one_by_one_come_to_what_all_at_once_come_to() {
    touches_one_by_one_come_to_the_batch(on_pipe);
}

#[test]
fn touches_of_a_whole_ball_one_by_one_come_to_what_all_at_once_come_to() {
    touches_one_by_one_come_to_the_batch(on_ball);
}

#[test]
fn a_touch_off_the_surface_or_beside_it_moves_nothing() {
    let touches: Vec<Vector> = (0..40).map(|k| on_pipe(3, k)).collect();
    let mut found = recognised(&touches);
    let (mut posterior, before) = (posterior(&found), found.clone());
    assert_eq!(posterior.update(&mut found, [0.0, 0.0, 10.0 + 20.0 * NOISE], None), TouchUpdate::Disagrees);
    assert_eq!(posterior.update(&mut found, [0.0, 30.0, 10.0], None), TouchUpdate::Beside);
    assert_eq!((found.curvedness, found.tried, posterior.touches()), (before.curvedness, before.tried, 0));
}

#[test]
fn a_normal_that_leans_disagrees_where_normals_are_known() {
    let normal = |p: Vector| [p[0] / 10.0, 0.0, (1.0 - p[0] * p[0] / 100.0).sqrt()];
    let draws = EffectDraws::new(4, "leaning");
    let touches: Vec<Vector> = (0..60).map(|k| on_pipe(4, k)).collect();
    let leaning = |(k, p): (usize, &Vector)| {
        let mut error = [0.0; 3];
        draws.gaussians(k as u64, 0, 3, &mut error);
        let n = normal(*p);
        [0, 1, 2].map(|i| n[i] + 0.02 * error[i])
    };
    let normals: Vec<Vector> = touches.iter().enumerate().map(leaning).collect();
    let column = |k: usize| normals.iter().map(|n| n[k]).collect::<Vec<f64>>();
    let contacts = Contacts::from_points(&touches).with_normals(column(0), column(1), column(2));
    let mut found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
    assert!(found.noise.sd_normal_deg.is_some_and(|sd| sd < 3.0), "{:?}", found.noise);
    let mut posterior = posterior(&found);
    let place = [1.0, 1.0, 99.0_f64.sqrt()];
    let along = |angle: f64| Some([0.1, angle.sin() * 0.99_f64.sqrt(), angle.cos() * 0.99_f64.sqrt()]);
    assert_eq!(posterior.update(&mut found, place, along(0.3)), TouchUpdate::Disagrees);
    assert_eq!(posterior.update(&mut found, place, along(0.0)), TouchUpdate::Moved);
}

#[test]
fn more_touches_than_half_of_the_contacts_call_for_a_recognition() {
    let touches: Vec<Vector> = (0..31).map(|k| on_pipe(8, k)).collect();
    let mut found = recognised(&touches[..20]);
    let mut posterior = posterior(&found);
    // all of them where it was touched
    let again = touches.iter().take(12).map(|p| [p[0], p[1], (100.0 - p[0] * p[0]).sqrt()]);
    let outcomes: Vec<TouchUpdate> = again.map(|touch| posterior.update(&mut found, touch, None)).collect();
    assert_eq!(outcomes.iter().take_while(|outcome| **outcome == TouchUpdate::Moved).count(), 10, "{outcomes:?}");
    assert_eq!(outcomes[10], TouchUpdate::Outgrown);
}

#[test]
fn a_kind_that_touches_speak_against_loses_its_probability() {
    // a pipe that bends so little over its touches that it may be a plane
    let share = 0.2;
    let height = |x: f64| (100.0 - x * x).sqrt();
    let on = |k: u64| {
        let [x, y, z] = on_pipe(11, k);
        [share * x, share * y, z - height(x) + height(share * x)]
    };
    let touches: Vec<Vector> = (0..24).map(on).collect();
    let mut found = recognised(&touches);
    let plane =
        |found: &Recognition| found.tried.iter().find(|t| t.hypothesis == Hypothesis::Plane).map_or(0.0, |t| t.weight);
    let before = plane(&found);
    assert!(before > 0.05 && before < 0.95, "{before}");
    let (edge, mut posterior) = (0.9 * share * 6.0, posterior(&found));
    for side in [-edge, edge, 0.0, -edge, edge, 0.0] {
        assert_eq!(posterior.update(&mut found, [side, 0.2, height(side)], None), TouchUpdate::Moved);
    }
    assert!(plane(&found) < 0.8 * before, "{} after {before}", plane(&found));
    let sum: f64 = found.tried.iter().map(|t| t.weight).sum();
    assert!((sum - 1.0).abs() < 1e-9);
}

#[test]
fn where_no_side_is_known_s_stays_a_size() {
    let touches: Vec<Vector> = (0..40).map(|k| on_pipe(5, k)).collect();
    let mut found = Recognition::of(&Contacts::from_points(&touches), &RecognitionOptions::default()).unwrap();
    assert!(!found.side_known);
    let mut posterior = posterior(&found);
    for k in 40..44 {
        assert_eq!(posterior.update(&mut found, on_pipe(5, k), None), TouchUpdate::Moved);
    }
    let s = found.shape_index.unwrap();
    assert!((s.mean - 0.5).abs() < 0.1 && s.interval[0] >= 0.0, "{s:?}");
    let sum: f64 = found.class_probability.iter().map(|(_, p)| p).sum();
    assert!((sum - 1.0).abs() < 1e-12);
}
