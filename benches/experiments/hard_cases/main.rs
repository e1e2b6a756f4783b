//! Prints the hard-case table, S against the radius, and the random problems.
//!
//!     cargo bench --bench hard_cases [-- RANDOM_PROBLEMS]            10,000 without a number
//!     cargo bench --bench hard_cases -- --record                     writes hard-cases.md and radius.md of benches/runs as well

#[path = "../../../tests/golden/mod.rs"]
mod golden;
mod oracle;
mod problems;
mod random;
mod table;

use golden::record;

fn main() {
    let count = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(10_000);
    let recorded = std::env::args().any(|a| a == "--record");
    for (name, title, text) in
        [("hard-cases", "Hard cases", table::table()), ("radius", "S against the radius", golden::radius::table())]
    {
        println!("{text}\n");
        if recorded {
            record::write(name, title, &text);
        }
    }
    problems::print(count);
}
