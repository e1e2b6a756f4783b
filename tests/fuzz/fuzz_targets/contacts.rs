//! CSV, NPZ and PLY: the first bytes choose the reader, so one target meets all three. The fault planted here stands behind
//! a whole table: a contact at a height of exactly 42.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::{Input, ReadOptions, Reading, read_input_bytes};

fuzz_target!(|bytes: &[u8]| {
    for skip_invalid in [false, true] {
        let read = read_input_bytes("-", bytes, &ReadOptions { skip_invalid });
        if cfg!(feature = "planted")
            && let Ok(Reading { input: Input::Contacts(contacts), .. }) = read
        {
            assert!(!contacts.z.contains(&42.0), "the planted fault");
        }
    }
});
