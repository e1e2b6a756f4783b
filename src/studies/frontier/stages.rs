//! Where the microseconds of a fit and of a replicate go.
//!
//! ```text
//! fit         read | place | rows | factor | shape | interval | certificate
//! replicate   effects | fit and shape | tally
//! ```
//!
//! A stage is the difference of two calls that were timed in the same rounds: fit with shape less fit, for example. Rows are
//! timed by themselves, and placing too; what is left of a fit is its factor, with refinement and whatever is iterated.

use std::hint::black_box;

use crate::montecarlo::{Path, Study, StudyOptions};
use palpate_fitting::fit::{FitOptions, SurfaceKind, fit_contacts, stages};
use palpate_geometry::contact::Contacts;
use palpate_numeric::threads;
use palpate_world::scene::{ContactBatch, World};

use super::clock::{Call, Clocked, Limits, clocked, round_times};

/// Rounds: stages are differences, and need more of them than whole calls do.
const LIMITS: Limits = Limits { least: 5, most: 60, seconds: 4.0, each: 0.8 };

/// One stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// `fit` or `replicate`.
    pub of: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its time.
    pub time: Clocked,
    /// What switches it off.
    pub saved_by: &'static str,
}

/// What a stage takes, from the times of all calls in one round.
type Difference = fn(&[f64]) -> f64;

/// The stage's time over all rounds, `count` pieces of work in each.
fn stage_time(times: &[Vec<f64>], count: f64, of: Difference) -> Clocked {
    let rounds = times.iter().map(Vec::len).min().unwrap_or(0);
    let in_round = |round: usize| times.iter().map(|calls| calls[round] / count).collect::<Vec<f64>>();
    clocked(&(0..rounds).map(|round| of(&in_round(round))).collect::<Vec<f64>>())
}

/// Stages of the fit of these contacts; `read` reads them from where they come. Nothing for surfaces that are no height
/// field, whose steps are others.
pub fn of_fit(contacts: &Contacts, options: &FitOptions, read: &(dyn Fn() + Sync)) -> Vec<Stage> {
    if options.surface != SurfaceKind::Height || fit_contacts(contacts, options).is_err() {
        return Vec::new();
    }
    threads::alone(|| fit_stages(contacts, options, read))
}

fn fit_stages(contacts: &Contacts, options: &FitOptions, read: &dyn Fn()) -> Vec<Stage> {
    let Ok(fitted) = fit_contacts(contacts, options) else { return Vec::new() };
    let equations = fitted.equations();
    let mut calls: Vec<Call<'_, ()>> = vec![
        Box::new(|_| read()),
        Box::new(|_| drop(black_box(stages::place(contacts, options)))),
        Box::new(|_| stages::write_down(equations)),
        Box::new(|_| drop(black_box(fit_contacts(contacts, options)))),
        Box::new(|_| drop(black_box(fit_contacts(contacts, options).map(|fit| fit.bare_shape().support)))),
        Box::new(|_| drop(black_box(fit_contacts(contacts, options).map(|fit| fit.shape().support)))),
        Box::new(|_| {
            drop(black_box(fit_contacts(contacts, options).map(|fit| {
                fit.shape();
                fit.certificate().rank
            })));
        }),
    ];
    let times = round_times(&mut calls, LIMITS, &|_, _| true, |_, _, ()| ());
    let stage = |name, saved_by, of: Difference| Stage { of: "fit", name, time: stage_time(&times, 1.0, of), saved_by };
    vec![
        stage("read", "contacts handed over in memory", |t| t[0]),
        stage("place", "a plan for sites that stay (plans::SlopePlan)", |t| t[1]),
        stage("rows", "a plan for sites that stay", |t| t[2]),
        stage("factor", "a plan for sites that stay; a lower degree", |t| t[3] - t[2] - t[1]),
        stage("shape", "a coarser --grid", |t| t[4] - t[3]),
        stage("interval", "--bare", |t| t[5] - t[4]),
        stage("certificate", "--bare", |t| t[6] - t[5]),
    ]
}

/// Stages of a replicate of this scene, seconds a replicate.
pub fn of_replicate(world: &World, options: &FitOptions, seed: u64) -> Vec<Stage> {
    threads::alone(|| replicate_stages(world, options, seed)).unwrap_or_default()
}

fn replicate_stages(world: &World, options: &FitOptions, seed: u64) -> Option<Vec<Stage>> {
    let simulator = world.compile().ok()?;
    let study = Study::new(world.compile().ok()?, options, StudyOptions::default(), seed).ok()?;
    let engine = study.engine();
    let count: u64 = if engine.path() == Path::Whole { 32 } else { 4096 };
    let mut batch = ContactBatch::default();
    let mut calls: Vec<Call<'_, ()>> = vec![
        Box::new(|number| simulator.simulate_batch(seed, number * count, count as usize, &mut batch)),
        Box::new(|number| drop(black_box(engine.values(seed, number * count, count as usize)))),
        Box::new(|number| {
            let from = number * count;
            drop(black_box(study.run(study.start(from), from + count, &mut |_| true)));
        }),
    ];
    let times = round_times(&mut calls, LIMITS, &|_, _| true, |_, _, ()| ());
    let stage = |name, saved_by, of: Difference| Stage {
        of: "replicate",
        name,
        time: stage_time(&times, count as f64, of),
        saved_by,
    };
    let fitted = match engine.path() {
        Path::Whole => "weights or sigmas given as numbers, so that factors are kept",
        Path::Refit => "sites that stand still, so that one factor serves all replicates",
        Path::FixedSites | Path::Linearised => "",
    };
    Some(vec![
        stage("effects", "fewer effects in the scene", |t| t[0]),
        stage("fit, shape", fitted, |t| t[1] - t[0]),
        stage("tally", "", |t| t[2] - t[1]),
    ])
}
