//! What trust costs: `cargo bench --bench certificate`
//!
//! ```text
//! asked for       (fit + shape + certificate  -  (fit + shape)) / fit      and the same over fit + shape, which is what
//!                                                                          answers the question for S and R
//! not asked for   (fit, then its rank, method and reasons  -  fit) / fit
//! ```
//!
//! By `fit_contacts`, the call that a user makes: slope rows with given weights at 36 contacts (degree 2, one segment) and
//! at 200,000 (degree 3, 64 x 64 segments), and the same 36 with normals and no word about their noise, which is what
//! `palpate fit` does by default. The ways take turns in one process, each after an untimed fit with its shape, so that none
//! finds caches, memory or the clock as another has left them; the ratios are medians over the rounds.

use std::hint::black_box;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion, criterion_group};
use palpate::Contacts;
use palpate::cases::Lcg;
use palpate::contact::Orientation;
use palpate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};
use palpate::scene::linspace;

struct Problem {
    rows: &'static str,
    contacts: Contacts,
    options: FitOptions,
    rounds: usize,
}

/// Heights and slopes of a wavy dish with a little noise.
fn touched(x: Vec<f64>, y: Vec<f64>) -> Contacts {
    let lcg = &mut Lcg::new(36);
    let at = |k: usize| (x[k], y[k]);
    let mut noisy = |value: f64| value + 0.01 * lcg.normal();
    let z = (0..x.len()).map(|k| noisy(-0.5 * at(k).0 * at(k).0 + 0.1 * (3.0 * at(k).1).sin())).collect();
    let zx = (0..x.len()).map(|k| noisy(-at(k).0)).collect();
    let zy = (0..x.len()).map(|k| noisy(0.3 * (3.0 * at(k).1).cos())).collect();
    Contacts::from_positions(x.clone(), y.clone(), z).with_slopes(zx, zy)
}

fn problems() -> [Problem; 3] {
    let objective = Objective::Slopes(SlopeWeights::Tangent);
    let (lanes, stations) = (linspace(-1.0, 1.0, 4), linspace(-1.0, 1.0, 9));
    let sites: Vec<(f64, f64)> = lanes.iter().flat_map(|x| stations.iter().map(move |y| (*x, *y))).collect();
    let (x, y) = sites.into_iter().unzip();
    let contacts = touched(x, y);
    let mut felt = contacts.clone();
    if let Orientation::Slopes { zx, zy } = &contacts.orientation {
        let turned = |slopes: &[f64]| slopes.iter().map(|s| -s).collect();
        felt = felt.with_normals(turned(zx), turned(zy), vec![1.0; zx.len()]);
    }
    let small =
        Problem { rows: "slopes", contacts, options: FitOptions { objective, ..FitOptions::default() }, rounds: 2001 };
    let by_default = Problem { rows: "normals", contacts: felt, options: FitOptions::default(), rounds: 401 };
    let lcg = &mut Lcg::new(200_000);
    let (x, y) = (0..200_000).map(|_| (2.0 * lcg.uniform() - 1.0, 2.0 * lcg.uniform() - 1.0)).unzip();
    let options = FitOptions { degree: [3, 3], segments: [64, 64], objective, ..FitOptions::default() };
    [small, by_default, Problem { rows: "slopes", contacts: touched(x, y), options, rounds: 21 }]
}

impl Problem {
    fn fit(&self) -> Fit {
        fit_contacts(black_box(&self.contacts), &self.options).expect("the sites cover the patch")
    }

    fn described(&self) -> Fit {
        let fit = self.fit();
        black_box(fit.shape());
        fit
    }

    fn certified(&self) -> Fit {
        let fit = self.described();
        black_box(fit.certificate());
        fit
    }

    fn not_asked(&self) -> Fit {
        let fit = self.fit();
        let solution = fit.solution();
        black_box((solution.rank, solution.method, &solution.reasons));
        fit
    }
}

fn timed(c: &mut Criterion) {
    for problem in problems() {
        let mut group = c.benchmark_group("certificate");
        let size = format!("{}_{}", problem.contacts.len(), problem.rows);
        group.sample_size(10.max(problem.rounds / 100));
        group.bench_function(BenchmarkId::new("fit", &size), |b| b.iter(|| problem.fit()));
        group.bench_function(BenchmarkId::new("fit_shape", &size), |b| b.iter(|| problem.described()));
        group.bench_function(BenchmarkId::new("fit_shape_certificate", &size), |b| b.iter(|| problem.certified()));
        group.finish();
    }
}

fn seconds(work: impl Fn() -> Fit) -> f64 {
    let start = Instant::now();
    let fit = work();
    let elapsed = start.elapsed().as_secs_f64();
    drop(fit);
    elapsed
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn compare() {
    println!("contacts    rows       fit      shape  certificate   of the fit   of fit and shape   not asked for");
    for problem in problems() {
        let ways: [fn(&Problem) -> Fit; 4] = [Problem::fit, Problem::not_asked, Problem::described, Problem::certified];
        let rounds: Vec<[f64; 4]> = (0..problem.rounds)
            .map(|_| {
                let mut times = [0.0; 4];
                for (way, time) in ways.iter().zip(&mut times) {
                    // untimed: every way finds caches and memory as the same call leaves them
                    black_box(problem.described());
                    *time = seconds(|| way(&problem));
                }
                times
            })
            .collect();
        let of = |value: &dyn Fn(&[f64; 4]) -> f64| median(rounds.iter().map(value).collect());
        let fit = of(&|r| r[0]);
        println!(
            "{:>8} {:>7} {:>8.1} us {:>7.1} us {:>8.1} us {:>8.1} % {:>15.1} % {:>14.1} %",
            problem.contacts.len(),
            problem.rows,
            fit * 1e6,
            of(&|r| r[2] - r[0]) * 1e6,
            of(&|r| r[3] - r[2]) * 1e6,
            100.0 * of(&|r| (r[3] - r[2]) / r[0]),
            100.0 * of(&|r| (r[3] - r[2]) / r[2]),
            100.0 * of(&|r| (r[1] - r[0]) / r[0]),
        );
    }
}

criterion_group!(benches, timed);

fn main() {
    // a criterion filter, or nothing: the ratios first
    let ratio = std::env::args().any(|argument| argument == "ratio");
    if ratio || !std::env::args().any(|argument| argument.contains('/')) {
        compare();
    }
    if ratio {
        return;
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
