//! A shape grid of any size is computed soon, or refused with the number that is allowed.

use std::path::Path;

use assert_cmd::Command;

const BAR: &str = "name = \"a bar\"\nseed = 4\n[surface]\nkind = \"cylinder\"\nradius = 25.0\n[sweep]\nfingers = [-6.0, 0.0, 6.0]\n\
                   from = -6.0\nto = 6.0\nstations = 5\n[effects.position_noise]\nsigma = 0.05\n";

fn palpate(here: &Path, line: &str) -> (Option<i32>, String, String) {
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(here).args(line.split_whitespace()).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_grid_that_costs_too_much_is_refused_with_the_number_that_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("bar.toml"), BAR).unwrap();
    assert_eq!(palpate(here, "simulate bar.toml -o bar.csv").0, Some(0));
    for (line, said) in [
        ("study bar.toml --replicates 2 --grid 400x251", "10^5"),
        ("study bar.toml --replicates 2 --grid 2000x2000 --path whole", "10^5"),
        ("study bar.toml --replicates 2 --grid 1000x1000 --coverage", "10^5"),
        ("fit bar.csv --grid 1000x1001", "10^6"),
    ] {
        let (code, out, message) = palpate(here, line);
        assert_eq!(code, Some(2), "{line}: {out} {message}");
        assert!(message.contains(said) && message.contains("grid"), "{line}: {message}");
    }
    let (code, out, message) = palpate(here, "fit bar.csv --degree 2 --grid 1000x1001 --bare --json");
    assert_eq!(code, Some(0), "{message}");
    assert!(out.contains("\"class\": \"ridge\""), "{out}");
}

/// The shares of the effects take thousands of replicates over a small grid, and fewer over a large one unless they are asked for.
#[test]
fn shares_of_effects_cost_no_more_over_a_large_grid() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("bar.toml"), BAR).unwrap();
    let replicates = |options: &str| {
        let (code, out, message) = palpate(here, &format!("study bar.toml --replicates 2 --json {options}"));
        assert_eq!(code, Some(0), "{message}");
        let document: serde_json::Value = serde_json::from_str(&out).unwrap();
        document["effects_replicates"].as_u64().unwrap()
    };
    assert_eq!([replicates("--grid 4"), replicates("--grid 300x300")], [8_000, 768]);
    assert_eq!(replicates("--grid 100x100 --attribution 96"), 96);
}
