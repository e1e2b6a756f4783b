//! Do the intervals hold? The tables of `benches/runs/coverage.md`, made anew.
//!
//!     cargo bench --bench coverage                              32 scenes of the family, 2,000 fits each: hours
//!     cargo bench --bench coverage -- --state FILE              goes on where FILE ends; a line for each finished scene
//!     cargo bench --bench coverage -- --replicates 50 --only sphere --only torus
//!     cargo bench --bench coverage -- --random 600              surfaces drawn at random, a fit each, pooled by their kind
//!
//! Further: `--seed N`, of the family's noise or of the first random surface. A scene is a function of its name and seed, so that
//! interruptions change nothing.
//!
//! ```text
//! inside = intervals that held the truth / intervals printed        width = median half width / (1.96 sd of the oracle)
//! ```
//!
//! The oracle knows the surface's family and the noise (`tests/laboratory/coverage/cramer_rao.rs`).

mod cells;
mod state;
mod table;

use std::path::PathBuf;
use std::time::Instant;

use cells::cell::Cell;
use cells::judged::{Judged, of_family};
use cells::pooled::pooled;
use palpate_laboratory::coverage::RandomSurface;
use state::State;

/// Seed of the family's noise in the record: not used while the recognition was built.
const FAMILY_SEED: u64 = 92_300_001;
/// Seed of the first random surface in the record, likewise.
const RANDOM_SEED: u64 = 90_400_001;
/// Fits of each scene of the family.
const REPLICATES: u64 = 2000;

/// What the command line says.
#[derive(Default)]
struct Wishes {
    replicates: Option<u64>,
    seed: Option<u64>,
    random: Option<u64>,
    only: Vec<String>,
    state: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wishes = wishes()?;
    let mut state = State::open(wishes.state.as_deref());
    if let Some(count) = wishes.random {
        let (first, fits) = (wishes.seed.unwrap_or(RANDOM_SEED), wishes.replicates.unwrap_or(1));
        let mut cells = Vec::new();
        for seed in first..first + count {
            let name = RandomSurface::new(seed).name;
            cells.push(cell(&mut state, &name, seed, fits, || Judged::random(seed))?);
        }
        table::print_pooled(&pooled(&cells));
        return Ok(());
    }
    let (seed, fits) = (wishes.seed.unwrap_or(FAMILY_SEED), wishes.replicates.unwrap_or(REPLICATES));
    let mut cells = Vec::new();
    for (name, judged) in of_family(&wishes.only, seed) {
        cells.push(cell(&mut state, &name, seed, fits, judged)?);
    }
    table::print_family(&cells);
    println!();
    table::print_least(&cells);
    Ok(())
}

/// The cell of a scene: as it stands in the state, or made and kept there.
fn cell(
    state: &mut State,
    name: &str,
    seed: u64,
    fits: u64,
    judged: impl FnOnce() -> Judged,
) -> Result<Cell, Box<dyn std::error::Error>> {
    if let Some(finished) = state.finished(name, seed, fits) {
        return Ok(finished.clone());
    }
    let began = Instant::now();
    let made = Cell::new(&judged(), fits).map_err(|error| format!("{name}: {error}"))?;
    eprintln!("{name}: {:.1} s", began.elapsed().as_secs_f64());
    state.keep(made.clone())?;
    Ok(made)
}

fn wishes() -> Result<Wishes, String> {
    let mut wishes = Wishes::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        // cargo adds it for every bench
        if word == "--bench" {
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
        let number = || value.parse::<u64>().map_err(|error| format!("{word} {value}: {error}"));
        match word.as_str() {
            "--replicates" => wishes.replicates = Some(number()?),
            "--seed" => wishes.seed = Some(number()?),
            "--random" => wishes.random = Some(number()?),
            "--only" => wishes.only.push(value.clone()),
            "--state" => wishes.state = Some(PathBuf::from(&value)),
            _ => return Err(format!("{word} is not known: --replicates, --seed, --random, --only, --state")),
        }
    }
    Ok(wishes)
}
