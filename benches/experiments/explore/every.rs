//! Is the answer right once every candidate place has been touched? Where it is not, no choice of places can make it so.
//!
//! ```text
//! contacts = 21 x 21, the lattice of candidates        right: |error S| <= 0.01 and |error R|/R <= 0.02
//! ```

use palpate::scene::{Sweep, World};
use palpate_studies::explore::{Look, Strategy, explore};
use palpate_world::scene::linspace;
use rayon::prelude::*;

use crate::contacts::{errors, is_right, options};
use crate::objects::{HALF, KINDS, object};

/// Places each way at which explorations touch.
const PLACES: usize = 21;

/// What one answer misses, and the kind of surface that was recognised.
struct Answered {
    right: bool,
    errors: Option<[f64; 2]>,
    kind: String,
}

fn answered(seed: u64, noise: u64) -> Answered {
    let axis = linspace(-HALF, HALF, PLACES);
    let world = World { sweeps: vec![Sweep::new(axis.clone(), axis)], ..object(seed) };
    let mut found = Answered { right: false, errors: None, kind: "-".into() };
    let mut watch = |look: &Look| {
        found = Answered { right: is_right(look), errors: errors(look), kind: look.kind.clone().unwrap_or("-".into()) };
        false
    };
    let budget = PLACES * PLACES + 1;
    if let Err(error) = explore(&world, &options(Strategy::Random, noise, budget), &mut watch) {
        panic!("object {seed}: {error}");
    }
    found
}

pub(crate) fn print(first: u64, objects: u64, noises: u64) {
    println!(
        "\n{objects} objects from seed {first}, {noises} noise seeds each; all {PLACES} x {PLACES} candidates touched; recognised"
    );
    println!("{:<14} {:>9} {:>11} {:>13}   recognised as", "kind", "right", "|error S|", "|error R|/R");
    let runs: Vec<(u64, u64)> = (first..first + objects).flat_map(|o| (1..=noises).map(move |n| (o, n))).collect();
    let found: Vec<(u64, Answered)> = runs.par_iter().map(|&(o, n)| (o % 6, answered(o, n))).collect();
    for (number, kind) in KINDS.iter().enumerate() {
        let own: Vec<&Answered> = found.iter().filter(|(k, _)| *k == number as u64).map(|(_, a)| a).collect();
        let median = |q: usize| {
            let mut errors: Vec<f64> = own.iter().filter_map(|a| Some(a.errors?[q])).collect();
            errors.sort_by(f64::total_cmp);
            errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let mut names: Vec<&str> = own.iter().map(|a| a.kind.as_str()).collect();
        names.sort_unstable();
        let names: Vec<String> = names.chunk_by(|a, b| a == b).map(|n| format!("{} {}", n[0], n.len())).collect();
        let right = own.iter().filter(|a| a.right).count();
        println!(
            "{kind:<14} {:>9} {:>11.4} {:>13.4}   {}",
            format!("{right} of {}", own.len()),
            median(0),
            median(1),
            names.join(", ")
        );
    }
}
