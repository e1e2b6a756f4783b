//! Random problems against the double-double oracle: how often a promise is broken.

use palpate::fit::{Fit, fit_contacts};
use palpate::internals::cases::{Lcg, digits_absolute, digits_of};

use super::random::{RandomProblem, draw};
use super::table::median;

/// The worst broken promises shown.
const SHOWN: usize = 10;

/// What became of the problems.
#[derive(Default)]
struct Tally {
    refused: usize,
    gaps: usize,
    margins: Vec<f64>,
    each: [Vec<f64>; 3],
    broken: Vec<(f64, String)>,
}

/// Draws `count` problems and prints the exceptions.
pub(crate) fn print(count: usize) {
    let mut lcg = Lcg::new(1);
    let mut tally = Tally::default();
    for number in 0..count {
        let problem = draw(&mut lcg);
        match fit_contacts(&problem.contacts, &problem.options) {
            Err(_) => tally.refused += 1,
            Ok(fit) if !fit.certificate().unsupported.is_empty() => tally.gaps += 1,
            Ok(fit) => compare(number, &problem, &fit, &mut tally),
        }
    }
    println!("{count} random problems of full rank against a QR in 32 digits");
    println!("refused {}, answered with gaps {} (not compared)", tally.refused, tally.gaps);
    println!("guarantees compared {}, broken {}", tally.margins.len(), tally.broken.len());
    let [c, s, r] = &mut tally.each;
    println!(
        "median of found - guaranteed: {:.2} (coefficients {:.2}, S {:.2}, R {:.2})",
        median(&mut tally.margins),
        median(c),
        median(s),
        median(r)
    );
    tally.broken.sort_by(|a, b| a.0.total_cmp(&b.0));
    tally.broken.iter().take(SHOWN).for_each(|(_, line)| println!("    {line}"));
}

fn compare(number: usize, problem: &RandomProblem, fit: &Fit, tally: &mut Tally) {
    let solved = &problem.solved;
    let found: Vec<f64> = fit.input_surface().map(|s| s.coefficients().iter().copied().collect()).unwrap_or_default();
    let promise = fit.certificate().guaranteed_digits;
    let [s, r] = shape_errors(fit, problem);
    let pairs = [
        ("coefficients", digits_of(&found, &solved.coefficients), promise.coefficients),
        ("S", s, promise.shape_index),
        ("R", r, promise.curvedness),
    ];
    for (k, (what, found, promised)) in pairs.into_iter().enumerate() {
        tally.margins.push(found - promised);
        tally.each[k].push(found - promised);
        if promised > found {
            let certificate = fit.certificate();
            let line = format!(
                "problem {number}: {what} promised {promised:.2}, found {found:.2}, condition {:.1e}, {}",
                certificate.condition,
                certificate.method.name()
            );
            tally.broken.push((found - promised, line));
        }
    }
}

fn shape_errors(fit: &Fit, problem: &RandomProblem) -> [f64; 2] {
    let maps = &fit.shape().maps;
    let columns = maps.grid.y.len();
    let mut errors = [0.0_f64; 2];
    for (k, (s, r)) in problem.solved.shape_index.iter().zip(&problem.solved.curvedness).enumerate() {
        let at = (k / columns, k % columns);
        if let Some(found) = maps.shape_index_at(at.0, at.1) {
            errors[0] = errors[0].max((found - s).abs());
            errors[1] = errors[1].max(((maps.curvedness[at] - r) / r).abs());
        }
    }
    errors.map(|e| digits_absolute(e.max(f64::EPSILON / 2.0)))
}
