//! Contacts until |error S| <= 0.01 and |error R|/R <= 0.02, by each strategy.
//!
//! ```text
//! contacts until = those of the first of two successive looks that are both within         more than the budget: never
//! ```

use palpate::FitOptions;
use palpate::scene::Sweep;
use palpate_inference::recognition::RecognitionOptions;
use palpate_studies::explore::{ExploreOptions, Look, Strategy, explore};
use palpate_world::scene::linspace;
use rayon::prelude::*;

use crate::objects::{HALF, KINDS, object};

/// Most contacts that are spent on one object.
pub(crate) const BUDGET: usize = 60;

/// Errors of S and of R/R within which an answer is right.
pub(crate) const RIGHT: [f64; 2] = [0.01, 0.02];

/// |error of S| and |error of R|/R of a look.
pub(crate) fn errors(look: &Look) -> Option<[f64; 2]> {
    let [s, r] = [look.shape_index?.mean, look.curvedness?.mean];
    let [true_s, true_r] = look.truth;
    Some([(s - true_s?).abs(), (r / true_r? - 1.0).abs()])
}

/// Whether a look's S and R are right.
pub(crate) fn is_right(look: &Look) -> bool {
    errors(look).is_some_and(|[s, r]| s <= RIGHT[0] && r <= RIGHT[1])
}

/// Three touches a round from the rectangle of the first sweep, and no goal.
pub(crate) fn options(strategy: Strategy, noise: u64, contacts: usize) -> ExploreOptions {
    ExploreOptions {
        strategy,
        contacts,
        model: None,
        recognition: RecognitionOptions::default(),
        goal: None,
        per_round: 3,
        lines: false,
        seed: noise,
        reach: None,
        level: 0.95,
    }
}

/// How an exploration begins and goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Protocol {
    /// Fingers, and stations of each, in the first sweep.
    pub(crate) first: usize,
    /// Touches between two looks.
    pub(crate) round: usize,
}

/// Contacts until the answer is right; `None` where the budget does not do.
fn until(
    seed: u64,
    noise: u64,
    (strategy, lines): (Strategy, bool),
    protocol: Protocol,
    model: Option<&FitOptions>,
) -> Option<usize> {
    let options =
        ExploreOptions { lines, per_round: protocol.round, model: model.cloned(), ..options(strategy, noise, BUDGET) };
    let mut world = object(seed);
    let axis = linspace(-HALF, HALF, protocol.first);
    world.sweeps = vec![Sweep::new(axis.clone(), axis)];
    let mut before: Option<usize> = None;
    let mut found = None;
    let mut watch = |look: &Look| {
        let right = is_right(look);
        if right && before.is_some() {
            found = before;
        }
        before = right.then_some(look.contacts);
        found.is_none()
    };
    if let Err(error) = explore(&world, &options, &mut watch) {
        panic!("object {seed}: {error}");
    }
    found
}

/// The q-quantile; runs that never came to be right stand at the end.
fn quantile(sorted: &[usize], q: f64) -> String {
    let at = ((q * sorted.len() as f64).ceil() as usize).clamp(1, sorted.len()) - 1;
    if sorted[at] == usize::MAX { format!("> {BUDGET}") } else { sorted[at].to_string() }
}

pub(crate) fn print(
    (first, objects, noises): (u64, u64, u64),
    protocol: Protocol,
    only: Option<&str>,
    model: Option<&FitOptions>,
) {
    let answer = model.map_or("recognised".into(), |m| format!("named, degree {}", m.degree[0]));
    println!(
        "\n{objects} objects from seed {first}, {noises} noise seeds each; first sweep {0} x {0}, {1} touches a round; {answer}",
        protocol.first, protocol.round
    );
    println!("{:<22} {:>7} {:>8} {:>10}   medians by kind", "strategy", "median", "90 %", "never, %");
    let mut strategies: Vec<(String, Strategy, bool)> =
        Strategy::WORDS.iter().map(|(word, strategy)| (word.to_string(), *strategy, false)).collect();
    strategies.push(("shape, lines of 5".into(), Strategy::Shape, true));
    strategies.retain(|(name, _, lines)| {
        let word = if *lines { "lines" } else { name };
        only.is_none_or(|only| only.split(',').any(|asked| asked == word))
    });
    assert!(!strategies.is_empty(), "only= takes lattice, random, second-sweep, variance, shape, probe-model, lines");
    let mut all: Vec<(String, Vec<(u64, usize)>)> = Vec::new();
    for (name, strategy, lines) in strategies {
        let runs: Vec<(u64, u64)> = (first..first + objects).flat_map(|o| (1..=noises).map(move |n| (o, n))).collect();
        let found: Vec<(u64, usize)> = runs
            .par_iter()
            .map(|&(o, n)| (o, until(o, n, (strategy, lines), protocol, model).unwrap_or(usize::MAX)))
            .collect();
        tell(&name, &found);
        all.push((name, found));
    }
    tell_settled(&all);
}

/// Every strategy beside the first over the runs that both settle: those that neither does say nothing of planning.
pub(crate) fn tell_settled(all: &[(String, Vec<(u64, usize)>)]) {
    let Some(((first, of_first), others)) = all.split_first() else { return };
    println!("over the runs that {first} settles, too:");
    for (name, found) in others {
        let both: Vec<(f64, f64)> = of_first
            .iter()
            .zip(found)
            .filter(|(a, b)| a.1 != usize::MAX && b.1 != usize::MAX)
            .map(|(a, b)| (a.1 as f64, b.1 as f64))
            .collect();
        let sums = both.iter().fold((0.0, 0.0), |sums, (a, b)| (sums.0 + a, sums.1 + b));
        let mut ratios: Vec<f64> = both.iter().map(|(a, b)| b / a).collect();
        ratios.sort_by(f64::total_cmp);
        println!(
            "{name:<22} {:>4} of {:>4} runs, contacts {:>5.2} of those of {first} in all, {:>5.2} in the median",
            both.len(),
            found.len(),
            sums.1 / sums.0,
            ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN),
        );
    }
}

/// One line of the table.
pub(crate) fn tell(name: &str, found: &[(u64, usize)]) {
    let sorted = |kind: Option<u64>| {
        let mut counts: Vec<usize> =
            found.iter().filter(|(o, _)| kind.is_none_or(|k| o % 6 == k)).map(|(_, c)| *c).collect();
        counts.sort_unstable();
        counts
    };
    let all = sorted(None);
    let never = all.iter().filter(|c| **c == usize::MAX).count() as f64 / all.len() as f64;
    let kinds = KINDS.iter().enumerate().map(|(k, kind)| {
        let own = sorted(Some(k as u64));
        if own.is_empty() { String::new() } else { format!("{kind} {}", quantile(&own, 0.5)) }
    });
    println!(
        "{name:<22} {:>7} {:>8} {:>10.1}   {}",
        quantile(&all, 0.5),
        quantile(&all, 0.9),
        100.0 * never,
        kinds.collect::<Vec<_>>().join(", ")
    );
}
