//! Shared work without the harness of tests, for the thread sanitizer; with the word `planted` a race that it must find.

use sanitized::shared;

fn main() {
    if std::env::args().nth(1).is_some_and(|word| word == "planted") {
        return shared::planted();
    }
    shared::every_way_to_share_work_gives_the_same_bits();
    shared::cells_are_summed_alike_again_and_again();
    shared::maps_are_alike_again_and_again();
    println!("shared work: no race found");
}
