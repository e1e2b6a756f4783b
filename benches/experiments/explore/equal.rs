//! What is known after equally many contacts, by each strategy, and how many contacts a strategy needs to know as much as `lattice`
//! knows in the end.
//!
//! ```text
//! |error of S|, |error of R|/R, u(R)/R      medians over the runs after 12, 18, 30, 45, 60 contacts
//! as much as lattice                        least contacts from which on the median of u(R)/R stays below lattice's after 60
//! ```

use palpate_studies::explore::{Look, Strategy, explore};
use rayon::prelude::*;

use crate::contacts::{BUDGET, errors, options};
use crate::objects::{KINDS, object};

/// Numbers of contacts that the table shows.
const AFTER: [usize; 5] = [12, 18, 30, 45, 60];

/// One look: object, contacts, |error of S|, |error of R|/R, u(R)/R.
struct Known {
    object: u64,
    contacts: usize,
    values: [f64; 3],
}

fn known(object: u64, look: &Look) -> Option<Known> {
    let ([of_s, of_r], r) = (errors(look)?, look.curvedness?);
    Some(Known { object, contacts: look.contacts, values: [of_s, of_r, r.u / r.mean] })
}

fn looks(seed: u64, noise: u64, strategy: Strategy) -> Vec<Known> {
    let mut found = Vec::new();
    let mut watch = |look: &Look| {
        found.extend(known(seed, look));
        true
    };
    if let Err(error) = explore(&object(seed), &options(strategy, noise, BUDGET), &mut watch) {
        panic!("object {seed}: {error}");
    }
    found
}

/// Median of one value over the looks of a kind (all kinds: `None`) with so many contacts.
fn median(known: &[Known], kind: Option<usize>, contacts: usize, value: usize) -> f64 {
    let own = known.iter().filter(|k| k.contacts == contacts && kind.is_none_or(|kind| k.object % 6 == kind as u64));
    let mut values: Vec<f64> = own.map(|k| k.values[value]).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Least contacts from which on the median of u(R)/R stays at most this.
fn needed(known: &[Known], kind: usize, u: f64) -> Option<usize> {
    let mut counts: Vec<usize> = known.iter().map(|k| k.contacts).collect();
    counts.sort_unstable();
    counts.dedup();
    counts.into_iter().rev().take_while(|&c| median(known, Some(kind), c, 2) <= u).last()
}

pub(crate) fn print(first: u64, objects: u64, noises: u64) {
    println!(
        "\n{objects} objects from seed {first}, {noises} noise seeds each; first sweep 3 x 3, 3 touches a round; recognised"
    );
    let runs: Vec<(u64, u64)> = (first..first + objects).flat_map(|o| (1..=noises).map(move |n| (o, n))).collect();
    let all: Vec<(&str, Vec<Known>)> = Strategy::WORDS
        .iter()
        .map(|(word, strategy)| (*word, runs.par_iter().flat_map_iter(|&(o, n)| looks(o, n, *strategy)).collect()))
        .collect();
    for (value, name) in ["|error of S|", "|error of R|/R", "u(R)/R"].iter().enumerate() {
        println!("{:<16} {}", format!("median {name}"), AFTER.map(|c| format!("{c:>9}")).concat());
        for (word, known) in &all {
            println!("{word:<22} {}", AFTER.map(|c| format!("{:>9.4}", median(known, None, c, value))).concat());
        }
    }
    println!("contacts to know R as well as lattice does after {BUDGET}");
    for (word, known) in &all {
        let of_kind = KINDS.iter().enumerate().map(|(k, kind)| {
            let found = needed(known, k, median(&all[0].1, Some(k), BUDGET, 2));
            format!("{kind} {}", found.map_or(format!("> {BUDGET}"), |c| c.to_string()))
        });
        println!("{word:<22} {}", of_kind.collect::<Vec<_>>().join(", "));
    }
}
