//! `palpate fit` of several files: a row of each, failures in their rows, and the others go on.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn palpate(here: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn contacts(here: &Path) {
    for (scene, file) in [("paper-cylinder", "bar.csv"), ("paper-plane", "table, flat.csv")] {
        assert_eq!(palpate(here, &["simulate", scene, "-o", file, "--quiet"]).0, 0);
    }
    std::fs::write(here.join("bad.csv"), "x,y,z\n1,2,three\n").unwrap();
}

#[test]
fn every_file_has_its_row_and_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    contacts(here);
    let (code, lines, message) = palpate(here, &["fit", "bar.csv", "table, flat.csv", "--table", "out.csv"]);
    assert_eq!((code, message.as_str()), (0, ""));
    assert_eq!(lines.lines().count(), 2);
    assert!(lines.contains("bar.csv") && lines.contains("ridge") && lines.contains("plane"), "{lines}");
    let table = std::fs::read_to_string(here.join("out.csv")).unwrap();
    assert!(
        table
            .starts_with("file,contacts,class,S,u_S,lo_S,hi_S,R,u_R,lo_R,hi_R,radius,p_cup,p_trough,p_rut,p_saddle_rut,p_saddle,p_saddle_ridge,p_ridge,p_dome,p_cap,p_plane,notes,error\nbar.csv,36,ridge,0.")
    );
    assert!(table.lines().nth(2).unwrap().starts_with("\"table, flat.csv\",36,plane,,,,,"), "{table}");
    // the numbers are those of each file alone
    let (_, alone, _) = palpate(here, &["fit", "bar.csv", "--json"]);
    let alone: Value = serde_json::from_str(&alone).unwrap();
    let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(row[3].parse::<f64>().ok(), alone["shape"]["S"]["mean"].as_f64());
    assert_eq!(row[10].parse::<f64>().ok(), alone["shape"]["R"]["interval"][1].as_f64());
}

#[test]
fn a_failure_stands_in_its_row_and_the_others_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    contacts(here);
    let inputs = ["fit", "bad.csv", "missing.csv", "bar.csv"];
    let (code, lines, message) = palpate(here, &[&inputs[..], &["--table", "out.csv"]].concat());
    assert_eq!(code, 2);
    assert!(message.contains("2 of 3 files have no answer"), "{message}");
    assert!(lines.lines().next().unwrap().contains("no answer: line 2, column z"), "{lines}");
    let table = std::fs::read_to_string(here.join("out.csv")).unwrap();
    assert!(
        table.contains("three") && table.contains("missing.csv: cannot be read") && table.contains("ridge"),
        "{table}"
    );
    let (code, json, _) = palpate(here, &[&inputs[..], &["--json"]].concat());
    let document: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((code, document["schema"].as_str()), (2, Some("palpate.fits/1")));
    assert!(document["files"][0]["error"].is_string() && document["files"][2]["error"].is_null());
    assert_eq!(document["files"][2]["class"], "ridge");
}

#[test]
fn what_is_for_one_file_is_refused_for_several() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    contacts(here);
    for (arguments, word) in [
        (&["fit", "bar.csv", "bar.csv", "--save", "s.json"][..], "--save is for one file"),
        (&["fit", "bar.csv", "bar.csv", "--out", "d"], "--out is for one file"),
        (&["fit", "bar.csv", "--table", "bar.csv"], "written over"),
        (&["fit", "bar.csv", "--table", "-", "--json"], "--table -"),
        (&["fit"], "INPUT"),
    ] {
        let (code, _, message) = palpate(here, arguments);
        assert!(code == 2 && message.contains(word), "{arguments:?}: {message}");
    }
    let (code, table, _) = palpate(here, &["fit", "bar.csv", "--table", "-"]);
    assert!(code == 0 && table.starts_with("file,contacts,") && table.lines().count() == 2, "{table}");
}

/// Several things in one file have no one shape: `fit` says what they are, and what holds one surface stays a refusal.
#[test]
fn a_file_of_several_things_is_told_by_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let place = |k: i32, step: f64| 3.0 * (f64::from(k) * step).fract();
    let corner = (1..300).map(|k| (k, place(k, 0.618_034), place(k, 0.754_878)));
    let corner = corner.map(|(k, a, b)| if k % 2 == 0 { format!("{a},{b},0\n") } else { format!("{a},0,{b}\n") });
    std::fs::write(here.join("corner.csv"), "x,y,z\n".to_string() + &corner.collect::<String>()).unwrap();
    let (code, lines, message) = palpate(here, &["fit", "corner.csv"]);
    assert_eq!((code, message.as_str()), (0, ""), "{lines}");
    assert!(lines.starts_with("shape      several things") && lines.matches("plane").count() >= 2, "{lines}");
    assert!(lines.contains("more       palpate parts corner.csv"), "{lines}");
    for holds_one in [&["--json"][..], &["--out", "D"], &["--save", "s.json"]] {
        let (code, _, message) = palpate(here, &[&["fit", "corner.csv"], holds_one].concat());
        assert!(code == 2 && message.contains("several things"), "{holds_one:?}: {message}");
    }
}
