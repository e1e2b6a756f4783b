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
use palpate::scene::{Effect, Sweep, World};
use palpate_world::scene::{ContactBatch, linspace};

const LANES: usize = 64;

fn one_of_each() -> Vec<Effect> {
    vec![
        Effect::tip_radius_error(0.05),
        Effect::indentation(50.0, 0.5, 0.2),
        Effect::friction(0.2, 0.02),
        Effect::force_noise(0.02).with_force_bias([0.01, 0.0, -0.01]).with_force_drift(0.005).with_force_steps(0.01),
        Effect::position_noise([0.02, 0.03, 0.04]),
        Effect::normal_noise(2.0),
        Effect::slope_gain(0.3),
        Effect::encoder(0.01, 0.02),
        Effect::misalignment([1.0, -2.0, 0.5], [0.1, 0.0, -0.1]),
        Effect::latency(0.05, 0.02),
        Effect::finger_noise([0.01; 3], 1.0, 3.0),
        Effect::slip(0.2, 0.5),
        Effect::dropout(0.2),
        Effect::row_noise(0.02, 0.05),
    ]
}

fn each_effect(c: &mut Criterion) {
    let mut group = c.benchmark_group("effect");
    group.throughput(Throughput::Elements((LANES * 36) as u64));
    let patch = |tip_radius: f64| {
        Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 6)).with_tip_radius(tip_radius).with_repeats(2)
    };
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
