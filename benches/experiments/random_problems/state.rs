//! How far a long run has come, in a file that is replaced as a whole.
//!
//! ```text
//! "random problems" VERSION seed next seconds
//! counts, margins, exceptions                      tally::to_text
//! ```

use std::path::{Path, PathBuf};

use crate::tally::{Tally, from_text, to_text};

/// Counts of other generators must not be mixed: raised whenever a seed and a number give another problem.
const VERSION: u64 = 1;

/// A run so far.
pub(crate) struct State {
    path: Option<PathBuf>,
    seed: u64,
    /// The first number that has not been judged.
    pub next: u64,
    /// Seconds of all threads.
    pub seconds: f64,
    pub tally: Tally,
}

impl State {
    /// Reads the file if there is one. A file of another seed or version is refused rather than written over.
    pub(crate) fn open(path: Option<&Path>, seed: u64) -> State {
        let fresh = State { path: path.map(Path::to_path_buf), seed, next: 0, seconds: 0.0, tally: Tally::default() };
        let Some(text) = path.and_then(|path| std::fs::read_to_string(path).ok()) else { return fresh };
        match read(&text, seed) {
            Some((next, seconds, tally)) => State { next, seconds, tally, ..fresh },
            None => panic!("the state file is not of seed {seed} and version {VERSION}: name another"),
        }
    }

    /// Writes a new file beside the old one and puts it in its place.
    pub(crate) fn save(&self) {
        let Some(path) = &self.path else { return };
        let text = format!(
            "random-problems {VERSION} {} {} {}\n{}\n",
            self.seed,
            self.next,
            self.seconds,
            to_text(&self.tally)
        );
        let beside = path.with_extension("new");
        std::fs::write(&beside, text).expect("the state can be written");
        std::fs::rename(&beside, path).expect("the state can be replaced");
    }
}

fn read(text: &str, seed: u64) -> Option<(u64, f64, Tally)> {
    let mut lines = text.lines();
    let words: Vec<&str> = lines.next()?.split(' ').collect();
    let ["random-problems", version, of_seed, next, seconds] = words[..] else { return None };
    if version.parse() != Ok(VERSION) || of_seed.parse() != Ok(seed) {
        return None;
    }
    Some((next.parse().ok()?, seconds.parse().ok()?, from_text(lines)?))
}
