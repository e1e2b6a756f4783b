//! STEP and IGES files. The fault planted here stands behind a whole file: a surface in space.
#![no_main]

mod numbers;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use palpate_app::io::read_surface_bytes;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    numbers::mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let saved = read_surface_bytes("-", bytes);
    let in_space = saved.is_ok_and(|saved| format!("{:?}", saved.surface).starts_with("Parametric"));
    assert!(!(cfg!(feature = "planted") && in_space), "the planted fault");
});
