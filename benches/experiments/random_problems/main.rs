//! Random problems against a QR in 32 digits: how often a promise of digits is broken.
//!
//!     cargo bench --bench random_problems -- 10000                      problems 0 to 9,999 of seed 1
//!     cargo bench --bench random_problems -- 300000 --state FILE        goes on where FILE ends, and writes it after every block
//!     cargo bench --bench random_problems -- --only 4711                one problem, word by word
//!     cargo bench --bench random_problems -- 10000 --portable           by this processor's kernels and by plain Rust
//!
//! Further: `--seed N` (1), `--threads N` (1), `--seconds S` (stops after the block that passes them), `--contacts N` at least
//! with `--portable`. A problem is a function of the seed and its number, so threads, blocks and interruptions change nothing.

mod builds;
mod problems;
mod state;
mod tally;

use std::time::{Duration, Instant};

use palpate::fit::{Method, fit_contacts};
use problems::draw::draw;
use problems::judge::{judge, outcome};
use state::State;
use tally::{Tally, table};

/// Problems between two writings of the state.
const BLOCK: u64 = 500;

/// What the command line says.
struct Wishes {
    count: u64,
    seed: u64,
    threads: u64,
    seconds: f64,
    only: Option<u64>,
    state: Option<std::path::PathBuf>,
    portable: bool,
    contacts: usize,
}

fn main() {
    let wishes = wishes();
    if wishes.portable {
        return builds::compare(wishes.seed, wishes.count, wishes.contacts);
    }
    if let Some(number) = wishes.only {
        return show(wishes.seed, number);
    }
    let mut state = State::open(wishes.state.as_deref(), wishes.seed);
    let begin = Instant::now();
    while state.next < wishes.count && begin.elapsed() < Duration::from_secs_f64(wishes.seconds) {
        let blocks = (wishes.count - state.next).div_ceil(BLOCK).min(wishes.threads);
        let numbers = |b: u64| state.next + b * BLOCK..(state.next + (b + 1) * BLOCK).min(wishes.count);
        let parts: Vec<(Tally, f64)> = std::thread::scope(|scope| {
            let running: Vec<_> = (0..blocks).map(|b| scope.spawn(move || run(wishes.seed, numbers(b)))).collect();
            running.into_iter().map(|part| part.join().expect("a problem panicked")).collect()
        });
        state.next = (state.next + blocks * BLOCK).min(wishes.count);
        for (part, seconds) in parts {
            part.exceptions.iter().for_each(|e| eprintln!("{} ({}): {}", e.number, e.attempt, e.words));
            state.tally.merge(part);
            state.seconds += seconds;
        }
        state.save();
    }
    println!("seed {}, problems 0 to {}\n{}", wishes.seed, state.next.saturating_sub(1), table(&state.tally));
    println!("thread time {:.0} s, {:.2} ms a problem", state.seconds, 1e3 * state.seconds / state.next.max(1) as f64);
}

/// The problems of these numbers, and the seconds of this thread that they took.
fn run(seed: u64, numbers: std::ops::Range<u64>) -> (Tally, f64) {
    let (begin, mut tally) = (Instant::now(), Tally::default());
    numbers.filter_map(|number| judge(seed, number)).for_each(|judged| tally.add(judged));
    (tally, begin.elapsed().as_secs_f64())
}

/// One problem in words.
fn show(seed: u64, number: u64) {
    let Some(judged) = judge(seed, number) else { return println!("no problem of full rank") };
    let problem = draw(seed, number, judged.redrawn);
    println!("{:#?}\n{:?}\n{:#?}", problem.options, problem.contacts.weights, judged);
    match fit_contacts(&problem.contacts, &problem.options) {
        Ok(fit) => {
            println!("{:#?}\n{:?}", fit.certificate(), fit.notes());
            // where the fit has found its weights and its smoothing, the other methods must find the same
            for method in [Method::Cholesky, Method::Qr] {
                let fit = fit_contacts(&problem.contacts, &problem.options.clone().with_method(method));
                println!("{method:?}: {:?}", outcome(&problem, &fit));
            }
        }
        Err(error) => println!("{error}"),
    }
}

fn wishes() -> Wishes {
    let mut wishes = Wishes {
        count: 10_000,
        seed: 1,
        threads: 1,
        seconds: f64::INFINITY,
        only: None,
        state: None,
        portable: false,
        contacts: 0,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = || words.next().and_then(|v| v.parse::<f64>().ok());
        match word.as_str() {
            "--seed" => wishes.seed = number().map_or(1, |v| v as u64),
            "--threads" => wishes.threads = number().map_or(1, |v| v.max(1.0) as u64),
            "--seconds" => wishes.seconds = number().unwrap_or(f64::INFINITY),
            "--only" => wishes.only = number().map(|v| v as u64),
            "--portable" => wishes.portable = true,
            "--contacts" => wishes.contacts = number().map_or(0, |v| v as usize),
            "--state" => wishes.state = words.next().map(Into::into),
            word => wishes.count = word.parse().unwrap_or(wishes.count),
        }
    }
    // no Duration holds infinity
    wishes.seconds = wishes.seconds.min(1e9);
    wishes
}
