//! The README types: its commands are run and print what it shows, its table of trust quotes what is printed, its table of
//! speeds is the one that the newest recorded run makes. COMPARE.md quotes recorded tables and code that is run.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const WORKLOADS: [(&str, &str); 7] = [
    ("w1", "36 contacts, 9 unknowns: fit, S and R on 8 x 8"),
    ("w2", "200,000 contacts, 4,489 unknowns: fit"),
    ("w2l", "1,000,000 contacts, 17,161 unknowns: fit"),
    ("w3_cold", "640 x 480 heights and slopes, 83 x 63 unknowns: plan and fit"),
    ("w3_reused", "the same, the plan at hand"),
    ("w4", "100,000 noise replicates of the first row"),
    ("w5", "S and R on 1000 x 1000 points, 64 x 64 segments"),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The runs of `benches/peers/compare.py` are the JSON files. Dates stand first in their names; where two runs are of one
/// day, the one of the later commit is recorded over the other.
fn newest_run() -> PathBuf {
    let runs = std::fs::read_dir(root().join("benches/runs")).unwrap().map(|entry| entry.unwrap().path());
    runs.filter(|path| path.extension().is_some_and(|e| e == "json")).max().unwrap()
}

fn document(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap()
}

/// Fenced blocks as (language, text), in order.
fn blocks(document: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in document.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some(language), None) => open = Some((language.to_string(), String::new())),
            (None, Some((_, text))) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    found
}

/// What `palpate ARGUMENTS` prints in a folder.
fn printed(arguments: &str, folder: &Path) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    let output = command.args(arguments.split_whitespace()).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "palpate {arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Figures that are a rounding error (below 1e-14) or count its digits depend on the processor's instructions.
fn same_figure(found: &str, shown: &str, line: &str) -> bool {
    let number = |word: &str| word.trim_end_matches(',').parse::<f64>().ok();
    match (number(found), number(shown)) {
        (Some(a), Some(b)) if line.starts_with("digits") => (a - b).abs() <= 1.0,
        (Some(a), Some(b)) if line.starts_with("numbers") || line.starts_with("rms") => {
            found == shown || a.max(b) < 1e-14
        }
        _ => found == shown,
    }
}

fn assert_same_output(found: &str, shown: &str, command: &str) {
    assert_eq!(found.lines().count(), shown.lines().count(), "palpate {command}:\n{found}");
    for (a, b) in found.lines().zip(shown.lines()) {
        let (words, other) = (a.split_whitespace(), b.split_whitespace());
        assert_eq!(words.clone().count(), other.clone().count(), "palpate {command}: {a}");
        for (one, two) in words.zip(other) {
            assert!(same_figure(one, two, b), "palpate {command} prints\n{a}\nand the README\n{b}");
        }
    }
}

/// Everything a newcomer types, in an empty folder: a `toml` block is saved under its name, a `sh` block is run, and a `text`
/// block behind it is its output.
#[test]
fn the_readme_types() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = blocks(&document("README.md"));
    let mut runs = 0;
    for (k, (language, text)) in blocks.iter().enumerate() {
        if language == "toml" {
            std::fs::write(folder.path().join("bar.toml"), text).unwrap();
        }
        for command in text.lines().filter_map(|line| line.strip_prefix("palpate ")).filter(|_| language == "sh") {
            let output = printed(command, folder.path());
            assert_eq!(blocks[k + 1].0, "text", "palpate {command} has no output behind it");
            assert_same_output(&output, &blocks[k + 1].1, command);
            runs += 1;
        }
    }
    assert!(runs >= 2, "{runs} commands found");
}

/// Bold figures of a table row whose first cell is a command or a file in backticks stand in what it prints or holds.
fn check_bold_figures(name: &str, least: usize) {
    let folder = tempfile::tempdir().unwrap();
    let text = document(name);
    let mut checked = 0;
    for line in text.lines() {
        let Some((source, words)) = line.strip_prefix("| `").and_then(|rest| rest.split_once("` | ")) else { continue };
        let held = match source.strip_prefix("palpate ") {
            Some(arguments) => printed(arguments, folder.path()),
            None if source.starts_with("benches/runs/") => document(source),
            None => continue,
        };
        for figure in words.split("**").skip(1).step_by(2) {
            assert!(held.contains(figure), "{figure} is not in what `{source}` gives:\n{held}");
            checked += 1;
        }
    }
    assert!(checked >= least, "{name}: {checked} bold figures found");
}

