//! Prints the hard-case table and S against the radius.
//!
//!     cargo bench --bench hard_cases
//!     cargo bench --bench hard_cases -- --record                     writes hard-cases.md and radius.md of benches/runs as well

#[path = "../../../tests/golden/mod.rs"]
mod golden;
mod table;

use golden::record;

fn main() {
    let recorded = std::env::args().any(|a| a == "--record");
    for (name, title, text) in
        [("hard-cases", "Hard cases", table::table()), ("radius", "S against the radius", golden::radius::table())]
    {
        println!("{text}\n");
        if recorded {
            record::write(name, title, &text);
        }
    }
}
