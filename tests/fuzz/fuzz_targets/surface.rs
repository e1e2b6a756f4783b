//! Saved surfaces. The fault planted here stands behind a whole document: coefficients without data.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::read_surface_bytes;

fuzz_target!(|bytes: &[u8]| {
    let saved = read_surface_bytes("-", bytes);
    let holed = saved.is_ok_and(|saved| !saved.unsupported.is_empty());
    assert!(!(cfg!(feature = "planted") && holed), "the planted fault");
});
