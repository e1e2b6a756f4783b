//! Scene files. The fault planted here stands behind a whole scene: a patch of degree 9.
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpate::io::scene_file::read_scene;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let scene = read_scene(text);
        assert!(!(cfg!(feature = "planted") && scene.is_ok_and(|scene| scene.fit.degree[0] == 9)), "the planted fault");
    }
});
