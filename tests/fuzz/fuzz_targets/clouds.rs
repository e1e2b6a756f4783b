//! Point clouds, meshes, tables without names and depth images. The first byte chooses the file's ending, because some of
//! these formats have no first bytes of their own. The fault planted here is a cloud whose first and last point are one.
#![no_main]

mod numbers;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use palpate_app::io::{Input, ReadOptions, Reading, read_input_bytes};

const NAMES: [&str; 8] = ["a.xyz", "a.pts", "a.pcd", "a.off", "a.obj", "a.stl", "a.npy", "a.png"];

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    numbers::mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let Some((first, rest)) = bytes.split_first() else { return };
    let name = NAMES[usize::from(*first) % NAMES.len()];
    for camera in [None, "600,600,320,240".parse().ok()] {
        let read = read_input_bytes(name, rest, &ReadOptions { intrinsics: camera, ..ReadOptions::default() });
        if cfg!(feature = "planted")
            && let Ok(Reading { input: Input::Contacts(contacts), .. }) = read
        {
            let place = |r: usize| [contacts.x[r], contacts.y[r], contacts.z[r]];
            let last = contacts.len().saturating_sub(1);
            assert!(last == 0 || place(0) != place(last), "the planted fault");
        }
    }
});
