//! The same problems by the kernels of this processor and by plain Rust: what is promised, and how far the answers are apart.
//!
//! ```text
//! |c - c'| <= 10^-promised + 10^-promised'        and the same for S and R, where both define them
//! ```
//!
//! Work on 4,096 contacts or fewer takes AVX2 at most, so problems with more are a run of their own (`--contacts 5000`).

use palpate::fit::{Fit, fit_contacts};
use palpate_numeric::simd::Isa;

use crate::problems::draw::{Family, draw_with};

/// Digits by which two promises may differ to be counted.
const PROMISES: [f64; 3] = [0.1, 0.5, 1.0];
/// Smoothing that differs by more is not the same.
const SAME: f64 = 1e-12;

/// What is kept of one answer.
struct Answer {
    family: Family,
    method: String,
    coefficients: Vec<f64>,
    /// S and R at every point, NaN where one of the two answers has none.
    maps: [Vec<f64>; 2],
    promised: [f64; 3],
    /// Found with the fit by a search that stops where a difference is rounding.
    smoothing: f64,
}

/// Counts of two passes over the same problems.
#[derive(Default)]
struct Compared {
    both: u64,
    refused: u64,
    /// Answered by one alone, or by different methods.
    otherwise: Vec<String>,
    broken: Vec<String>,
    /// Answers of another smoothing: another problem.
    smoothed_otherwise: u64,
    /// Promises that differ by less than each of [`PROMISES`].
    same_promise: [u64; 3],
    /// Largest difference of answers that promise more than a digit.
    apart: [f64; 3],
}

/// Prints the table of problems 0 to `count` of this seed with at least so many contacts.
pub(crate) fn compare(seed: u64, count: u64, contacts: usize) {
    let usual: Vec<Option<Answer>> = (0..count).map(|number| answer(seed, number, contacts)).collect();
    let name = Isa::for_work(contacts).name();
    Isa::force_portable();
    let mut found = Compared::default();
    for (number, usual) in usual.iter().enumerate() {
        found.add(number as u64, usual.as_ref(), answer(seed, number as u64, contacts).as_ref());
    }
    let Compared { both, refused, smoothed_otherwise, same_promise, apart: [c, s, r], .. } = found;
    println!("seed {seed}, {count} problems of {contacts} contacts and more, {name} and {}", Isa::active().name());
    println!("answered by both {both}, refused by both {refused}, otherwise {}", found.otherwise.len());
    println!(
        "with another smoothing {smoothed_otherwise}; of the rest promises within {PROMISES:?} digits: {same_promise:?}"
    );
    println!(
        "largest difference of coefficients {c:.1e}, S {s:.1e}, R {r:.1e}; beyond both promises {}",
        found.broken.len()
    );
    found.otherwise.iter().chain(&found.broken).for_each(|line| println!("{line}"));
}

fn answer(seed: u64, number: u64, contacts: usize) -> Option<Answer> {
    let problem = draw_with(seed, number, 0, contacts);
    let fit = fit_contacts(&problem.contacts, &problem.options).ok()?;
    let maps = &fit.shape().maps;
    let [n, m] = problem.options.grid;
    let points = || (0..n).flat_map(move |i| (0..m).map(move |j| (i, j)));
    let s = points().map(|(i, j)| maps.shape_index_at(i, j).unwrap_or(f64::NAN)).collect();
    // a promise is made where S is defined and supported
    let r = |(i, j)| maps.shape_index_at(i, j).map_or(f64::NAN, |_| maps.curvedness[(i, j)]);
    let r = points().map(r).collect();
    Some(Answer {
        family: problem.family,
        method: fit.certificate().method.name().to_string(),
        coefficients: held(&fit),
        maps: [s, r],
        promised: promised(&fit),
        smoothing: fit.smoothing(),
    })
}

/// Coefficients in input units, NaN where they lack data.
fn held(fit: &Fit) -> Vec<f64> {
    let surface = fit.input_surface().expect("an answer is finite");
    let mut c: Vec<f64> = surface.coefficients().iter().copied().collect();
    fit.certificate().unsupported.iter().for_each(|&u| c[u] = f64::NAN);
    c
}

fn promised(fit: &Fit) -> [f64; 3] {
    let promise = fit.certificate();
    [promise.digits_of_coefficients, promise.digits_of_shape_index, promise.digits_of_curvedness]
}

impl Compared {
    fn add(&mut self, number: u64, usual: Option<&Answer>, plain: Option<&Answer>) {
        let (a, b) = match (usual, plain) {
            (Some(a), Some(b)) if a.method == b.method => (a, b),
            (None, None) => return self.refused += 1,
            _ => {
                let word = |answer: Option<&Answer>| answer.map_or("refused".to_string(), |a| a.method.clone());
                return self.otherwise.push(format!("{number}: {} and {}", word(usual), word(plain)));
            }
        };
        self.both += 1;
        if (a.smoothing - b.smoothing).abs() > SAME * a.smoothing.abs() {
            return self.smoothed_otherwise += 1;
        }
        let promise = (0..3).fold(0.0_f64, |most, k| most.max((a.promised[k] - b.promised[k]).abs()));
        for (count, most) in self.same_promise.iter_mut().zip(PROMISES) {
            *count += u64::from(promise < most);
        }
        let largest = a.coefficients.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let apart = [
            most(&a.coefficients, &b.coefficients, |_| largest),
            most(&a.maps[0], &b.maps[0], |_| 1.0),
            most(&a.maps[1], &b.maps[1], f64::abs),
        ];
        for (k, quantity) in ["coefficients", "S", "R"].into_iter().enumerate() {
            let allowed = 10.0_f64.powf(-a.promised[k]) + 10.0_f64.powf(-b.promised[k]);
            if a.promised[k].min(b.promised[k]) > 1.0 {
                self.apart[k] = self.apart[k].max(apart[k]);
            }
            // a promise of no digit is none
            if a.promised[k].min(b.promised[k]) > 0.0 && apart[k] > allowed {
                let name = a.family.name();
                self.broken
                    .push(format!("{number} ({name}): {quantity} {:.1e} apart, {allowed:.1e} allowed", apart[k]));
            }
        }
    }
}

/// Largest difference over a size; places where either has no number are left out.
fn most(a: &[f64], b: &[f64], size: impl Fn(f64) -> f64) -> f64 {
    a.iter().zip(b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs() / size(*a)))
}
