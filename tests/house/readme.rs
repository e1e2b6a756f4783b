//! The README's table of speeds is the one that the newest recorded run makes.

use std::path::{Path, PathBuf};

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

/// Dates stand first in the names; where two runs are of one day, the one of the later commit is recorded over the other.
fn newest_run() -> PathBuf {
    let runs = std::fs::read_dir(root().join("benches/runs")).unwrap().map(|entry| entry.unwrap().path());
    runs.filter(|path| path.extension().is_some_and(|e| e == "json")).max().unwrap()
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

/// `PALPATE_WRITE_README=1 cargo test --test house readme` writes the table anew.
#[test]
fn the_table_of_speeds_is_the_newest_run() {
    let path = root().join("README.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once("<!-- speeds -->\n").unwrap();
    let (found, after) = rest.split_once("<!-- /speeds -->").unwrap();
    let table = table();
    if std::env::var_os("PALPATE_WRITE_README").is_some() {
        std::fs::write(&path, format!("{before}<!-- speeds -->\n{table}<!-- /speeds -->{after}")).unwrap();
        return;
    }
    assert_eq!(found, table);
}
