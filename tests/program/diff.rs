//! `palpate diff`: the same surface or where not, what is refused, and its document.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn palpate(here: &Path, line: &str) -> (i32, String, String) {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn done(here: &Path, line: &str) -> String {
    let (code, out, message) = palpate(here, line);
    assert_eq!(code, 0, "{line}: {message}");
    out
}

/// Contacts on a ridge of radius `radius` with drawn noise, `lift` high.
fn bar(here: &Path, name: &str, seed: u64, radius: f64, lift: f64) {
    let scene = format!(
        "seed = {seed}\n[surface]\nkind = \"cylinder\"\nradius = {radius}\noffset = [0.0, 0.0, {lift:?}]\n\
         [sweep]\nfingers = [-3.0, -1.0, 1.0, 3.0]\nfrom = -4.0\nto = 4.0\nstations = 9\n\
         [effects.position_noise]\nsigma = 0.02\n[effects.normal_noise]\nsigma_deg = 1.0\n"
    );
    std::fs::write(here.join("scene.toml"), scene).unwrap();
    done(here, &format!("simulate scene.toml -o {name}.csv --quiet"));
    done(here, &format!("fit {name}.csv --quiet --save {name}.json"));
}

#[test]
fn the_same_bar_touched_twice_is_the_same_and_another_one_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    bar(here, "a", 1, 10.0, 0.0);
    bar(here, "b", 2, 10.0, 0.0);
    bar(here, "lifted", 3, 10.0, 0.2);
    bar(here, "thinner", 4, 8.0, 0.0);
    let document = |line: &str| -> Value { serde_json::from_str(&done(here, line)).unwrap() };
    let same = document("diff a.json b.json --json");
    assert_eq!((&same["schema"], &same["same"]), (&"palpate.diff/1".into(), &true.into()), "{same}");
    assert!(done(here, "diff a.json b.json").contains("the same surface within what the data tell"));
    let lifted = document("diff a.json lifted.json --json");
    assert_eq!(lifted["same"], false);
    let height = &lifted["differences"]["height"];
    assert!(
        (height["mean"].as_f64().unwrap() - 0.2).abs() < 0.02 && height["beyond"].as_u64().unwrap() > 300,
        "{height}"
    );
    assert_eq!(lifted["differences"]["R"]["beyond"], 0);
    let thinner = done(here, "diff a.json thinner.json");
    assert!(thinner.contains("not the same surface") && thinner.contains("R differs most at ("), "{thinner}");
    // a surface is itself
    let itself = document("diff a.json a.json --json");
    assert_eq!(itself["differences"]["height"]["largest"].as_f64(), Some(0.0));
}

#[test]
fn cad_files_are_compared_with_what_the_other_one_knows() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    bar(here, "a", 1, 10.0, 0.0);
    done(here, "show a.json --save a.step --quiet");
    let text = done(here, "diff a.json a.step");
    assert!(text.contains("a.step carries no uncertainties") && text.contains("the same surface"), "{text}");
    let text = done(here, "diff a.step a.step");
    assert!(text.contains("no verdict"), "{text}");
    let folder = here.join("d");
    done(here, "diff a.json a.step --out d --quiet");
    for name in ["diff.json", "diff.csv", "diff.svg"] {
        assert!(folder.join(name).exists(), "{name}");
    }
    let rows = std::fs::read_to_string(folder.join("diff.csv")).unwrap();
    assert!(rows.starts_with("x,y,z,height,normal_deg,S,R,u_height") && rows.lines().count() > 300);
    assert!(std::fs::metadata(folder.join("diff.svg")).unwrap().len() < 200_000);
}

/// A height field and a surface in space are compared along normals; a plane has no S to compare.
#[test]
fn other_kinds_are_compared_along_normals() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(here, "run paper-table2 --quiet --save a.json");
    done(here, "run paper-table2 --surface parametric --quiet --save b.json");
    for line in ["diff a.json b.json", "diff b.json a.json"] {
        let text = done(here, line);
        assert!(text.contains("distances along the normals of A"), "{text}");
    }
    done(here, "run paper-plane --quiet --save p.json");
    let document: Value = serde_json::from_str(&done(here, "diff p.json p.json --json")).unwrap();
    assert_eq!(document["same"], true);
}

#[test]
fn what_cannot_be_compared_is_refused_in_plain_words() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    bar(here, "a", 1, 10.0, 0.0);
    let shifted = std::fs::read_to_string(here.join("a.csv")).unwrap();
    let rows: Vec<String> = shifted
        .lines()
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            match fields[0].parse::<f64>() {
                Ok(x) => format!("{},{}", 100.0 + x, fields[1..].join(",")),
                Err(_) => line.to_string(),
            }
        })
        .collect();
    std::fs::write(here.join("far.csv"), rows.join("\n") + "\n").unwrap();
    done(here, "fit far.csv --quiet --save far.json");
    let refused = |line: &str, words: &[&str]| {
        let (code, _, message) = palpate(here, line);
        assert_eq!(code, 2, "{line}: {message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{line}: {word} is not in {message}"));
    };
    refused("diff a.json far.json", &["no part in common", "A lies in x", "frames"]);
    refused("diff a.json a.csv", &["a.csv", "not a saved surface"]);
    refused("diff a.json nothing.json", &["nothing.json", "cannot be read"]);
    refused("diff a.json a.json --grid 1", &["--grid"]);
    refused("diff a.json a.json --grid 100000x100000", &["--grid"]);
    refused("diff - -", &["standard input"]);
    let millimetres = std::fs::read_to_string(here.join("a.json")).unwrap();
    std::fs::write(here.join("bad.json"), millimetres.replace("\"normal_deg\": [", "\"normal_deg\": [ 1,")).unwrap();
    refused("diff a.json bad.json", &["bad.json"]);
}
