//! Prints the hard-case table. `cargo bench --bench hard_cases [-- RANDOM_PROBLEMS]`

#[path = "../../tests/golden/mod.rs"]
mod golden;
mod oracle;
mod random;

use golden::Golden;
use palpate::bspline::{Knots, linspace};
use palpate::cases::{CaseData, Lcg, digits_of, hard_cases};
use palpate::fit::{Objective, SlopeWeights};

fn main() {
    let count = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(10_000);
    oracle_against_mpmath();
    let mut lcg = Lcg::new(1);
    let begun = std::time::Instant::now();
    for _ in 0..count {
        random::draw(&mut lcg);
    }
    println!("{count} drawn in {:?}", begun.elapsed());
}

/// The double-double oracle on the hard cases with explicit weights, against 80 digits.
fn oracle_against_mpmath() {
    let mut worst = [f64::INFINITY; 2];
    for case in hard_cases() {
        let CaseData::Contacts(contacts) = &case.data else { continue };
        let Objective::Slopes(SlopeWeights::Explicit(weights)) = case.options.objective else { continue };
        let golden = Golden::read(case.name);
        if golden.rank < golden.unknowns || golden.unknowns > 50 || case.name.contains("1e_") {
            continue;
        }
        let [x0, x1, y0, y1] = case.options.domain.unwrap();
        let sides = [(x0, x1), (y0, y1)];
        let knots = [0, 1].map(|k| match &case.options.knots {
            Some(knots) => knots[k].clone(),
            None => {
                let knots = Knots::uniform(case.options.degree[k], case.options.segments[k], sides[k].0, sides[k].1);
                knots.unwrap().as_slice().to_vec()
            }
        });
        let grid = [0, 1].map(|k| linspace(sides[k].0, sides[k].1, case.options.grid[k]));
        let oracle =
            oracle::Problem { contacts, degree: case.options.degree, knots: [&knots[0], &knots[1]], weights };
        let Some(solved) = oracle.solve([&grid[0], &grid[1]]) else {
            println!("oracle: {} refused", case.name);
            continue;
        };
        let reference = golden.coefficients.as_ref().unwrap();
        let c = digits_of(&solved.coefficients, reference);
        let pairs = golden.shape_index.iter().zip(&solved.shape_index);
        let s = pairs.filter_map(|(g, o)| g.map(|g| (g - o).abs())).fold(0.0, f64::max);
        println!("oracle {:30} {c:.2} {:.2e}", case.name, s);
        worst = [worst[0].min(c), worst[1].min(-s.log10())];
    }
    println!("oracle: worst {worst:?}");
}
