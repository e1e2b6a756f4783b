//! No option is ignored in silence: each changes what is printed or written, or is refused, or a note says that it changes nothing.
//!
//! ```text
//! every option of every command  x  lines of that command        output(line) != output(line + option), or exit 2
//! ```
//!
//! The options are those that clap knows, so that a new one without a value in [`VALUES`] fails.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use assert_cmd::Command;

use crate::options_table::{
    Context, ELSEWHERE, EXPLORATIONS, FIT, GRIDS_AND_RUNS, LIVES, PARTS, SILENT, STUDIES, VALUES,
};

const BAR: &str = "name = \"a bar\"\nseed = 4\n[surface]\nkind = \"cylinder\"\nradius = 25.0\naxis_deg = 30.0\n[sweep]\n\
    fingers = [-6.0, -3.0, 0.0, 3.0, 6.0]\nfrom = -6.0\nto = 6.0\nstations = 6\n[effects.position_noise]\nsigma = 0.05\n\
    [effects.normal_noise]\nsigma_deg = 3.0\n";

const BOX: &str = "name = \"a box\"\n[surface]\nkind = \"solids\"\n[[surface.parts]]\nkind = \"block\"\nsize = [16.0, 12.0, 10.0]\n\
    [sweep]\npath = \"scan\"\nspacing = 3.0\neye = [50.0, 40.0, 45.0]\n[effects.position_noise]\nsigma = 0.02\n";

/// What one line came to. Documents and pages hold the time that they took, so that their names alone count.
#[derive(PartialEq)]
struct Outcome {
    code: Option<i32>,
    out: String,
    err: String,
    files: BTreeMap<String, Vec<u8>>,
}

/// Without the digits of what a clock changes, and without what only repeats the arguments.
fn steady(text: &[u8]) -> String {
    let timed = |line: &&str| line.contains("second") || line.contains(" a second") || line.contains("weights ");
    let line = |line: &str| match timed(&line) {
        true => line.chars().filter(|c| c.is_alphabetic()).collect(),
        false => line.to_string(),
    };
    let clock =
        ["\"scene_hash\":", "\"read\":", "\"fit\": 0", "\"fit\": 1", "\"shape\": 0", "\"shape\": 1", "\"total\":"];
    let text = String::from_utf8_lossy(text);
    let kept = text.lines().filter(|l| !clock.iter().any(|key| l.trim_start().starts_with(key)));
    kept.map(line).collect::<Vec<_>>().join("\n")
}

fn outcome(base: &Path, line: &str) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let names = |folder: &Path| -> Vec<std::path::PathBuf> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
    };
    let (folders, files): (Vec<_>, Vec<_>) = names(base).into_iter().partition(|path| path.is_dir());
    folders.iter().for_each(|path| std::fs::create_dir(here.join(path.file_name().unwrap())).unwrap());
    for file in files.into_iter().chain(folders.iter().flat_map(|path| names(path))) {
        std::fs::copy(&file, here.join(file.strip_prefix(base).unwrap())).unwrap();
    }
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(here).args(line.split_whitespace()).output().unwrap();
    let mut files = BTreeMap::new();
    for path in names(here).into_iter().flat_map(|path| if path.is_dir() { names(&path) } else { vec![path] }) {
        let name = path.strip_prefix(here).unwrap().display().to_string();
        let timed = [".json", ".html"].iter().any(|ending| name.ends_with(ending));
        files.insert(name, if timed { Vec::new() } else { std::fs::read(&path).unwrap() });
    }
    Outcome { code: output.status.code(), out: steady(&output.stdout), err: steady(&output.stderr), files }
}

/// Long names of the options that people see, but for --help and --portable: the latter changes bits and nothing else.
fn options_of(verb: &str) -> Vec<String> {
    let mut command = palpate_app::cli::command();
    command.build();
    let verb = command.find_subcommand(verb).unwrap();
    let seen = verb.get_arguments().filter(|argument| !argument.is_hide_set());
    let long = seen.filter_map(|argument| argument.get_long().map(|name| format!("--{name}")));
    long.filter(|name| name != "--help" && name != "--portable").collect()
}

