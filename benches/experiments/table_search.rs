//! Which effects explain the paper's Tables 1 and 2? `cargo bench --bench table_search`
//!
//! ```text
//! minimise  -2 log L = sum over 16 numbers ((paper - mean)^2 / v + ln v),   v = sd^2 + floor^2
//! ```
//!
//! The 16 numbers are the means and sds of S and R for plane and cylinder, tangent and position weights; mean and sd are
//! over replicates of the scene (common random numbers for every candidate, so that L is a function). The floor is 2 %
//! of each number: the digits that an unknown implementation of 1997 can be trusted with. Three stages, all from one
//! seed: uniform draws over the RANGES; Gaussian steps from the ten best, shrinking; Metropolis chains from the
//! best, whose spread relative to the prior tells the directions that the data cannot tell.
//!
//! A likelihood of means and variances alone, with the numbers taken as independent: a synthetic likelihood (S. N. Wood,
//! *Nature* 466 (2010) 1102) without its covariance.

use palpate::fit::{FitOptions, Objective, SlopeWeights, fit_contacts};
use palpate::scene::{Effect, Surface, Sweep, World};
use palpate_numeric::draws::EffectDraws;
use palpate_world::scene::linspace;
use rayon::prelude::*;

const SEED: u64 = 1997;
/// Radius of the cylinder.
const RADIUS: f64 = 6.6;
/// Relative trust in a printed number.
const FLOOR: f64 = 0.02;

/// What is searched, with its range: uniform prior.
const RANGES: [(&str, f64, f64); 10] = [
    ("half width of the patch across the fingers", 3.0, 7.0),
    ("sweep.tip_radius", 0.2, 3.0),
    ("effects.tip_radius_error.error", -3.0, 0.5),
    ("effects.friction.mu", 0.0, 0.3),
    ("effects.force_noise.sigma", 0.0, 0.1),
    ("effects.force_noise.bias x", -0.1, 0.1),
    ("effects.force_noise.bias y", -0.1, 0.1),
    ("effects.force_noise.quantum", 0.0, 0.2),
    ("effects.encoder.sigma_deg", 0.0, 0.2),
    ("effects.encoder.resolution_deg", 0.0, 0.5),
];
const N: usize = RANGES.len();

/// S mean, S sd, R mean, R sd: Table 1 tangent, position; Table 2 tangent, position.
const PAPER: [[f64; 4]; 4] = [
    [0.4703, 0.21204, 0.004114, 0.0006562],
    [0.3643, 0.24721, 0.003026, 0.0009828],
    [0.4980, 0.009639, 0.080290, 0.024210],
    [0.5014, 0.015773, 0.073446, 0.016892],
];
const ROWS: [&str; 4] = ["plane, tangent", "plane, position", "cylinder, tangent", "cylinder, position"];

type Parameters = [f64; N];

struct Effort {
    draws: usize,
    steps: usize,
    chain: usize,
    replicates: u64,
}

fn world(p: &Parameters, surface: Surface) -> World {
    let [width, tip_radius, error, mu, sigma, bias_x, bias_y, quantum, sigma_deg, resolution_deg] = *p;
    let sweep =
        Sweep::new(vec![-width, 0.0, width], linspace(-4.0, 4.0, 6)).with_repeats(2).with_tip_radius(tip_radius);
    World::new(surface, sweep)
        .with(Effect::tip_radius_error(error))
        .with(Effect::friction(mu, 0.0))
        .with(Effect::force_noise(sigma).with_force_bias([bias_x, bias_y, 0.0]).with_force_steps(quantum))
        .with(Effect::encoder(resolution_deg, sigma_deg))
}

fn mean_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt())
}

/// The four rows of one replicate; `None` where a fit is refused.
fn rows(worlds: &[palpate::scene::Simulator; 2], replicate: u64) -> Option<[[f64; 4]; 4]> {
    let mut found = [[0.0; 4]; 4];
    for (surface, simulator) in worlds.iter().enumerate() {
        let (contacts, _) = simulator.simulate(SEED, replicate);
        for (k, weights) in [SlopeWeights::Tangent, SlopeWeights::Position].into_iter().enumerate() {
            let options = FitOptions::default().with_objective(Objective::Slopes(weights));
            let fit = fit_contacts(&contacts, &options).ok()?;
            let maps = &fit.shape().maps;
            let every = || (0..8).flat_map(|i| (0..8).map(move |j| (i, j)));
            // S over the grid even where a plane is recognised: the paper printed it
            let s: Vec<f64> = every().filter_map(|(i, j)| maps.shape_index_at(i, j)).collect();
            let r: Vec<f64> = every().filter_map(|(i, j)| maps.curvedness_at(i, j)).collect();
            let ((s, s_sd), (r, r_sd)) = (mean_sd(&s), mean_sd(&r));
            found[2 * surface + k] = [s, s_sd, r, r_sd];
        }
    }
    Some(found)
}

