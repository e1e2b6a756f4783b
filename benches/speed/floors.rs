//! How far the workloads are from the machine: `cargo bench --bench floors`
//!
//! ```text
//! floor = multiply-adds / their peak + bytes read / rate of reading + bytes written / rate of zeroing
//! ```
//!
//! Peaks come from loops that do nothing else, on one thread, in the same run. Counted are only the operations that any
//! way of doing it needs: sorting, moments and latencies are not, so a floor is never reached.

#[path = "../workloads/mod.rs"]
#[allow(dead_code, reason = "other benches use the rest")]
mod workloads;

use std::hint::black_box;
use std::time::Instant;

use palpate::montecarlo::FixedSites;
use palpate::plans::{ImagePlan, SlopePlan};
use palpate::spline::CurvatureGrid;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::simd::{
    CHACHA_BLOCKS, CHACHA_WORDS, Isa, REPLICATES, chacha8, gaussian_triples, multiply_add_peak,
};
use palpate_studies::montecarlo::ROW_NOISE;
use workloads::{Fault, bicubic, image, image_knots, paper, paper_knots, paper_points, scattered, square_knots};

/// Bytes of the arrays that rates are measured on: beyond every cache.
const ARRAY: usize = 1 << 28;

/// Best of some runs, seconds.
fn best(runs: usize, mut work: impl FnMut()) -> f64 {
    let time = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..=runs).map(|_| time(&mut work)).fold(f64::INFINITY, f64::min)
}

struct Machine {
    multiply_adds: f64,
    read: f64,
    zero: f64,
}

impl Machine {
    fn measured() -> Machine {
        let isa = Isa::active();
        let [_, count] = multiply_add_peak(isa, 1 << 20, 0.5, 1.0);
        let multiply_adds = count / best(5, || _ = black_box(multiply_add_peak(isa, 1 << 20, black_box(0.5), 1.0)));
        let mut array = vec![1.0_f64; ARRAY / 8];
        let sum = |array: &[f64]| {
            let mut sums = [0.0; 16];
            array.chunks_exact(16).for_each(|chunk| (0..16).for_each(|k| sums[k] += chunk[k]));
            sums
        };
        let read = ARRAY as f64 / best(5, || _ = black_box(sum(black_box(&array))));
        let zero = ARRAY as f64 / best(5, || black_box(&mut array).fill(0.0));
        let touch = best(3, || _ = black_box(vec![1_u8; ARRAY])) - ARRAY as f64 / zero;
        println!("one thread, {}: {:.1} G multiply-adds/s", isa.name(), multiply_adds * 1e-9);
        println!("memory: read {:.1} GB/s, zeroed {:.1} GB/s", read * 1e-9, zero * 1e-9);
        println!("a page touched first: {:.2} us more", touch / (ARRAY as f64 / 4096.0) * 1e6);
        Machine { multiply_adds, read, zero }
    }

    fn floor(&self, multiply_adds: f64, read: f64, written: f64) -> f64 {
        multiply_adds / self.multiply_adds + read / self.read + written / self.zero
    }
}

fn line(name: &str, floor: f64, takes: f64) {
    println!("{name:<44} floor {:>9.3} ms, takes {:>9.3} ms, ratio {:>5.2}", floor * 1e3, takes * 1e3, takes / floor);
}

/// Contacts read, written once as records and read again; the band zeroed, factored and read twice.
fn scattered_fits(machine: &Machine) -> Result<(), Fault> {
    for (name, contacts, segments) in [("W2", 200_000, 64), ("W2L", 1_000_000, 128)] {
        let columns = scattered(contacts);
        let knots = square_knots(3, segments, 0.0, 1.0)?;
        let mut plan = SlopePlan::new(knots.clone(), [1.0; 3])?;
        plan.fit(&columns.view())?;
        let (records, band) = (40.0 * contacts as f64, 8.0 * plan.factor().factor_entries() as f64);
        let products = plan.factor().multiply_adds();
        drop(plan);
        let fit = || SlopePlan::new(knots.clone(), [1.0; 3]).and_then(|mut plan| Ok(plan.fit(&columns.view())?[0]));
        let takes = best(5, || _ = black_box(fit()));
        let floor = machine.floor(products, 2.0 * records + 2.0 * band, records + band);
        line(&format!("{name} (factor {:.0} M multiply-adds)", products * 1e-6), floor, takes);
        line("   its factor alone", machine.floor(products, 0.0, 0.0), takes);
    }
    Ok(())
}