/// Tries every option on every line; how many changed the output, and how many were refused.
fn tried(contexts: &[Context]) -> [usize; 2] {
    let folder = workplace();
    let (mut counts, mut silent) = ([0, 0], Vec::new());
    for context in contexts {
        let mut without = BTreeMap::new();
        let tried = |option: &String| !ELSEWHERE.contains(&(context.line, option));
        for option in options_of(context.line.split(' ').next().unwrap()).into_iter().filter(tried) {
            let (line, value) = row(context, &option);
            // a kind of picture is one of --out
            let line = format!("{line}{}", if option == "--pictures" { " --out D" } else { "" });
            let with = outcome(folder.path(), &format!("{line} {option} {value}"));
            match with.code {
                Some(2) if !with.err.is_empty() => counts[1] += 1,
                Some(0) if with != *without.entry(line.clone()).or_insert_with(|| plain(folder.path(), &line)) => {
                    counts[0] += 1;
                }
                Some(0) => silent.push(format!("{line} {option} {value}")),
                code => panic!("{line} {option} {value}: {code:?} {}", with.err),
            }
        }
    }
    assert!(silent.is_empty(), "without a word:\n{}", silent.join("\n"));
    counts
}

/// What a line comes to without the option: always the same, or nothing could be compared.
fn plain(base: &Path, line: &str) -> Outcome {
    let (first, second) = (outcome(base, line), outcome(base, line));
    assert!(first == second, "{line}: no two runs are alike");
    first
}

/// The line on which an option matters, and its value.
fn row<'a>(context: &'a Context, option: &str) -> (&'a str, &'a str) {
    if let Some((_, line, value)) = context.rows.iter().find(|(name, _, _)| *name == option) {
        return (if line.is_empty() { context.line } else { line }, value);
    }
    let value = VALUES.iter().find(|(name, _)| *name == option);
    let (_, value) = value.unwrap_or_else(|| panic!("{option} of {} has no value in VALUES", context.line));
    (context.line, value)
}

/// Contacts, grids, scenes, saved surfaces and parts of a study.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    write("bar.toml", BAR);
    write("lean.toml", &BAR.replace("axis_deg = 30.0", "axis_deg = 30.0\nrotation_deg = [0.0, 55.0, 0.0]"));
    let tiny = BAR.replace("-6.0, -3.0, 0.0, 3.0, 6.0", "-4.0, 0.0, 4.0").replace("stations = 6", "stations = 4");
    write("tiny.toml", &tiny);
    // the study that a coverage takes its quantiles from is quick where no site moves
    let effects = tiny.find("[effects").unwrap();
    let rows = "[effects.row_noise]\nsigma_z = 0.05\nsigma_slope = 0.03\n";
    write("fixed.toml", &format!("{}{rows}", &tiny[..effects]));
    write("box.toml", BOX);
    let simulated = outcome(here, "simulate bar.toml -o -").out + "\n";
    write("bar.csv", &simulated);
    write("bare.csv", &positions(&simulated));
    write("mixed.csv", &mixed(&simulated));
    write("holes.csv", &with_hole(&simulated));
    let corner = corner();
    write("box.csv", &corner);
    std::fs::create_dir(here.join("known")).unwrap();
    write("known/corner.csv", &corner);
    write("boxbare.csv", &positions(&corner));
    write("boxholes.csv", &with_hole(&corner));
    write("lean.csv", &leaning());
    write("at.csv", "x,y\n0.5,0.5\n");
    std::fs::write(here.join("grid.npz"), grid(0.0)).unwrap();
    std::fs::write(here.join("holes.npz"), grid(f64::INFINITY)).unwrap();
    for line in [
        "fit bar.csv --degree 2 --save s.json --quiet",
        "fit bare.csv --degree 3 --save t.json --quiet",
        "live bar.csv --refresh 9 --save live.state --quiet",
        "study bar.toml --replicates 40 --range 0:20 --part p0 --quiet",
        "study bar.toml --replicates 40 --range 20:40 --part p1 --quiet",
    ] {
        let status = Command::cargo_bin("palpate").unwrap().current_dir(here).args(line.split(' ')).ok();
        assert!(status.is_ok(), "{line}");
    }
    folder
}

/// The table with x, y and z alone.
fn positions(table: &str) -> String {
    table.lines().map(|row| row.split(',').take(3).collect::<Vec<_>>().join(",") + "\n").collect()
}

/// The table with its rows in another order: later ones lie between those before.
fn mixed(table: &str) -> String {
    let rows: Vec<&str> = table.lines().collect();
    let count = rows.len() - 1;
    // 7 and the 30 rows of the bar have no divisor in common
    let row = |k: usize| format!("{}\n", rows[1 + 7 * k % count]);
    format!("{}\n", rows[0]) + &(0..count).map(row).collect::<String>()
}

