//! Saved surfaces.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::read_surface_bytes;

fuzz_target!(|bytes: &[u8]| {
    let _ = read_surface_bytes("-", bytes);
});
