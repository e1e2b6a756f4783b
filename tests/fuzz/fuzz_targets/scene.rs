//! Scene files. The fault planted here stands behind a whole scene: a patch of several segments.
#![no_main]

mod numbers;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use palpate_app::io::scene_file::read_scene;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    numbers::mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let scene = read_scene(text);
        assert!(
            !(cfg!(feature = "planted") && scene.is_ok_and(|scene| scene.fit.segments[0] > 1)),
            "the planted fault"
        );
    }
});
