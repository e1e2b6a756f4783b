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
//! `palpate fit` does by default. The ways take turns in one process, each with several calls in a row, as criterion
//! measures them too; ratios are medians over the rounds. "once" is the certificate of one fit after others without: its
//! instructions and its data are then further away, and the fit's are not.

use std::hint::black_box;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion, criterion_group};
use palpate::Contacts;
use palpate::Orientation;
use palpate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};
use palpate_laboratory::hard_cases::Lcg;
use palpate_world::scene::linspace;

struct Problem {
    rows: &'static str,
    contacts: Contacts,
    options: FitOptions,
    rounds: usize,
    /// Calls in a row.
    calls: usize,
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
    let small = Problem {
        rows: "slopes",
        contacts,
        options: FitOptions::default().with_objective(objective),
        rounds: 501,
        calls: 16,
    };
    let by_default = Problem { rows: "normals", contacts: felt, options: FitOptions::default(), rounds: 101, calls: 5 };
    let lcg = &mut Lcg::new(200_000);
    let (x, y) = (0..200_000).map(|_| (2.0 * lcg.uniform() - 1.0, 2.0 * lcg.uniform() - 1.0)).unzip();
    let options = FitOptions::default().with_degree(3).with_segments(64, 64).with_objective(objective);
    [small, by_default, Problem { rows: "slopes", contacts: touched(x, y), options, rounds: 21, calls: 1 }]
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
        group.sample_size(10.max(problem.rounds / 40));
        group.bench_function(BenchmarkId::new("fit", &size), |b| b.iter(|| problem.fit()));
        group.bench_function(BenchmarkId::new("fit_shape", &size), |b| b.iter(|| problem.described()));
        group.bench_function(BenchmarkId::new("fit_shape_certificate", &size), |b| b.iter(|| problem.certified()));
        group.finish();
    }
}

impl Problem {
    /// Seconds a call, among calls of the same kind.
    fn in_a_row(&self, way: fn(&Problem) -> Fit) -> f64 {
        drop(way(self));
        let start = Instant::now();
        (0..self.calls).for_each(|_| drop(black_box(way(self))));
        start.elapsed().as_secs_f64() / self.calls as f64
    }

    /// Seconds of one fit and of its certificate, after others without one.
    fn once(&self) -> [f64; 2] {
        (0..self.calls).for_each(|_| drop(black_box(self.described())));
        let start = Instant::now();
        let fit = self.fit();
        let of_fit = start.elapsed().as_secs_f64();
        black_box(fit.shape());
        let start = Instant::now();
        black_box(fit.certificate());
        [of_fit, start.elapsed().as_secs_f64()]
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn compare() {
    println!("                                             certificate");
    println!(
        "contacts    rows       fit      shape    in a row    of the fit   of fit and shape        once   not asked for"
    );
    for problem in problems() {
        let ways: [fn(&Problem) -> Fit; 4] = [Problem::fit, Problem::not_asked, Problem::described, Problem::certified];
        let rounds: Vec<([f64; 4], [f64; 2])> = (0..problem.rounds)
            .map(|round| {
                let mut times = [0.0; 4];
                // another way first in every round
                for k in (0..4).map(|k| (k + round) % 4) {
                    times[k] = problem.in_a_row(ways[k]);
                }
                (times, problem.once())
            })
            .collect();
        let of = |value: &dyn Fn(&[f64; 4]) -> f64| median(rounds.iter().map(|(row, _)| value(row)).collect());
        let once = median(rounds.iter().map(|(_, [fit, certificate])| certificate / fit).collect());
        println!(
            "{:>8} {:>7} {:>8.1} us {:>7.1} us {:>8.1} us {:>11.1} % {:>16.1} % {:>9.1} % {:>13.1} %",
            problem.contacts.len(),
            problem.rows,
            of(&|r| r[0]) * 1e6,
            of(&|r| r[2] - r[0]) * 1e6,
            of(&|r| r[3] - r[2]) * 1e6,
            100.0 * of(&|r| (r[3] - r[2]) / r[0]),
            100.0 * of(&|r| (r[3] - r[2]) / r[2]),
            100.0 * once,
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
