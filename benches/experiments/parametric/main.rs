//! Surfaces in space: every figure that is told of them, each by one word.
//!
//!     cargo bench --bench parametric [-- table | noise [REPLICATES] | rotations | closed | auto | speed]
//!
//! Without a word all of them. The patch is the paper's: 3 fingers x 9 stations on 8 x 8.

mod auto;
mod closed;
mod noise;
mod rotations;
#[path = "../../../tests/library/parametric/shapes.rs"]
mod shapes;
mod speed;
mod table;
mod worlds;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let asked = |word: &str| words.iter().all(|w| w.parse::<u64>().is_ok()) || words.iter().any(|w| w == word);
    let replicates = words.iter().find_map(|w| w.parse().ok()).unwrap_or(1000);
    if asked("table") {
        table::print();
    }
    if asked("noise") {
        noise::print(replicates);
    }
    if asked("rotations") {
        rotations::print();
    }
    if asked("closed") {
        closed::print();
    }
    if asked("auto") {
        auto::print();
    }
    if asked("speed") {
        speed::print();
    }
}
