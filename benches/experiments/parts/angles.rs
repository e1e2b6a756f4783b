//! How often the intervals of joints' angles hold the truth: two faces at a random angle, a bar with its end, a frustum with its end.
//!
//! Errors are those of `intervals.rs`: each contact's own, or shared by neighbours; every other body has no normals. An angle is inside where
//! |error| <= 1.96 u.

use palpate::parts::{Parts, PartsOptions};
use palpate_numeric::vector::Vector;

use super::bodies::Random;
use super::intervals::{Touched, cell, with_errors};

/// What meets.
const PAIRS: [&str; 3] = ["faces", "bar, end", "frustum, end"];

/// The table of so many bodies of each pair.
pub(crate) fn print(bodies: u64, first: u64) {
    println!(
        "{bodies} bodies a row from seed {first}; angles inside, %, of those with one joint, with the root mean square of error / u"
    );
    println!("{:<13} {:<7} {:>6} {:>14}", "parts", "errors", "joints", "angle");
    for pair in 0..PAIRS.len() {
        for shared in [false, true] {
            let errors: Vec<f64> = (first..first + bodies).filter_map(|seed| error(pair, shared, seed)).collect();
            let words = if shared { "shared" } else { "own" };
            println!("{:<13} {words:<7} {:>6}{}", PAIRS[pair], errors.len(), cell(&errors, 1.96));
        }
    }
}

/// Error over u of the angle of a body's one joint; `None` where other parts are found.
fn error(pair: usize, shared: bool, seed: u64) -> Option<f64> {
    let mut random = Random(seed.wrapping_mul(211).wrapping_add(pair as u64));
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let (body, truth) = touched(pair, &mut r);
    let (contacts, _) = with_errors(&body, shared, seed.is_multiple_of(2), seed, &mut r);
    let found = Parts::of(&contacts, &PartsOptions::default()).ok()?;
    let [joint] = &found.joints[..] else { return None };
    let u = joint.u_angle_deg.filter(|_| found.parts.len() == 2)?;
    Some((joint.angle_deg - truth) / u)
}

/// Two faces with contacts as dense, and the angle at which they meet, degrees.
fn touched(pair: usize, r: &mut impl FnMut(f64, f64) -> f64) -> (Touched, f64) {
    let count = r(600_f64.ln(), 6000_f64.ln()).exp() as usize;
    let (angle, size, length) = (r(30.0, 120.0_f64), r(0.6, 1.6), r(0.8, 2.0));
    let half = if pair == 2 { r(8.0, 25.0_f64).to_radians() } else { 0.0 };
    let bar = std::f64::consts::TAU * length / half.cos() * (1.0 - 0.5 * length * half.tan());
    let areas = if pair == 0 { [1.0, size] } else { [bar, std::f64::consts::PI] };
    let share = areas[0] / (areas[0] + areas[1]);
    let spread = |k: usize| {
        [0.754_877_666, 0.569_840_290_998, 0.618_033_988_75].map(|step: f64| (0.5 + step * (k + 1) as f64).fract())
    };
    let (sin, cos) = angle.to_radians().sin_cos();
    let place = |k: usize| -> (Vector, Vector) {
        let [u, v, which] = spread(k);
        let first = which < share;
        let (s, c) = (std::f64::consts::TAU * u).sin_cos();
        match (pair, first) {
            (0, true) => ([-u, v, 0.0], [0.0, 0.0, 1.0]),
            (0, false) => ([size * u * cos, v, -size * u * sin], [sin, 0.0, cos]),
            (_, true) => {
                let rho = 1.0 - v * length * half.tan();
                ([rho * c, rho * s, v * length], [half.cos() * c, half.cos() * s, half.sin()])
            }
            (_, false) => ([v.sqrt() * c, v.sqrt() * s, 0.0], [0.0, 0.0, -1.0]),
        }
    };
    let (points, normals) = (0..count).map(place).unzip();
    let spacing = ((areas[0] + areas[1]) / count as f64).sqrt();
    let truth = if pair == 0 { angle } else { 90.0 + half.to_degrees() };
    (Touched { points, normals, spacing, sizes: [None; 3] }, truth)
}