#[test]
fn the_table_of_trust_quotes_what_is_printed() {
    check_bold_figures("README.md", 10);
    check_bold_figures("benches/runs/poor-normals.md", 18);
}

#[test]
fn documents_stay_short() {
    let text = document("README.md");
    assert!(text.lines().count() < 180 && text.len() < 10_000);
    assert!(document("DESIGN.md").len() < 28_000);
    assert!(document("CHANGELOG.md").len() < 4_000);
}

/// COMPARE.md's table is the recorded one, and the code of the other tools in it is code that the comparer runs.
#[test]
fn the_comparison_is_the_recorded_one() {
    let rows = document("benches/runs/tools.md");
    let rows: String = rows.lines().filter(|line| line.starts_with('|')).map(|line| format!("{line}\n")).collect();
    check_table("COMPARE.md", "tools", &rows);
    let compare = document("COMPARE.md");
    let code: Vec<String> = ["compare.py", "torus.py", "mgcv.R", "jet.cpp"]
        .iter()
        .flat_map(|file| {
            document(&format!("benches/peers/tools/{file}")).lines().map(|l| l.trim().to_string()).collect::<Vec<_>>()
        })
        .collect();
    let theirs = ["python", "r", "cpp"];
    let mut lines = 0;
    for (_, text) in blocks(&compare).iter().filter(|(language, _)| theirs.contains(&language.as_str())) {
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            assert!(code.iter().any(|known| known == line), "no tool runs: {line}");
            lines += 1;
        }
    }
    assert!(lines > 30, "{lines} lines of code found");
}

fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "us"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    if value < 10.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

/// The peers of one thread: `[hand-written C++, best of the usual tools]` as ratios, and palpate's median time.
fn row(run: &Value, work: &str, what: &str) -> String {
    let results = run["results"].as_array().unwrap().iter().filter(|r| r["work"] == work && r["threads"] == 1);
    let (mut cpp, mut usual, mut median) = (None, f64::NEG_INFINITY, f64::INFINITY);
    for r in results {
        let ratio = r["ratio"]["median"].as_f64().unwrap();
        median = median.min(r["palpate"]["median"].as_f64().unwrap());
        if r["peer"] == "cpp" {
            cpp = Some(ratio);
        } else {
            usual = usual.max(ratio);
        }
    }
    let scaling = run["scaling"].as_array().into_iter().flatten().find(|s| s["work"] == work);
    let faster = scaling.map_or("-".into(), |s| format!("{:.2}", s["ratio"]["median"].as_f64().unwrap()));
    let cpp = cpp.map_or("-".into(), |ratio| format!("{ratio:.2}"));
    format!("| {what} | {} | {cpp} | {usual:.2} | {faster} |\n", time(median))
}

fn table() -> String {
    let path = newest_run();
    let run: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let name = path.file_stem().unwrap().to_str().unwrap().to_string();
    let mut out = String::from(
        "| one thread | median | time over hand-written C++ | over NumPy, SciPy or FITPACK | two threads, times faster |\n\
         |---|---|---|---|---|\n",
    );
    WORKLOADS.iter().for_each(|(work, what)| out += &row(&run, work, what));
    out + &format!("\n(`benches/runs/{name}.md`, commit {})\n", run["about"]["commit"].as_str().unwrap())
}

/// The text between the marks `<!-- NAME -->` and `<!-- /NAME -->` is the table.
/// `PALPATE_WRITE_README=1 cargo test --test house readme` writes it anew.
fn check_table(file: &str, name: &str, table: &str) {
    let text = document(file);
    let (before, rest) = text.split_once(&format!("<!-- {name} -->\n")).unwrap();
    let (found, after) = rest.split_once(&format!("<!-- /{name} -->")).unwrap();
    if std::env::var_os("PALPATE_WRITE_README").is_some() {
        let text = format!("{before}<!-- {name} -->\n{table}<!-- /{name} -->{after}");
        std::fs::write(root().join(file), text).unwrap();
    } else {
        assert_eq!(found, table);
    }
}

#[test]
fn the_table_of_speeds_is_the_newest_run() {
    check_table("README.md", "speeds", &table());
}
