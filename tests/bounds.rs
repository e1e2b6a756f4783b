//! What a file or a stream of touches may take, counted by the allocator: no clock, so that no machine's load blurs it.
//!
//! ```text
//! bytes asked for while reading  <=  a multiple of the file's size + a constant         also for files that promise more
//! bytes held after a day of touches - bytes held after its first minute  =  0
//! ```
//!
//! A binary of its own, one test, so that nothing else allocates meanwhile.

use std::alloc::System;
use std::io::{Cursor, Write};
use std::path::Path;

use palpate::plans::TouchStream;
use palpate::spline::Knots;
use palpate_app::io::scene_file::read_scene;
use palpate_app::io::{ReadOptions, read_input_bytes, read_surface_bytes};
use palpate_laboratory::hard_cases::Lcg;
use palpate_numeric::bspline::linspace;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// All bytes ever asked for while a file is read, those of buffers that grew and were given back among them: this many times
/// its size, and this many more. An NPZ member may be its hundredfold unpacked, and is copied some times.
const PER_BYTE: usize = 1000;
const FLOOR: usize = 4 << 20;
/// A scene of a few lines may ask for ten million touches, so its bound is that of what it may ask for.
const FLOOR_OF_SCENES: usize = 400 << 20;

/// Bytes asked for by one call.
fn asked(run: impl FnOnce()) -> usize {
    let region = Region::new(COUNTED);
    run();
    let change = region.change();
    change.bytes_allocated + change.bytes_reallocated.max(0) as usize
}

/// The file with a run of digits replaced by a large number, a byte changed, or its end cut off or repeated.
fn hostile(lcg: &mut Lcg, seed: &[u8]) -> Vec<u8> {
    let at = |lcg: &mut Lcg| (lcg.uniform() * seed.len() as f64) as usize;
    let mut bytes = seed.to_vec();
    if seed.is_empty() {
        return bytes;
    }
    match (lcg.uniform() * 5.0) as usize {
        0 => bytes.truncate(at(lcg)),
        1 => {
            let place = at(lcg);
            bytes[place] = (lcg.uniform() * 256.0) as u8;
        }
        2 => {
            // lengths of binary formats
            let place = at(lcg);
            bytes.iter_mut().skip(place).take(4).for_each(|b| *b = 0x7f);
        }
        3 => bytes.extend_from_slice(&seed[at(lcg)..]),
        _ => {
            let place = at(lcg);
            let first = (place..seed.len()).find(|&k| seed[k].is_ascii_digit()).unwrap_or(place);
            let run = seed[first..].iter().take_while(|b| b.is_ascii_digit()).count();
            bytes.splice(first..first + run, *b"4000000000");
        }
    }
    bytes
}

fn read_any(target: &str, bytes: &[u8]) {
    const NAMES: [&str; 8] = ["a.xyz", "a.pts", "a.pcd", "a.off", "a.obj", "a.stl", "a.npy", "a.png"];
    match target {
        "contacts" => drop(read_input_bytes("-", bytes, &ReadOptions::default())),
        "clouds" => {
            let Some((first, rest)) = bytes.split_first() else { return };
            let name = NAMES[usize::from(*first) % NAMES.len()];
            let options = ReadOptions { intrinsics: "600,600,320,240".parse().ok(), ..ReadOptions::default() };
            drop(read_input_bytes(name, rest, &options));
        }
        "scene" => drop(std::str::from_utf8(bytes).map(read_scene)),
        _ => drop(read_surface_bytes("-", bytes)),
    }
}

/// Hostile files of every reader: what is asked for is in proportion to what was given.
fn readers(each: usize) {
    let lcg = &mut Lcg::new(5);
    for target in ["contacts", "clouds", "scene", "surface"] {
        let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds").join(target);
        let floor = if target == "scene" { FLOOR_OF_SCENES } else { FLOOR };
        let (mut worst, mut tried) = (0.0_f64, 0);
        for entry in std::fs::read_dir(seeds).unwrap() {
            let path = entry.unwrap().path();
            let seed = std::fs::read(&path).unwrap();
            for turn in 0..each {
                let bytes = if turn == 0 { seed.clone() } else { hostile(lcg, &seed) };
                let asked = asked(|| read_any(target, &bytes));
                assert!(
                    asked <= PER_BYTE * bytes.len() + floor,
                    "{}: {asked} bytes for {}",
                    path.display(),
                    bytes.len()
                );
                worst = worst.max(asked as f64 / bytes.len().max(1) as f64);
                tried += 1;
            }
        }
        println!("{target}: {tried} files, at most {worst:.0} bytes asked for a byte");
    }
}

