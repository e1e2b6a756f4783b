//! `palpate explore` as a user meets it.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

const SCENE: &str = "name = \"bar\"\nseed = 5\n[surface]\nkind = \"cylinder\"\nradius = 9.0\naxis_deg = 30.0\n\
    [sweep]\nfingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 3\n\
    [effects.position_noise]\nsigma = 0.02\n[effects.normal_noise]\nsigma_deg = 1.0\n";

fn palpate(directory: &Path, line: &str) -> Command {
    std::fs::write(directory.join("bar.toml"), SCENE).unwrap();
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(directory).args(line.split_whitespace());
    command
}

fn output(line: &str) -> (String, String, Option<i32>) {
    let directory = tempfile::tempdir().unwrap();
    let output = palpate(directory.path(), line).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code())
}

#[test]
fn a_table_says_what_is_known_after_every_round_and_why_it_ended() {
    let (table, _, code) = output("explore bar.toml --contacts 15");
    assert_eq!(code, Some(0));
    assert!(table.starts_with("explored   bar by shape, seed 5\nmodel      recognised\n"), "{table}");
    let looks: Vec<&str> = table.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())).collect();
    assert_eq!(looks.iter().map(|l| l[..2].trim()).collect::<Vec<_>>(), ["9", "12", "15"], "{table}");
    assert!(table.contains("stopped    budget: all 15 contacts of the budget are made"), "{table}");
    assert!(table.contains("class      ridge"), "{table}");
}

/// A bar that is touched nearly to its edges is a body, which was refused between looks that knew it.
#[test]
fn a_bar_that_is_touched_to_its_edges_is_known_at_every_look() {
    let wide = SCENE.replace("[-4.0, 0.0, 4.0]", "[-8.6, -5.0, 0.0, 5.0, 8.6]");
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("wide.toml"), wide).unwrap();
    let output = palpate(directory.path(), "explore wide.toml --contacts 30 --json").output().unwrap();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = document["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 6);
    for step in steps {
        let r = step["R"]["mean"].as_f64().unwrap();
        assert!((r * 9.0 - 0.5_f64.sqrt()).abs() < 0.02 && step["kind"] == "cylinder", "{step}");
    }
}

#[test]
fn the_document_holds_every_promised_key() {
    let (text, _, _) = output("explore bar.toml --contacts 40 --u-s 0.02 --u-r 0.03 --json");
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (document["schema"].as_str(), document["strategy"].as_str()),
        (Some("palpate.explore/1"), Some("shape"))
    );
    assert_eq!(document["stopped"], "goal", "{document}");
    assert_eq!(document["goal"]["u_S"], 0.02);
    let steps = document["steps"].as_array().unwrap();
    let last = steps.last().unwrap();
    assert_eq!(document["contacts"], last["contacts"]);
    assert!(last["S"]["u"].as_f64().unwrap() <= 0.02 && last["S"]["mean"].is_f64() && last["R"]["u"].is_f64());
    assert_eq!(steps[0]["touched"].as_array().unwrap().len(), 9);
    assert_eq!(steps[1]["touched"][0].as_array().unwrap().len(), 2);
    assert_eq!(document["shape"]["class"], "ridge");
}

#[test]
fn a_directory_gets_contacts_picture_record_and_table() {
    let directory = tempfile::tempdir().unwrap();
    let line = "explore bar.toml --contacts 15 --strategy second-sweep --out out --quiet";
    assert!(palpate(directory.path(), line).output().unwrap().status.success());
    let read = |name: &str| std::fs::read_to_string(directory.path().join("out").join(name)).unwrap();
    assert_eq!(read("contacts.csv").lines().filter(|l| !l.starts_with('#')).count(), 16);
    assert_eq!(read("explore.csv").lines().count(), 4);
    assert!(read("explore.svg").contains("<svg") && read("explore.svg").contains("second-sweep"));
    assert!(read("explore.json").contains("\"steps\""));
    // what it wrote is what a fit reads
    let fit = palpate(directory.path(), "fit out/contacts.csv --json").output().unwrap();
    let fit: Value = serde_json::from_slice(&fit.stdout).unwrap();
    let explored: Value = serde_json::from_str(&read("explore.json")).unwrap();
    assert_eq!(fit["shape"]["S"]["mean"], explored["shape"]["S"]["mean"]);
}

#[test]
fn a_goal_that_noise_forbids_is_said_before_the_budget_is_spent() {
    let (table, _, code) = output("explore bar.toml --contacts 200 --u-s 0.00001 --u-r 0.00001");
    assert_eq!(code, Some(0));
    assert!(table.contains("stopped    noise: with 200 contacts noise alone leaves"), "{table}");
    assert!(table.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())).count() < 5, "{table}");
}

#[test]
fn a_named_model_answers_in_place_of_the_recognition() {
    let (table, _, _) = output("explore bar.toml --contacts 12 --degree 3 --sigma 0.02,1");
    assert!(
        table.contains("model      height field of degree 3 x 3 with 1 x 1 segments; u counts noise alone"),
        "{table}"
    );
}

#[test]
fn bad_usage_and_bad_input_name_the_place_and_the_remedy() {
    let cases = [
        ("explore bar.toml --strategy shap", "a similar value exists: 'shape'"),
        ("explore bar.toml --contacts 9", "allow more by --contacts"),
        ("explore bar.toml --contacts 0", "--contacts"),
        ("explore bar.toml --u-s 0.01", "--u-r"),
        ("explore bar.toml --u-s -1 --u-r 0.1", "a positive number"),
        ("explore bar.toml --reach 50,60,50,60", "no candidate inside reach"),
        ("explore bar.toml --reach 5,1,0,1", "X0 < X1"),
        ("explore around-torus", "path = \"down\""),
        ("explore bar.toml --weights tangent", "preset weights"),
        ("explore bar.toml --surface parametric", "--surface"),
        ("explore nothing.toml", "no such file"),
    ];
    for (line, words) in cases {
        let (out, err, code) = output(line);
        assert_eq!((out.as_str(), code), ("", Some(2)), "{line}: {err}");
        assert!(err.contains(words), "{line}: {err}");
    }
}
