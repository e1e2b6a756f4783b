//! CSV, NPZ and PLY: the first bytes choose the reader, so one target meets all three. The fault planted here stands behind
//! a whole table: its first and last contact in one place.
#![no_main]

mod numbers;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use palpate_app::io::{Input, ReadOptions, Reading, read_input_bytes};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    numbers::mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    for skip_invalid in [false, true] {
        let read = read_input_bytes("-", bytes, &ReadOptions { skip_invalid, ..ReadOptions::default() });
        if cfg!(feature = "planted")
            && let Ok(Reading { input: Input::Contacts(contacts), .. }) = read
        {
            let place = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
            let last = contacts.len().saturating_sub(1);
            assert!(last == 0 || place(0) != place(last), "the planted fault");
        }
    }
});