/// A file that asks for much of a reader, a word of its refusal, and the most bytes and allocations before that.
type Refused = (&'static str, Vec<u8>, &'static str, [usize; 2]);

fn refused_files() -> [Refused; 3] {
    let elements: String = (0..40_000).map(|k| format!("element e{k} 0\nproperty float x\n")).collect();
    let ply = format!("ply\nformat ascii 1.0\n{elements}end_header\n").into_bytes();
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let mut many = zip::ZipWriter::new(Cursor::new(Vec::new()));
    (0..60_000).for_each(|k| many.start_file(format!("a{k}.npy"), stored).unwrap());
    let mut zeros = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for name in ["x.npy", "y.npy"] {
        zeros.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (16777216,), }\n";
        zeros.write_all(b"\x93NUMPY\x01\x00").unwrap();
        zeros.write_all(&(header.len() as u16).to_le_bytes()).unwrap();
        zeros.write_all(header.as_bytes()).unwrap();
        (0..128).for_each(|_| zeros.write_all(&[0; 1 << 20]).unwrap());
    }
    let [many, zeros] = [many, zeros].map(|archive| archive.finish().unwrap().into_inner());
    // an archive's index is read to know how many members it has: four allocations each
    let of_index = [6 * many.len(), 300_000];
    [
        ("many.ply", ply, "header", [4096, 16]),
        ("many.npz", many, "60000 members", of_index),
        ("zeros.npz", zeros, "hundredfold", [128 << 10, 64]),
    ]
}

/// What a reader refuses, it refuses before it has done what was asked: seconds of work over the elements of a header, gigabytes of
/// zeros.
fn refusals() {
    for (name, bytes, word, most) in refused_files() {
        let mut told = String::new();
        let region = Region::new(COUNTED);
        if let Err(why) = read_input_bytes(name, &bytes, &ReadOptions::default()) {
            told = why.to_string();
        }
        let change = region.change();
        let asked = change.bytes_allocated + change.bytes_reallocated.max(0) as usize;
        let calls = change.allocations + change.reallocations;
        println!("{name}: {} bytes refused after {asked} bytes in {calls} allocations", bytes.len());
        assert!(told.contains(word), "{name}: {told}");
        assert!(asked <= most[0] && calls <= most[1], "{name}: {asked} bytes in {calls} allocations");
    }
}

/// Touches at a thousand a second: after the first minute nothing more is held, and nothing is asked for.
fn stream(touches: usize) {
    let axis = Knots::uniform(2, 1, -1.0, 1.0).unwrap();
    let points = linspace(-0.5, 0.5, 4);
    let mut stream = TouchStream::new([axis.clone(), axis], [0.01, 0.03, 0.03], [&points, &points]).unwrap();
    let lcg = &mut Lcg::new(3);
    let mut push = |stream: &mut TouchStream, count: usize| {
        for k in 0..count {
            let [x, y] = [0, 1].map(|_| 2.0 * lcg.uniform() - 1.0);
            stream.push([x, y], 0.1 * (x * x + y * y), [0.2 * x, 0.2 * y]).unwrap();
            if k % 1000 == 999 {
                stream.shape().unwrap();
            }
        }
    };
    push(&mut stream, 2000);
    let region = Region::new(COUNTED);
    push(&mut stream, touches);
    let change = region.change();
    let held = change.bytes_allocated as isize - change.bytes_deallocated as isize + change.bytes_reallocated;
    assert_eq!((change.allocations, held), (0, 0), "after {touches} touches");
    let shape = stream.shape().unwrap();
    // S of an exact bowl, after so many sums
    assert!(shape[0].mean.is_some_and(|s| (-1.0..-0.9).contains(&s)), "{:?}", shape[0].mean);
    println!("{touches} touches, nothing asked for and nothing held");
}

/// `PALPATE_TEST_MULTIPLIER=864` makes the stream a day of a thousand touches a second.
#[test]
fn files_and_streams_take_no_more_than_their_share() {
    let multiplier: usize = std::env::var("PALPATE_TEST_MULTIPLIER").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    assert!(asked(|| drop(std::hint::black_box(vec![0_u8; 100]))) >= 100, "the counter does not count");
    readers(100 * multiplier.min(100));
    refusals();
    stream(100_000 * multiplier);
}
