//! Every seed of the fuzz targets, and each with bytes changed and cut, through the readers: errors are fine, panics not.

use std::path::Path;

use palpate_app::io::scene_file::read_scene;
use palpate_app::io::{ReadOptions, read_input_bytes, read_surface_bytes};

/// Runs `read` on every seed of `target` and on its mutants; returns how many seeds were read without error.
fn replay(target: &str, read: impl Fn(&[u8]) -> bool) -> usize {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds").join(target);
    let mut sound = 0;
    for entry in std::fs::read_dir(seeds).unwrap() {
        let seed = std::fs::read(entry.unwrap().path()).unwrap();
        sound += usize::from(read(&seed));
        // a fixed walk over the file: the same mutants on every machine
        let step = (seed.len() / 60).max(1);
        for at in (0..seed.len()).step_by(step) {
            read(&seed[..at]);
            for byte in [0, b'-', b'9', b'\n', 0xff] {
                let mut changed = seed.clone();
                changed[at] = byte;
                read(&changed);
            }
        }
    }
    sound
}

#[test]
fn readers_of_contacts() {
    let options = [false, true].map(|skip_invalid| ReadOptions { skip_invalid, ..ReadOptions::default() });
    let sound = replay("contacts", |bytes| options.each_ref().map(|o| read_input_bytes("-", bytes, o).is_ok())[1]);
    // the three formats of the cylinder, the ascii PLY, quotes, slopes, the fewest columns and the grid
    assert_eq!(sound, 8);
}

#[test]
fn readers_of_clouds() {
    const NAMES: [&str; 8] = ["a.xyz", "a.pts", "a.pcd", "a.off", "a.obj", "a.stl", "a.npy", "a.png"];
    let sound = replay("clouds", |bytes| {
        let Some((first, rest)) = bytes.split_first() else { return false };
        let options = ReadOptions { intrinsics: "600,600,320,240".parse().ok(), ..ReadOptions::default() };
        let read =
            |options: &ReadOptions| read_input_bytes(NAMES[usize::from(*first) % NAMES.len()], rest, options).is_ok();
        // all but the image are the same with a camera; the array of rows is then an image too
        read(&ReadOptions::default()) | read(&options)
    });
    assert_eq!(sound, 11);
}

#[test]
fn reader_of_scenes() {
    let sound = replay("scene", |bytes| std::str::from_utf8(bytes).is_ok_and(|text| read_scene(text).is_ok()));
    // the paper's cylinder and the least that makes a scene
    assert_eq!(sound, 2);
}

#[test]
fn readers_of_cad_files() {
    // a height field and a surface in space, each in STEP and in IGES
    assert_eq!(replay("cad", |bytes| read_surface_bytes("-", bytes).is_ok()), 4);
}

#[test]
fn reader_of_surfaces() {
    assert_eq!(replay("surface", |bytes| read_surface_bytes("-", bytes).is_ok()), 3);
}