fn replicates(p: &Parameters, count: u64) -> Option<Vec<[[f64; 4]; 4]>> {
    let cylinder = Surface::cylinder(RADIUS).turned(90.0);
    let plane = world(p, Surface::plane()).compile().ok()?;
    let worlds = [plane, world(p, cylinder).compile().ok()?];
    (0..count).map(|replicate| rows(&worlds, replicate)).collect()
}

/// -2 log L; infinite where the scene cannot be.
fn misfit(p: &Parameters, count: u64) -> f64 {
    let Some(all) = replicates(p, count) else { return f64::INFINITY };
    let mut total = 0.0;
    for (row, paper) in PAPER.iter().enumerate() {
        for (k, paper) in paper.iter().enumerate() {
            let values: Vec<f64> = all.iter().map(|found| found[row][k]).collect();
            let (mean, sd) = mean_sd(&values);
            let v = sd * sd + (FLOOR * paper).powi(2);
            total += (paper - mean).powi(2) / v + v.ln();
        }
    }
    if total.is_finite() { total } else { f64::INFINITY }
}

fn inside(p: &Parameters) -> bool {
    p.iter().zip(RANGES).all(|(value, (_, low, high))| (low..=high).contains(value))
}

/// A Gaussian step of `scale` times each range, from the draws at this address.
fn step(from: &Parameters, scale: f64, draws: &EffectDraws, chain: u64, number: u64) -> Parameters {
    let mut normals = [0.0; N];
    draws.gaussians(chain, number, N, &mut normals);
    std::array::from_fn(|i| from[i] + scale * (RANGES[i].2 - RANGES[i].1) * normals[i])
}

