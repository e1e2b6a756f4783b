//! What a newcomer sees first: `palpate run` says the same as `palpate fit` of the same contacts, with the truth in every row.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn told(directory: &Path, line: &str) -> String {
    let mut command = Command::cargo_bin("palpate").unwrap();
    let output = command.current_dir(directory).args(line.split_whitespace()).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The document without what only a clock and a simulated world know.
fn document(directory: &Path, line: &str) -> Value {
    let mut found: Value = serde_json::from_str(&told(directory, line)).unwrap();
    found.as_object_mut().unwrap().retain(|key, _| key != "seconds" && key != "truth");
    found
}

/// The row of a quantity, without its blanks.
fn row(text: &str, label: &str) -> String {
    let line = text.lines().find(|line| line.starts_with(label)).unwrap_or_else(|| panic!("{label}: {text}"));
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_scene_without_a_model_is_recognised_as_its_contacts_are() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let bar = told(here, "scenes bar");
    assert!(!bar.contains("[fit]\n"), "{bar}");
    for (name, fit) in [("bar", ""), ("sparse", "\n[fit]\ngrid = 5\nlevel = 0.9\nsigma_xy = 0.02\n")] {
        std::fs::write(here.join(format!("{name}.toml")), format!("{bar}{fit}")).unwrap();
        told(here, &format!("simulate {name}.toml -o {name}.csv"));
    }
    assert_eq!(document(here, "run bar.toml --json"), document(here, "fit bar.csv --json"));
    assert_eq!(document(here, "run --json"), document(here, "fit bar.csv --json"));
    let model = "--degree 3 --segments 2";
    assert_eq!(document(here, &format!("run {model} --json")), document(here, &format!("fit bar.csv {model} --json")));
    // another grid, another level and known errors of place name no model
    let sparse = document(here, "run sparse.toml --json");
    let of_level = &sparse["shape"]["R"]["level"];
    assert_eq!((&sparse["fit"]["method"], of_level), (&"recognition".into(), &0.9.into()), "{sparse}");
    let refused = Command::cargo_bin("palpate").unwrap().args(["run", "--bare"]).assert().code(2);
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("--degree 2"));
}

#[test]
fn the_truth_stands_in_every_row() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = told(here, "run");
    assert!(text.contains("more than 99 % sure), as in truth\n"), "{text}");
    for (label, truth) in [("radius", " 25.00"), ("axis", " 30.0 deg"), ("S,", " 0.5000"), ("R,", " 0.02828")] {
        assert!(row(&text, label).ends_with(truth), "{label}: {text}");
    }
    // a rut that stands on edge, whose axis has three numbers, and a dome, which has two radii
    let steep = "[surface]\nkind = \"cylinder\"\nradius = 25.0\naxis_deg = 40.0\nconcave = true\nrotation_deg = [0.0, 60.0, 0.0]\n";
    let dome = "[surface]\nkind = \"ellipsoid\"\nsemi_axes = [40.0, 25.0, 25.0]\naxis_deg = 30.0\n";
    let sweep = "[sweep]\nfingers = [-4.0, -2.0, 0.0, 2.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 9\n";
    let noise = "[effects]\nposition_noise = { sigma = 0.001 }\nnormal_noise = { sigma_deg = 0.2 }\n";
    for (name, surface) in [("steep", steep), ("dome", dome)] {
        std::fs::write(here.join(format!("{name}.toml")), format!("{surface}{sweep}{noise}")).unwrap();
    }
    let steep: Value = serde_json::from_str(&told(here, "run steep.toml --json")).unwrap();
    let axis = |part: &str, k: usize| steep[part]["axis"][k].as_f64().unwrap();
    let off = (0..3).map(|k| (axis("shape", k) - axis("truth", k)).abs()).fold(0.0, f64::max);
    assert!(off < 0.02, "{}", steep["truth"]);
    assert_eq!(steep["truth"]["class"], "rut");
    assert!((steep["truth"]["radius"].as_f64().unwrap() - 25.0).abs() < 1e-9);
    let dome: Value = serde_json::from_str(&told(here, "run dome.toml --json")).unwrap();
    let truth = &dome["truth"];
    let along = truth["axis_deg"].as_f64().unwrap();
    assert!(truth["class"] == "dome" && (along - 30.0).abs() < 1.0, "{truth}");
    let radii = [0, 1].map(|k| truth["radii"][k].as_f64().unwrap());
    assert!((radii[0] - 25.0).abs() < 1.0 && radii[1] > 60.0, "{truth}");
}

/// Contacts without noise have none; what a named model leaves is its misfit.
#[test]
fn the_misfit_of_a_named_model_is_not_called_noise() {
    let folder = tempfile::tempdir().unwrap();
    let text = told(folder.path(), "run paper-cylinder");
    assert!(text.contains("\nmisfit     the contacts lie 0.082 off") && !text.contains("\nnoise "), "{text}");
    assert!(row(&text, "radius") == "radius 6.948 6.600 and 6.949 6.600", "{text}");
    assert!(told(folder.path(), "explain misfit").starts_with("misfit"));
    assert!(told(folder.path(), "run").contains("\nnoise      measured points scatter"));
}
