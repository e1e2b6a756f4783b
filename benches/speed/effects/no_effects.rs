//! A scene without effects against calling its surface directly: time in alternation, and instructions.

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput};
use palpate::Contacts;
use palpate::scene::{Surface, Sweep, Truth, World};
use palpate_world::scene::{SurfacePoint, linspace};

use crate::instructions;

/// Pairs of runs that the ratio is the median of.
const ROUNDS: usize = 401;

pub(crate) fn cylinder() -> Surface {
    Surface::cylinder(6.6).turned(90.0)
}

/// 20 fingers, 1000 stations: large enough that a scene's fixed cost is not what is measured.
struct Patch {
    surface: Surface,
    fingers: Vec<f64>,
    stations: Vec<f64>,
    world: World,
}

impl Patch {
    fn new() -> Patch {
        let (fingers, stations) = (linspace(-4.0, 4.0, 20), linspace(-4.0, 4.0, 1000));
        let world = World::new(cylinder(), Sweep::new(fingers.clone(), stations.clone()));
        Patch { surface: cylinder(), fingers, stations, world }
    }

    /// What a user without scenes would write: the surface at every site, contacts and truth.
    fn direct(&self) -> (Contacts, Vec<SurfacePoint>) {
        let count = self.fingers.len() * self.stations.len();
        let mut columns: [Vec<f64>; 6] = std::array::from_fn(|_| Vec::with_capacity(count));
        let mut truth = Vec::with_capacity(count);
        let (mut finger, mut station) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (f, x) in self.fingers.iter().enumerate() {
            for (s, y) in self.stations.iter().enumerate() {
                if let Some(point) = self.surface.at(*x, *y) {
                    for k in 0..3 {
                        columns[k].push(point.point[k]);
                        columns[3 + k].push(point.local.normal[k]);
                    }
                    truth.push(point);
                    finger.push(f as u32);
                    station.push(s as u32);
                }
            }
        }
        let [x, y, z, nx, ny, nz] = columns;
        let mut contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, nz);
        contacts.finger = Some(finger);
        contacts.station = Some(station);
        (contacts, truth)
    }

    fn scene(&self) -> (Contacts, Truth) {
        self.world.compile().expect("the cylinder reaches the patch").into_contacts(1997, 0)
    }
}

pub(crate) fn timed(c: &mut Criterion) {
    let mut group = c.benchmark_group("scene");
    let patch = Patch::new();
    group.throughput(Throughput::Elements((patch.fingers.len() * patch.stations.len()) as u64));
    group.bench_function("direct", |b| b.iter(|| black_box(&patch).direct()));
    group.bench_function("no_effects", |b| b.iter(|| black_box(&patch).scene()));
    group.finish();
}

/// Runs one workload so often: what the instruction counter looks at.
pub(crate) fn passes(workload: &str, passes: u64) {
    let patch = Patch::new();
    for _ in 0..passes {
        match workload {
            "direct" => drop(black_box(black_box(&patch).direct())),
            _ => drop(black_box(black_box(&patch).scene())),
        }
    }
}

/// Prints both ratios.
pub(crate) fn compare() {
    let patch = Patch::new();
    let seconds = |run: &dyn Fn()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    let mut pairs: Vec<[f64; 2]> = (0..ROUNDS)
        .map(|round| {
            let direct = || seconds(&|| drop(black_box(black_box(&patch).direct())));
            let scene = || seconds(&|| drop(black_box(black_box(&patch).scene())));
            // who goes first takes turns
            if round % 2 == 0 {
                [direct(), scene()]
            } else {
                let s = scene();
                [direct(), s]
            }
        })
        .collect();
    let contacts = (patch.fingers.len() * patch.stations.len()) as f64;
    let median = |of: &dyn Fn(&[f64; 2]) -> f64, pairs: &mut Vec<[f64; 2]>| {
        pairs.sort_by(|a, b| of(a).total_cmp(&of(b)));
        of(&pairs[pairs.len() / 2])
    };
    let direct = median(&|p| p[0], &mut pairs) * 1e9 / contacts;
    let scene = median(&|p| p[1], &mut pairs) * 1e9 / contacts;
    let ratio = median(&|p| p[1] / p[0], &mut pairs);
    println!(
        "time          direct {direct:.2} ns/contact, scene without effects {scene:.2}, median ratio {ratio:.4} of {ROUNDS} pairs"
    );
    match (instructions::per_pass("direct"), instructions::per_pass("scene")) {
        (Some(direct), Some(scene)) => println!(
            "instructions  direct {:.2} per contact, scene without effects {:.2}, ratio {:.4}",
            direct / contacts,
            scene / contacts,
            scene / direct
        ),
        _ => println!("instructions  not counted: valgrind is not installed"),
    }
}