/// The table with a number missing in its third row.
fn with_hole(table: &str) -> String {
    let row = |(k, row): (usize, &str)| match (k, row.split_once(',')) {
        (3, Some((_, rest))) => format!("nan,{rest}\n"),
        _ => format!("{row}\n"),
    };
    table.lines().enumerate().map(row).collect()
}

/// Two faces at right angles, not quite flat.
fn corner() -> String {
    let mut table = "x,y,z,nx,ny,nz\n".to_string();
    for k in 0..36 {
        let (u, v, off) = (2.0 * f64::from(k % 6) - 5.0, 2.0 * f64::from(k / 6) - 5.0, 0.01 * f64::from(k * k % 7 - 3));
        table += &format!("{u},{v},{},0,0,1\n{},{v},{u},1,0,0\n", 6.0 + off, 6.0 + off);
    }
    table
}

/// A bowl that leans by 60 degrees.
fn leaning() -> String {
    let (cosine, sine) = (0.5, 0.75_f64.sqrt());
    let row = |k: i32| {
        let (x, y) = (f64::from(k % 7) - 3.0, f64::from(k / 7) - 3.0);
        let z = 0.04 * (x * x + y * y) + 0.003 * f64::from(k * k % 5 - 2);
        format!("{},{y},{}\n", x * cosine + z * sine, z * cosine - x * sine)
    };
    "x,y,z\n".to_string() + &(0..49).map(row).collect::<String>()
}

/// A grid of 7 by 6 heights of a bowl with slopes; `corner` stands in its first pixel where it is not 0.
fn grid(corner: f64) -> Vec<u8> {
    let axis = |n: usize| (0..n).map(|k| k as f64 - 3.0).collect::<Vec<f64>>();
    let (x, y) = (axis(7), axis(6));
    let map =
        |at: &dyn Fn(f64, f64) -> f64| -> Vec<f64> { x.iter().flat_map(|x| y.iter().map(|y| at(*x, *y))).collect() };
    let mut z = map(&|x, y| 0.05 * x * x + 0.04 * y * y + 0.002 * (5.0 * x + 3.0 * y).sin());
    z[0] += corner;
    let (zx, zy) = (map(&|x, _| 0.1 * x + 0.01 * (3.0 * x).sin()), map(&|_, y| 0.08 * y + 0.01 * (2.0 * y).sin()));
    let mut npz = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let two = "(7, 6)";
    for (name, shape, values) in
        [("x", "(7,)", &x), ("y", "(6,)", &y), ("z", two, &z), ("zx", two, &zx), ("zy", two, &zy)]
    {
        npz.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        npz.write_all(b"\x93NUMPY\x01\x00").unwrap();
        npz.write_all(&(header.len() as u16).to_le_bytes()).unwrap();
        npz.write_all(header.as_bytes()).unwrap();
        values.iter().for_each(|value| npz.write_all(&value.to_le_bytes()).unwrap());
    }
    npz.finish().unwrap().into_inner()
}

/// Tries the lines, and says how many options mattered and how many were refused.
fn all_matter(name: &str, contexts: &[Context]) {
    let [changed, refused] = tried(contexts);
    println!("{name}: {} lines, {changed} options mattered, {refused} were refused", contexts.len());
    assert!(changed > refused / 2);
}

#[test]
fn options_of_fit_matter() {
    all_matter("fit", FIT);
}

#[test]
fn options_of_grids_runs_and_small_commands_matter() {
    all_matter("grids, run, show and others", GRIDS_AND_RUNS);
}

#[test]
fn options_of_parts_matter() {
    all_matter("parts", PARTS);
}

#[test]
fn options_of_live_matter() {
    all_matter("live", LIVES);
}

#[test]
fn options_of_studies_matter() {
    all_matter("study", STUDIES);
}

#[test]
fn options_of_explorations_matter() {
    all_matter("explore, frontier", EXPLORATIONS);
}

#[test]
fn every_command_has_a_line() {
    let contexts = [FIT, GRIDS_AND_RUNS, PARTS, LIVES, STUDIES, EXPLORATIONS].concat();
    let tried = |verb: &str| contexts.iter().any(|context| context.line.split(' ').next() == Some(verb));
    for verb in palpate_app::cli::command().get_subcommands().map(|verb| verb.get_name().to_string()) {
        assert!(tried(&verb), "{verb} has no line");
    }
}

#[test]
fn what_may_stay_silent_does() {
    let folder = workplace();
    for (line, option, why) in SILENT {
        let same = outcome(folder.path(), line) == outcome(folder.path(), &format!("{line} {option}"));
        assert!(same, "{line} {option} matters, although {why}");
    }
}
