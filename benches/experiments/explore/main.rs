//! What planned touches gain, each question by one word.
//!
//!     cargo bench --bench explore -- contacts [OBJECTS NOISES [FIRST]]

mod contacts;
mod objects;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let numbers: Vec<u64> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let number = |k: usize, otherwise: u64| numbers.get(k).copied().unwrap_or(otherwise);
    let asked = |word: &str| words.iter().any(|w| w == word);
    if asked("contacts") {
        contacts::print(number(2, objects::UNSEEN), number(0, 60), number(1, 2));
    }
}