fn draw_everywhere(effort: &Effort) -> Vec<(f64, Parameters)> {
    let draws = EffectDraws::new(SEED, "search");
    let mut found: Vec<(f64, Parameters)> = (0..effort.draws)
        .into_par_iter()
        .map(|number| {
            let mut u = [0.0; N];
            draws.uniforms(0, number as u64, N, &mut u);
            let p = std::array::from_fn(|i| RANGES[i].1 + (RANGES[i].2 - RANGES[i].1) * u[i]);
            (misfit(&p, effort.replicates), p)
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

fn refine(start: (f64, Parameters), chain: u64, effort: &Effort) -> (f64, Parameters) {
    let draws = EffectDraws::new(SEED, "refine");
    let mut best = start;
    for number in 0..effort.steps {
        // from a tenth of the range down to a thousandth
        let scale = 0.1 * 0.01_f64.powf(number as f64 / effort.steps as f64);
        let trial = step(&best.1, scale, &draws, chain, number as u64);
        if inside(&trial) {
            let value = misfit(&trial, effort.replicates);
            if value < best.0 {
                best = (value, trial);
            }
        }
    }
    best
}

/// Metropolis from the best; the states visited.
fn wander(start: (f64, Parameters), chain: u64, effort: &Effort) -> Vec<Parameters> {
    let (steps, coins) = (EffectDraws::new(SEED, "chain"), EffectDraws::new(SEED, "coin"));
    let mut at = start;
    let mut visited = Vec::with_capacity(effort.chain);
    for number in 0..effort.chain {
        let trial = step(&at.1, 0.03, &steps, chain, number as u64);
        if inside(&trial) {
            let value = misfit(&trial, effort.replicates);
            let mut u = [0.0];
            coins.uniforms(chain, number as u64, 1, &mut u);
            if -2.0 * u[0].ln() > value - at.0 {
                at = (value, trial);
            }
        }
        visited.push(at.1);
    }
    visited
}

/// Spread of the chains along each direction, in units of the prior's own spread (1: the data say nothing).
fn report_directions(visited: &[Parameters]) {
    // a uniform law over a range of 1 has sd 1/sqrt 12
    let unit = |p: &Parameters, i: usize| (p[i] - RANGES[i].1) / (RANGES[i].2 - RANGES[i].1) * 12.0_f64.sqrt();
    let means: [f64; N] =
        std::array::from_fn(|i| visited.iter().map(|p| unit(p, i)).sum::<f64>() / visited.len() as f64);
    let covariance = faer::Mat::from_fn(N, N, |i, j| {
        visited.iter().map(|p| (unit(p, i) - means[i]) * (unit(p, j) - means[j])).sum::<f64>() / visited.len() as f64
    });
    println!("\nWhat the data tell (sd over the chains as a share of the prior's; 1: nothing):");
    for (i, (name, low, high)) in RANGES.iter().enumerate() {
        println!("  {:>5.2}  {name} in [{low}, {high}]", covariance[(i, i)].sqrt());
    }
    let Ok(eigen) = covariance.self_adjoint_eigen(faer::Side::Lower) else { return };
    println!("Directions, worst determined first (share of the prior's sd; components above 0.3):");
    for k in (0..N).rev().take(5) {
        let spread = eigen.S()[k].max(0.0).sqrt();
        let parts: Vec<String> = (0..N)
            .filter(|i| eigen.U()[(*i, k)].abs() > 0.3)
            .map(|i| format!("{:+.2} {}", eigen.U()[(i, k)], RANGES[i].0))
            .collect();
        println!("  {spread:>5.2}  {}", parts.join(", "));
    }
}

fn report_best(best: &[(f64, Parameters)], effort: &Effort) {
    println!("The ten best (-2 log L; parameters in the order of the ranges):");
    for (value, p) in best {
        let numbers: Vec<String> = p.iter().map(|v| format!("{v:.4}")).collect();
        println!("  {value:>9.2}  {}", numbers.join("  "));
    }
    let p = &best[0].1;
    let Some(all) = replicates(p, 50 * effort.replicates) else { return };
    println!("\nThe best beside the paper: mean over replicates (sd over replicates), paper");
    for (row, name) in ROWS.iter().enumerate() {
        let parts: Vec<String> = ["S", "S sd", "R", "R sd"]
            .iter()
            .enumerate()
            .map(|(k, what)| {
                let values: Vec<f64> = all.iter().map(|found| found[row][k]).collect();
                let (mean, sd) = mean_sd(&values);
                format!("{what} {mean:.5} ({sd:.5}) {}", PAPER[row][k])
            })
            .collect();
        println!("  {name:<18}  {}", parts.join("   "));
    }
    for (surface, table) in [(0, 1), (1, 2)] {
        let nearest = all.iter().enumerate().map(|(replicate, found)| {
            let miss = |row: usize, k: usize| ((found[row][k] - PAPER[row][k]) / PAPER[row][k]).powi(2);
            let total: f64 =
                (0..2).flat_map(|w| (0..4).map(move |k| (w, k))).map(|(w, k)| miss(2 * surface + w, k)).sum();
            ((total / 8.0).sqrt(), replicate)
        });
        if let Some((miss, replicate)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
            println!("  Table {table}: replicate {replicate} comes nearest, rms relative difference {miss:.3}");
            println!("    {:?}", &all[replicate][2 * surface..2 * surface + 2]);
        }
    }
}

fn main() {
    // without --bench (as in `cargo test --benches`) only a taste of it
    let full = std::env::args().any(|argument| argument == "--bench");
    let effort = if full {
        Effort { draws: 3000, steps: 150, chain: 400, replicates: 12 }
    } else {
        Effort { draws: 12, steps: 2, chain: 2, replicates: 2 }
    };
    println!(
        "seed {SEED}; {} draws, {} steps from each of the ten best, 8 chains of {}; {} replicates each",
        effort.draws, effort.steps, effort.chain, effort.replicates
    );
    let everywhere = draw_everywhere(&effort);
    let refused = everywhere.iter().filter(|(value, _)| value.is_infinite()).count();
    println!("{refused} of the draws cannot be (stations out of reach, or a fit refused)\n");
    let mut best: Vec<_> =
        everywhere[..10].par_iter().enumerate().map(|(chain, start)| refine(*start, chain as u64, &effort)).collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    report_best(&best, &effort);
    let visited: Vec<Parameters> =
        (0..8_u64).into_par_iter().flat_map_iter(|chain| wander(best[chain as usize % 2], chain, &effort)).collect();
    report_directions(&visited);
}
