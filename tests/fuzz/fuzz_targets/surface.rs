//! Saved surfaces. The fault planted here stands behind a whole document: coefficients without data.
#![no_main]

mod numbers;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use palpate_app::io::read_surface_bytes;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    numbers::mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let saved = read_surface_bytes("-", bytes);
    let holed = saved.is_ok_and(|saved| !saved.unsupported.is_empty());
    assert!(!(cfg!(feature = "planted") && holed), "the planted fault");
});
