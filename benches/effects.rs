//! What an effect costs: `cargo bench --bench effects`
//!
//! `direct` calls the surface for every site and fills the same columns; `no_effects` is the same patch through a
//! compiled world (its points were found when it was compiled), `compile_and_no_effects` with the compiling. Then each effect alone, a block of 64 replicates on 36 contacts: time / (64 * 36) is its share of
//! one contact. A scene without effects is meant to cost what its surface costs.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use palpate::Contacts;
use palpate::scene::effects::*;
use palpate::scene::surface::{Body, Cylinder};
use palpate::scene::{Block, Effect, Surface, Sweep, Truth, World, linspace};
use std::hint::black_box;

const LANES: usize = 64;

fn cylinder() -> Surface {
    Surface::new(Body::Cylinder(Cylinder { radius: 6.6 }), 90.0)
}

/// What a user without scenes would write: the surface at every site, contacts and truth.
fn direct(surface: &Surface, fingers: &[f64], stations: &[f64]) -> (Contacts, Vec<palpate::scene::SurfacePoint>) {
    let count = fingers.len() * stations.len();
    let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| Vec::with_capacity(count));
    let (mut truth, mut lane, mut stop) =
        (Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count));
    for (f, x) in fingers.iter().enumerate() {
        for (s, y) in stations.iter().enumerate() {
            if let Some(point) = surface.at(*x, *y) {
                for k in 0..3 {
                    columns[k].push(point.point[k]);
                    columns[3 + k].push(point.local.normal[k]);
                }
                truth.push(point);
                lane.push(f as u32);
                stop.push(s as u32);
            }
        }
    }
    let [x, y, z, nx, ny, nz] = columns;
    let mut contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, nz);
    contacts.finger = Some(lane);
    contacts.station = Some(stop);
    (contacts, truth)
}

fn no_effects(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene");
    let surface = cylinder();
    let (fingers, stations) = (linspace(-4.0, 4.0, 20), linspace(-4.0, 4.0, 1000));
    group.throughput(Throughput::Elements((fingers.len() * stations.len()) as u64));
    group.bench_function("direct", |b| b.iter(|| direct(black_box(&surface), &fingers, &stations)));
    let simulator = World::new(surface.clone(), Sweep::new(fingers.clone(), stations.clone())).compile().unwrap();
    group.bench_function("no_effects", |b| b.iter(|| -> (Contacts, Truth) { black_box(&simulator).simulate(1, 0) }));
    let world = World::new(surface, Sweep::new(fingers, stations));
    group.bench_function("compile_and_no_effects", |b| {
        b.iter(|| -> (Contacts, Truth) { black_box(&world).compile().unwrap().simulate(1, 0) });
    });
    group.finish();
}

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
        LaneNoise { sigma: [0.01; 3], sigma_deg: 1.0, length: 3.0 }.into(),
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
        let mut clean = Block::default();
        World::new(cylinder(), patch(tip)).compile().unwrap().simulate_block(1, 0, LANES, &mut clean);
        let simulator = World::new(cylinder(), patch(tip)).with(effect.clone()).compile().unwrap();
        group.bench_function(effect.name(), |b| {
            b.iter_batched_ref(|| clean.clone(), |block| simulator.run_stage(0, 1, block), BatchSize::SmallInput);
        });
    }
    group.finish();
}

criterion_group!(benches, no_effects, each_effect);
criterion_main!(benches);
