//! Is the truth inside when an exploration stops at its goal?
//!
//! ```text
//! share of stops at the goal whose 95 % interval holds the truth, for S and for R
//! share of all looks after so many contacts whose interval does: what looking once would give
//! ```
//!
//! Every stop whose interval does not hold the truth gets a line of its own.

use palpate::FitOptions;
use palpate_studies::explore::{Exploration, ExploreOptions, Goal, Look, Stopped, Strategy, explore};
use rayon::prelude::*;

use crate::contacts::options;
use crate::objects::{KINDS, object};

/// Rounding of a truth that an interval ends at.
const ROUNDING: f64 = 1e-9;

const BUDGET: usize = 90;

/// Whether the intervals of S and of R hold the truth.
fn held(look: &Look) -> [Option<bool>; 2] {
    let inside = |e: Option<palpate::recognition::Estimate>, truth: Option<f64>| {
        let ([lo, hi], truth) = (e?.interval, truth?);
        Some(lo - ROUNDING <= truth && truth <= hi + ROUNDING)
    };
    [inside(look.shape_index, look.truth[0]), inside(look.curvedness, look.truth[1])]
}

/// The goals that are tried.
const GOALS: [Goal; 2] = [Goal { u_s: 0.01, u_r: 0.02 }, Goal { u_s: 0.03, u_r: 0.05 }];

pub(crate) fn print(first: u64, objects: u64, noises: u64, model: Option<&FitOptions>) {
    GOALS.iter().for_each(|goal| one(first, objects, noises, *goal, model));
}

fn one(first: u64, objects: u64, noises: u64, goal: Goal, model: Option<&FitOptions>) {
    println!(
        "\nstops at u(S) <= {}, u(R)/R <= {} by shape; {objects} objects from seed {first}, {noises} noise seeds each, at most {BUDGET} contacts; {}",
        goal.u_s,
        goal.u_r,
        model.map_or("recognised".into(), |m| format!("named, degree {}", m.degree[0]))
    );
    let runs: Vec<(u64, u64)> = (first..first + objects).flat_map(|o| (1..=noises).map(move |n| (o, n))).collect();
    let found: Vec<(u64, u64, Exploration)> = runs
        .par_iter()
        .filter_map(|&(o, n)| {
            let options =
                ExploreOptions { goal: Some(goal), model: model.cloned(), ..options(Strategy::Shape, n, BUDGET) };
            Some((o, n, explore(&object(o), &options, |_| true).ok()?))
        })
        .collect();
    println!("{:<14} {:>6} {:>9} {:>16} {:>16}   ended by", "kind", "stops", "contacts", "S held", "R held");
    for kind in KINDS.iter().map(Some).chain([None]) {
        let own = found.iter().filter(|(o, _, _)| kind.is_none_or(|k| KINDS[(o % 6) as usize] == *k));
        tell(kind.map_or("all", |k| k), &own.map(|(_, _, e)| e).collect::<Vec<_>>());
    }
    found.iter().filter(|(_, _, e)| e.stopped == Stopped::Goal).for_each(|(o, n, e)| tell_miss(*o, *n, e));
    tell_looks(&found);
}

/// A line for a stop of which an interval does not hold the truth.
fn tell_miss(object: u64, noise: u64, exploration: &Exploration) {
    let Some(look) = exploration.looks.last() else { return };
    let [s, r] = held(look);
    if s != Some(false) && r != Some(false) {
        return;
    }
    let told = |name: &str, e: Option<palpate::recognition::Estimate>, truth: Option<f64>| {
        let (Some(e), Some(truth)) = (e, truth) else { return format!("{name} -") };
        format!("{name} {:.4} in {:.4} .. {:.4}, truth {truth:.4}", e.mean, e.interval[0], e.interval[1])
    };
    println!(
        "  outside: {} {object}, noise {noise}, {} contacts, recognised as {}, p of a richer spline {}: {}; {}",
        KINDS[(object % 6) as usize],
        look.contacts,
        look.kind.as_deref().unwrap_or("-"),
        look.richer_p.map_or("-".into(), |p| format!("{p:.2}")),
        told("S", look.shape_index, look.truth[0]),
        told("R", look.curvedness, look.truth[1]),
    );
}

/// Intervals of all looks by the number of contacts, whether the goal was met or not.
fn tell_looks(found: &[(u64, u64, Exploration)]) {
    print!("  all looks, S and R held, %:");
    for contacts in [9, 15, 21, 30, 45, 60, 90] {
        let looks: Vec<[Option<bool>; 2]> = found
            .iter()
            .filter_map(|(_, _, e)| e.looks.iter().find(|look| look.contacts == contacts))
            .map(held)
            .collect();
        let share = |q: usize| {
            let asked: Vec<bool> = looks.iter().filter_map(|h| h[q]).collect();
            100.0 * asked.iter().filter(|h| **h).count() as f64 / asked.len().max(1) as f64
        };
        print!("  {contacts}: {:.0}, {:.0} ({})", share(0), share(1), looks.len());
    }
    println!();
}

fn tell(name: &str, found: &[&Exploration]) {
    let stops: Vec<&Look> =
        found.iter().filter(|e| e.stopped == Stopped::Goal).filter_map(|e| e.looks.last()).collect();
    let share = |q: usize| {
        let asked: Vec<bool> = stops.iter().filter_map(|look| held(look)[q]).collect();
        let inside = asked.iter().filter(|h| **h).count();
        if asked.is_empty() {
            "-".into()
        } else {
            format!("{:.1} % of {}", 100.0 * inside as f64 / asked.len() as f64, asked.len())
        }
    };
    let mut contacts: Vec<usize> = stops.iter().map(|look| look.contacts).collect();
    contacts.sort_unstable();
    let middle = contacts.get(contacts.len() / 2).map_or("-".into(), |c| c.to_string());
    let ends = [Stopped::Goal, Stopped::Budget, Stopped::Noise, Stopped::Model]
        .map(|stopped| format!("{} {}", stopped.name(), found.iter().filter(|e| e.stopped == stopped).count()));
    println!("{name:<14} {:>6} {middle:>9} {:>16} {:>16}   {}", stops.len(), share(0), share(1), ends.join(", "));
}
