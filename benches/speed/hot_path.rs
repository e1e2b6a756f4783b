//! The five workloads under criterion: `cargo bench --bench hot_path`.
//!
//! | id | workload |
//! |---|---|
//! | `paper_fit/w1` | 36 contacts -> 9 coefficients -> S, R on 8 x 8, by the plan |
//! | `paper_fit/w1_certified` | the same through `fit_contacts`: frame, certificate, uncertainty, plane test |
//! | `scattered_fit/w2_1t`, `w2_2t`, `w2l_1t`, `w2l_2t` | contacts -> coefficients, one and two threads |
//! | `image_fit/cold`, `reused` | a 640 x 480 frame with and without the plan |
//! | `noise_study/1t`, `2t` | 100,000 replicates of W1, from the draws to mean S and R of each |
//! | `curvature_map/1t`, `2t` | S and R on 1000 x 1000 points |
//!
//! Inputs are made outside the timer. Times against other tools: `benches/peers/compare.py`.

#[path = "../workloads/mod.rs"]
mod workloads;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput};
use palpate::fit::{Objective, SlopeWeights};
use palpate::montecarlo::FixedSites;
use palpate::plans::{ImagePlan, SlopePlan};
use palpate::spline::CurvatureGrid;
use palpate::{Contacts, FitOptions, fit_contacts};
use palpate_numeric::bspline::linspace;
use workloads::{Fault, image, image_knots, paper, paper_knots, paper_points, pool, scattered, square_knots};

fn main() -> Result<(), Fault> {
    let mut criterion = Criterion::default().configure_from_args();
    paper_fit(&mut criterion)?;
    scattered_fit(&mut criterion)?;
    image_fit(&mut criterion)?;
    noise_study(&mut criterion)?;
    curvature_map(&mut criterion)?;
    criterion.final_summary();
    Ok(())
}

fn paper_fit(criterion: &mut Criterion) -> Result<(), Fault> {
    let (columns, points) = (paper(false), paper_points());
    let mut plan = SlopePlan::new(paper_knots()?, [1.0, 2.0, 2.0])?;
    let mut grid = CurvatureGrid::new(&paper_knots()?, &points, &points);
    let (mut s, mut r) = ([0.0; 64], [0.0; 64]);
    plan.fit(&columns.view())?;
    let mut group = criterion.benchmark_group("paper_fit");
    group.throughput(Throughput::Elements(36));
    group.bench_function("w1", |b| {
        b.iter(|| {
            if let Ok(c) = plan.fit(black_box(&columns.view())) {
                grid.maps(c, &mut s, &mut r);
            }
            black_box((&s, &r));
        });
    });
    let [x, y, z, zx, zy] = columns.0;
    let contacts = Contacts::from_positions(x, y, z).with_slopes(zx, zy);
    let options = FitOptions::default()
        .with_domain([-4.5, 4.5, -4.5, 4.5])
        .with_objective(Objective::Slopes(SlopeWeights::Explicit([1.0, 2.0, 2.0])))
        .with_inset(1.0 / 9.0);
    fit_contacts(&contacts, &options)?;
    group.bench_function("w1_certified", |b| {
        b.iter(|| {
            let fit = fit_contacts(black_box(&contacts), &options);
            fit.map(|fit| (fit.shape().class, fit.certificate().backward_error))
        });
    });
    group.finish();
    Ok(())
}

fn scattered_fit(criterion: &mut Criterion) -> Result<(), Fault> {
    let mut group = criterion.benchmark_group("scattered_fit");
    group.sample_size(10).measurement_time(Duration::from_secs(8));
    for (name, contacts, segments) in [("w2", 200_000, 64), ("w2l", 1_000_000, 128)] {
        let columns = scattered(contacts);
        let knots = square_knots(3, segments, 0.0, 1.0)?;
        group.throughput(Throughput::Elements(contacts as u64));
        for threads in [1, 2] {
            let pool = pool(threads)?;
            // the plan is inside the timer, as everything is in the peers'
            let run = || SlopePlan::new(knots.clone(), [1.0; 3]).and_then(|mut p| Ok(p.fit(&columns.view())?[0]));
            pool.install(run)?;
            group.bench_function(format!("{name}_{threads}t"), |b| b.iter(|| pool.install(run)));
        }
    }
    group.finish();
    Ok(())
}

fn image_fit(criterion: &mut Criterion) -> Result<(), Fault> {
    let ([x, y], [z, zx, zy]) = image();
    let knots = image_knots()?;
    let mut group = criterion.benchmark_group("image_fit");
    group.throughput(Throughput::Elements(z.len() as u64));
    let mut plan = ImagePlan::new(knots.clone(), &x, &y, [1.0; 3])?;
    group.bench_function("cold", |b| {
        b.iter(|| ImagePlan::new(knots.clone(), &x, &y, [1.0; 3]).and_then(|mut p| Ok(p.fit_frame(&z, &zx, &zy)?[0])));
    });
    group.bench_function("reused", |b| b.iter(|| plan.fit_frame(black_box(&z), &zx, &zy).map(|c| c[0])));
    group.finish();
    Ok(())
}

fn noise_study(criterion: &mut Criterion) -> Result<(), Fault> {
    let (columns, points) = (paper(true), paper_points());
    let knots = paper_knots()?;
    let (mut s, mut r) = (vec![0.0; 100_000], vec![0.0; 100_000]);
    let mut group = criterion.benchmark_group("noise_study");
    group.sample_size(20).throughput(Throughput::Elements(s.len() as u64));
    for threads in [1, 2] {
        let pool = pool(threads)?;
        let mut run = || {
            let noise = [0.02, 0.05, 0.05];
            let sites = FixedSites::new(&knots, &columns.view(), [1.0, 2.0, 2.0], noise, [&points, &points]);
            sites.map(|sites| sites.replicates(2026, 0, &mut s, &mut r))
        };
        run()?;
        group.bench_function(format!("{threads}t"), |b| b.iter(|| pool.install(&mut run)));
    }
    group.finish();
    Ok(())
}

fn curvature_map(criterion: &mut Criterion) -> Result<(), Fault> {
    let knots = square_knots(3, 64, 0.0, 1.0)?;
    let c = workloads::bicubic(&knots);
    let points = linspace(0.0, 1.0, 1000);
    let (mut s, mut r) = (vec![0.0; 1_000_000], vec![0.0; 1_000_000]);
    let mut group = criterion.benchmark_group("curvature_map");
    group.sample_size(30).throughput(Throughput::Elements(s.len() as u64));
    for threads in [1, 2] {
        let pool = pool(threads)?;
        let mut run = || CurvatureGrid::new(&knots, &points, &points).maps(&c, &mut s, &mut r);
        group.bench_function(format!("{threads}t"), |b| b.iter(|| pool.install(&mut run)));
    }
    group.finish();
    Ok(())
}
