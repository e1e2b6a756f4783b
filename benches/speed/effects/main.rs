//! What an effect costs: `cargo bench --bench effects`; what a scene without effects costs: `-- no-effects`.
//!
//! `direct` calls the surface for every site and fills the same columns, contacts and truth; `no_effects` compiles the
//! same patch as a scene that names no effect and takes its contacts. Both do the same work from the same start, so
//! that their times and their instruction counts are to be the same within 2 %. Then each effect alone, a block of
//! 64 replicates on 36 contacts: time / (64 * 36) is its share of one contact.

mod instructions;
mod no_effects;

use criterion::{BatchSize, Criterion, Throughput, criterion_group};
use no_effects::cylinder;
use palpate::internals::scene::{ContactBatch, linspace};
use palpate::scene::effects::*;
use palpate::scene::{Effect, Sweep, World};

const LANES: usize = 64;

fn one_of_each() -> Vec<Effect> {
    vec![
        TipRadiusError { error: 0.05 }.into(),
        Indentation { modulus: 50.0, threshold: 0.5, overshoot: 0.2 }.into(),
        Friction { mu: 0.2, sigma: 0.02 }.into(),
        ForceNoise { sigma: 0.02, bias: [0.01, 0.0, -0.01], drift: 0.005, quantum: 0.01, load: 1.0 }.into(),
        PositionNoise::Sigma([0.02, 0.03, 0.04]).into(),
        NormalNoise { sigma_deg: 2.0 }.into(),
        Encoder { resolution_deg: 0.01, sigma_deg: 0.02, arm: None }.into(),
        Misalignment { rotation_deg: [1.0, -2.0, 0.5], translation: [0.1, 0.0, -0.1] }.into(),
        Latency { distance: 0.05, jitter: 0.02 }.into(),
        FingerNoise { sigma: [0.01; 3], sigma_deg: 1.0, length: 3.0 }.into(),
        Slip { probability: 0.2, size: 0.5 }.into(),
        Dropout { probability: 0.2 }.into(),
        RowNoise { sigma_z: 0.02, sigma_slope: 0.05 }.into(),
    ]
}

fn each_effect(c: &mut Criterion) {
    let mut group = c.benchmark_group("effect");
    group.throughput(Throughput::Elements((LANES * 36) as u64));
    let patch =
        |tip_radius: f64| Sweep { tip_radius, repeats: 2, ..Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 6)) };
    for effect in one_of_each() {
        // point tips where they will do: a latency on rolled tips solves the contact anew
        let tip = if effect.name() == "latency" { 0.0 } else { 0.5 };
        let mut clean = ContactBatch::default();
        World::new(cylinder(), patch(tip)).compile().unwrap().simulate_batch(1, 0, LANES, &mut clean);
        let simulator = World::new(cylinder(), patch(tip)).with(effect.clone()).compile().unwrap();
        group.bench_function(effect.name(), |b| {
            b.iter_batched_ref(|| clean.clone(), |block| simulator.run_stage(0, 1, block), BatchSize::SmallInput);
        });
    }
    group.finish();
}

criterion_group!(benches, no_effects::timed, each_effect);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        // what callgrind runs
        ["--passes", workload, passes] => no_effects::passes(workload, passes.parse().unwrap_or(1)),
        ["no-effects", ..] => no_effects::compare(),
        _ => {
            benches();
            Criterion::default().configure_from_args().final_summary();
        }
    }
}
