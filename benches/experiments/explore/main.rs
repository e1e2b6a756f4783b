//! What planned touches gain, each question by one word.
//!
//!     cargo bench --bench explore -- contacts [OBJECTS NOISES [FIRST]] [first=3] [round=3] [only=lattice,lines] [degree2 | degree3 | degree4]
//!     cargo bench --bench explore -- stopping [OBJECTS NOISES [FIRST]] [degree2 | degree3 | degree4]
//!     cargo bench --bench explore -- equal [OBJECTS NOISES [FIRST]]
//!     cargo bench --bench explore -- every [OBJECTS NOISES [FIRST]]
//!     cargo bench --bench explore -- floor [OBJECTS NOISES [FIRST]] [first=3] [round=3]
//!     cargo bench --bench explore -- second [NOISES] | rank | trace OBJECT NOISE | export OBJECTS NOISES FIRST
//!
//! Objects have seeds; those from 1,000,001 on were not looked at before the recorded run (`benches/runs/explore.md`).

mod contacts;
mod equal;
mod every;
mod export;
mod floor;
mod objects;
mod rank;
mod second;
mod stopping;
mod trace;

use palpate::FitOptions;
use palpate::fit::{NormalSigma, Objective};

/// A named model by its word, with the sensor's sds declared; none: the contacts are recognised.
fn model(words: &[String]) -> Option<FitOptions> {
    let degree: usize = words.iter().find_map(|w| w.strip_prefix("degree")?.parse().ok())?;
    let sensor = Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 0.03_f64.to_degrees() });
    Some(FitOptions::default().with_degree(degree).with_objective(sensor))
}

/// A whole number that follows this word, such as `first=3`.
fn size(words: &[String], name: &str, otherwise: usize) -> usize {
    words.iter().find_map(|w| w.strip_prefix(name)?.parse().ok()).unwrap_or(otherwise)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let numbers: Vec<u64> = words.iter().filter_map(|w| w.parse().ok()).collect();
    let number = |k: usize, otherwise: u64| numbers.get(k).copied().unwrap_or(otherwise);
    let asked = |word: &str| words.iter().any(|w| w == word);
    let (objects, noises, first) = (number(0, 60), number(1, 2), number(2, objects::UNSEEN));
    let model = model(&words);
    let protocol = contacts::Protocol { first: size(&words, "first=", 3), round: size(&words, "round=", 3) };
    if asked("trace") {
        trace::print(number(0, 1), number(1, 1), model.as_ref());
    }
    if asked("contacts") {
        let only = words.iter().find_map(|w| w.strip_prefix("only="));
        contacts::print((first, objects, noises), protocol, only, model.as_ref());
    }
    if asked("stopping") {
        stopping::print(first, objects, noises, model.as_ref());
    }
    if asked("equal") {
        equal::print(first, objects, noises);
    }
    if asked("every") {
        every::print(first, objects, noises);
    }
    if asked("floor") {
        floor::print(first, objects, noises, protocol);
    }
    if asked("second") {
        second::print(number(0, 100));
    }
    if asked("rank") {
        rank::print();
    }
    if asked("export") {
        export::print(first, objects, noises);
    }
}