/// Three images read once; `p + 1` multiply-adds a pixel along y, for heights and for each slope.
fn image_fit(machine: &Machine) -> Result<(), Fault> {
    let ([x, y], [z, zx, zy]) = image();
    let mut plan = ImagePlan::new(image_knots()?, &x, &y, [1.0; 3])?;
    let takes = best(20, || _ = black_box(plan.fit_frame(black_box(&z), &zx, &zy).map(|c| c[0])));
    let pixels = z.len() as f64;
    line("W3 reused, images from memory", machine.floor(12.0 * pixels, 24.0 * pixels, 0.0), takes);
    Ok(())
}

/// Words and normals of every contact, `p = P n`, and the maps' products; roots, logarithms and angles are not counted.
fn noise_study(machine: &Machine) -> Result<(), Fault> {
    let (columns, points) = (paper(true), paper_points());
    let sites = FixedSites::new(&paper_knots()?, &columns.view(), [1.0, 2.0, 2.0], [0.02; 3], [&points, &points])?;
    let count = 20_000;
    let (mut s, mut r) = (vec![0.0; count], vec![0.0; count]);
    let takes = best(5, || sites.replicates(2026, 0, &mut s, &mut r));
    let (isa, key) = (Isa::active(), EffectDraws::new(2026, ROW_NOISE).key());
    let (mut words, mut drawn) = ([[0; CHACHA_BLOCKS]; CHACHA_WORDS], [[0.0; 2 * CHACHA_BLOCKS]; 3]);
    const CALLS: usize = 1 << 14;
    let chacha = best(5, || (0..CALLS).for_each(|k| chacha8(isa, &key, k as u64, 0, black_box(&mut words))));
    let normals = best(5, || (0..CALLS).for_each(|_| gaussian_triples(isa, black_box(&words), black_box(&mut drawn))));
    // 4 double rounds of 8 quarter rounds of 12 operations, and 16 sums, on 16 words of 32 bits: half a register of 8 each
    let operations = (4 * 8 * 12 + 16) as f64 * CHACHA_BLOCKS as f64 / 2.0;
    line("W4, a thousand calls of chacha8", machine.floor(1e3 * operations, 0.0, 0.0), 1e3 * chacha / CALLS as f64);
    let calls = (columns.view().x.len() * count / REPLICATES) as f64;
    line("W4 (20,000), its words and normals alone", calls * (chacha + normals) / CALLS as f64, takes);
    Ok(())
}

/// 16 MB of maps written; five derivatives of `q + 1` products a point.
fn curvature_map(machine: &Machine) -> Result<(), Fault> {
    let knots = square_knots(3, 64, 0.0, 1.0)?;
    let at: Vec<f64> = (0..1000).map(|k| k as f64 / 999.0).collect();
    let c = bicubic(&knots);
    let (mut s, mut r) = (vec![0.0; 1_000_000], vec![0.0; 1_000_000]);
    let takes = best(5, || CurvatureGrid::new(&knots, &at, &at).maps(&c, &mut s, &mut r));
    line("W5, products and stores", machine.floor(20e6, 0.0, 16e6), takes);
    Ok(())
}

fn paper_fit(machine: &Machine) -> Result<(), Fault> {
    let (columns, points) = (paper(false), paper_points());
    let mut plan = SlopePlan::new(paper_knots()?, [1.0, 2.0, 2.0])?;
    let mut grid = CurvatureGrid::new(&paper_knots()?, &points, &points);
    let (mut s, mut r) = ([0.0; 64], [0.0; 64]);
    let runs = 2000;
    let fit = best(9, || (0..runs).for_each(|_| _ = black_box(plan.fit(black_box(&columns.view())).map(|c| c[0]))));
    let c = plan.fit(&columns.view())?.to_vec();
    let maps = best(9, || (0..runs).for_each(|_| grid.maps(black_box(&c), &mut s, &mut r)));
    // 36 contacts of 3 rows of 9 entries: 45 products each; 64 points of 5 derivatives of 9
    line("W1, two thousand: rows' products", machine.floor(runs as f64 * 36.0 * 3.0 * 45.0, 0.0, 0.0), fit);
    line("W1, two thousand: products of the maps", machine.floor(runs as f64 * 64.0 * 45.0, 0.0, 0.0), maps);
    Ok(())
}

fn main() -> Result<(), Fault> {
    let one = workloads::pool(1)?;
    one.install(|| {
        let machine = Machine::measured();
        paper_fit(&machine)?;
        scattered_fits(&machine)?;
        image_fit(&machine)?;
        noise_study(&machine)?;
        curvature_map(&machine)
    })
}
