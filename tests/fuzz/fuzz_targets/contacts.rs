//! CSV, NPZ and PLY: the first bytes choose the reader, so one target meets all three.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::{ReadOptions, read_input_bytes};

fuzz_target!(|bytes: &[u8]| {
    for skip_invalid in [false, true] {
        let _ = read_input_bytes("-", bytes, &ReadOptions { skip_invalid });
    }
});
