//! What it costs not to know: `cargo bench --bench objectives`
//!
//! ```text
//! slopes, weights given      one linear problem
//! slopes, levels found       linear problems, until both noise levels stand
//! normals, levels given      Gauss-Newton steps, until no coefficient moves
//! normals, levels found      both at once: what `palpate fit` does with normals unless it is told more
//! ```
//!
//! The same contacts, heights and directions by `fit_contacts`, at 36 (degree 2, one segment), 2,000 (degree 3, 8 x 8) and
//! 200,000 (degree 3, 64 x 64). The objectives take turns; times are medians, ratios those of one turn's times.

use std::hint::black_box;
use std::time::Instant;

use palpate::fit::{NormalSigma, Note, Objective, SlopeWeights};
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_laboratory::hard_cases::Lcg;

/// Sd of heights and of slopes.
const NOISE: f64 = 0.01;

struct Size {
    contacts: usize,
    degree: usize,
    segments: usize,
    rounds: usize,
}

const SIZES: [Size; 3] = [
    Size { contacts: 36, degree: 2, segments: 1, rounds: 301 },
    Size { contacts: 2_000, degree: 3, segments: 8, rounds: 41 },
    Size { contacts: 200_000, degree: 3, segments: 64, rounds: 5 },
];

/// A wavy dish, felt as slopes and as normals.
fn touched(count: usize) -> [Contacts; 2] {
    let lcg = &mut Lcg::new(count as u64);
    let (x, y): (Vec<f64>, Vec<f64>) =
        (0..count).map(|_| (2.0 * lcg.uniform() - 1.0, 2.0 * lcg.uniform() - 1.0)).unzip();
    let mut noisy = |value: f64| value + NOISE * lcg.normal();
    let at = || x.iter().zip(&y);
    let z = at().map(|(x, y)| noisy(-0.5 * x * x + 0.1 * (3.0 * y).sin())).collect();
    let zx: Vec<f64> = x.iter().map(|x| noisy(-x)).collect();
    let zy: Vec<f64> = y.iter().map(|y| noisy(0.3 * (3.0 * y).cos())).collect();
    let positions = Contacts::from_positions(x.clone(), y.clone(), z);
    let turned = |slopes: &[f64]| slopes.iter().map(|s| -s).collect();
    let normals = positions.clone().with_normals(turned(&zx), turned(&zy), vec![1.0; count]);
    [positions.with_slopes(zx, zy), normals]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let sigma = NormalSigma::Known { z: NOISE, normal_deg: NOISE.to_degrees() };
    let objectives = [
        ("slopes, weights given", Objective::Slopes(SlopeWeights::Tangent)),
        ("slopes, levels found", Objective::Slopes(SlopeWeights::Auto)),
        ("normals, levels given", Objective::Normals(sigma)),
        ("normals, levels found", Objective::Normals(NormalSigma::Auto)),
    ];
    println!("| contacts | objective | fit | times the first | Gauss-Newton steps |\n|---|---|---|---|---|");
    for Size { contacts, degree, segments, rounds } in SIZES {
        let data = touched(contacts);
        let fit = |objective: Objective| {
            let options =
                FitOptions::default().with_degree(degree).with_segments(segments, segments).with_objective(objective);
            let felt = usize::from(matches!(objective, Objective::Normals(_)));
            fit_contacts(black_box(&data[felt]), &options).expect("the contacts cover the patch")
        };
        let timed = |objective: Objective| {
            let start = Instant::now();
            drop(black_box(fit(objective)));
            start.elapsed().as_secs_f64()
        };
        let turns: Vec<[f64; 4]> = (0..rounds).map(|_| objectives.map(|(_, objective)| timed(objective))).collect();
        for (k, (name, objective)) in objectives.into_iter().enumerate() {
            let steps = fit(objective).notes().iter().find_map(|note| match note {
                Note::GaussNewton { steps } => Some(steps.to_string()),
                _ => None,
            });
            println!(
                "| {contacts} | {name} | {:.3} ms | {:.1} | {} |",
                1e3 * median(turns.iter().map(|turn| turn[k]).collect()),
                median(turns.iter().map(|turn| turn[k] / turn[0]).collect()),
                steps.as_deref().unwrap_or("-")
            );
        }
    }
}
