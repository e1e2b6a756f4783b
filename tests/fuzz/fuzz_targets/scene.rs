//! Scene files.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::scene_file::read_scene;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _ = read_scene(text);
    }
});
