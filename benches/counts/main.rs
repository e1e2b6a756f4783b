//! Counts that no clock blurs, held against `baseline.json`: `cargo bench --bench counts [-- --record]`.
//!
//! | count | from |
//! |---|---|
//! | instructions | callgrind over one run of a workload (valgrind has no AVX-512: they are those of the AVX2 path) |
//! | allocations | of one repeated run |
//! | factor nonzeros, multiply-adds | the plan of the factor |
//! | iterations | conjugate gradients on a weighted grid, Gauss-Newton on normals |
//!
//! Without valgrind, instructions are "not counted". The baseline is keyed by the compiler's version; an unknown
//! compiler is told so and passes. Growth beyond 2 % fails.

mod compare;
mod regions;
#[path = "../workloads/mod.rs"]
#[allow(dead_code, reason = "other benches use the rest")]
mod workloads;

use std::alloc::System;
use std::collections::BTreeMap;
use std::process::{Command, ExitCode};

use compare::{ALLOWED, Counts, growths};
use ndarray::Array2;
use palpate::fit::{Method, Note, Objective, Reason, SlopeWeights};
use palpate::{Contacts, FitOptions, Grid, fit_contacts, fit_grid};
use palpate_numeric::linalg::TensorShape;
use palpate_numeric::simd::Isa;
use palpate_numeric::solve::Cholesky;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use workloads::{Fault, pool};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const BASELINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/counts/baseline.json");

fn main() -> Result<ExitCode, Fault> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    if let [flag, name] = &arguments[..]
        && flag == "--region"
    {
        region(name)?;
        return Ok(ExitCode::SUCCESS);
    }
    let found = count()?;
    let compiler = compiler();
    let mut baselines: BTreeMap<String, Counts> =
        serde_json::from_str(&std::fs::read_to_string(BASELINE).unwrap_or_else(|_| "{}".into()))?;
    if arguments.iter().any(|a| a == "--record") {
        baselines.insert(compiler, found);
        std::fs::write(BASELINE, serde_json::to_string_pretty(&baselines)? + "\n")?;
        return Ok(ExitCode::SUCCESS);
    }
    let Some(baseline) = baselines.get(&compiler) else {
        println!("no baseline for {compiler}: record one with --record");
        return Ok(ExitCode::SUCCESS);
    };
    let grown = growths(baseline, &found);
    for growth in &grown {
        println!("grew by more than {ALLOWED} %: {} from {} to {}", growth.name, growth.before, growth.after);
    }
    println!("{} counts, {} of them in the baseline of {compiler}, {} grew", found.len(), baseline.len(), grown.len());
    Ok(if grown.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn compiler() -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let said = Command::new(rustc).arg("--version").output();
    said.map_or_else(|_| "unknown compiler".into(), |out| String::from_utf8_lossy(&out.stdout).trim().to_string())
}

fn count() -> Result<Counts, Fault> {
    let mut counts = Counts::new();
    let mut note = |name: String, value: u64| {
        println!("{name:<58} {value}");
        counts.insert(name, value);
    };
    for name in regions::NAMES {
        match instructions(name)? {
            Some((isa, value)) => note(format!("{name} instructions ({isa})"), value),
            None => println!("{:<58} not counted: no valgrind", format!("{name} instructions")),
        }
        note(format!("{name} allocations"), pool(1)?.install(|| allocations(name))?);
    }
    for (name, basis, degree) in [("w1", 3, 2), ("w2", 67, 3), ("w2l", 131, 3), ("512 segments", 515, 3)] {
        let factor = Cholesky::plan(TensorShape { basis: [basis; 2], degree: [degree; 2] })?;
        note(format!("factor/{name} nonzeros"), factor.factor_entries() as u64);
        note(format!("factor/{name} multiply-adds"), factor.multiply_adds() as u64);
    }
    note("grid/weighted iterations".into(), weighted_grid_iterations()?);
    note("contacts/normals iterations".into(), normal_iterations()?);
    Ok(counts)
}

/// What callgrind toggles on: never inlined, so that its name is found.
#[inline(never)]
fn counted_region(run: &mut regions::Run) -> Result<(), Fault> {
    run()
}

fn region(name: &str) -> Result<(), Fault> {
    println!("{}", Isa::active().name());
    let mut run = regions::prepare(name)?;
    pool(1)?.install(|| counted_region(&mut run))
}

/// Instruction set and instructions of one run; `None` without valgrind.
fn instructions(name: &str) -> Result<Option<(String, u64)>, Fault> {
    let out = tempfile::NamedTempFile::new()?;
    let said = Command::new("valgrind")
        .args(["--tool=callgrind", "--toggle-collect=*counted_region*"])
        .arg(format!("--callgrind-out-file={}", out.path().display()))
        .arg(std::env::current_exe()?)
        .args(["--region", name])
        .output();
    let Ok(said) = said else { return Ok(None) };
    let (isa, log) = (String::from_utf8_lossy(&said.stdout), String::from_utf8_lossy(&said.stderr));
    let collected = log.lines().find_map(|line| line.split("Collected :").nth(1)?.trim().parse().ok());
    match collected {
        Some(value) if said.status.success() && value > 0 => Ok(Some((isa.trim().to_string(), value))),
        _ => Err(format!("callgrind counted nothing in {name}: {log}").into()),
    }
}

fn allocations(name: &str) -> Result<u64, Fault> {
    let mut run = regions::prepare(name)?;
    let region = Region::new(COUNTED);
    run()?;
    let change = region.change();
    Ok((change.allocations + change.reallocations) as u64)
}

/// Conjugate gradients, preconditioned by fast diagonalisation, on a grid whose weights vary by a factor of four.
fn weighted_grid_iterations() -> Result<u64, Fault> {
    let axis = palpate_numeric::bspline::linspace(0.0, 1.0, 60);
    let map = |f: fn(f64, f64) -> f64| Array2::from_shape_fn((60, 60), |(i, j)| f(axis[i], axis[j]));
    let wave = map(|x, y| 0.3 * (6.0 * x).sin() * (5.0 * y).cos());
    let weights = map(|x, y| 2.0_f64.powf((3.0 * x).sin() * (4.0 * y).cos()));
    let grid = Grid { wz: Some(weights), ..Grid::new(axis.clone(), axis.clone(), wave) };
    let options = FitOptions::default()
        .with_degree(3)
        .with_segments(16, 16)
        .with_method(Method::Pcg)
        .with_objective(Objective::Slopes(SlopeWeights::Equal));
    let fit = fit_grid(&grid, &options)?;
    let iterations = fit.solution().reasons.iter().find_map(|reason| match reason {
        Reason::Iterated { iterations } => Some(*iterations as u64),
        _ => None,
    });
    iterations.ok_or_else(|| "conjugate gradients did not say how many".into())
}

/// Gauss-Newton steps of the paper's contacts with normals at all levels tried while both noise levels are estimated.
fn normal_iterations() -> Result<u64, Fault> {
    let [x, y, z, zx, zy] = workloads::paper(false).0;
    let (nx, ny) = (zx.iter().map(|p| -p).collect(), zy.iter().map(|q| -q).collect());
    let contacts = Contacts::from_positions(x, y, z).with_normals(nx, ny, vec![1.0; 36]);
    let fit = fit_contacts(&contacts, &FitOptions::default())?;
    let steps = fit.notes().iter().find_map(|note| match note {
        Note::GaussNewton { steps } => Some(*steps as u64),
        _ => None,
    });
    steps.ok_or_else(|| "Gauss-Newton did not say how many".into())
}
