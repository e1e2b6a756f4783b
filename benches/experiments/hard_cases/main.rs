//! Prints the hard-case table, S against the radius, and the random problems.
//!
//!     cargo bench --bench hard_cases [-- RANDOM_PROBLEMS]            10,000 without a number

#[path = "../../../tests/golden/mod.rs"]
mod golden;
mod oracle;
mod problems;
mod radius;
mod random;
mod table;

fn main() {
    let count = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(10_000);
    table::print();
    radius::print();
    problems::print(count);
}
