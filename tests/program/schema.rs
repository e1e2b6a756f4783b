//! The committed schemas are the ones that the types make, and what the program prints obeys them.

use assert_cmd::Command;
use serde_json::{Value, json};

const FIT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.fit-1.json");
const EXPLORE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.explore-1.json");
const PARTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.parts-1.json");
const DIFF: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.diff-1.json");
const FITS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.fits-1.json");
const STUDY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.study-1.json");
const FRONTIER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/app/report/schema/palpate.frontier-1.json");

/// `PALPATE_WRITE_SCHEMA=1 cargo test --test program schema` writes the files anew.
#[test]
fn the_committed_schemas_are_what_the_types_make() {
    use palpate_app::report::{
        diff_schema, explore_schema, fit_schema, fits_schema, frontier_schema, parts_schema, study_schema,
    };
    let schemas = [
        (FIT, fit_schema()),
        (STUDY, study_schema()),
        (FRONTIER, frontier_schema()),
        (EXPLORE, explore_schema()),
        (PARTS, parts_schema()),
        (DIFF, diff_schema()),
        (FITS, fits_schema()),
    ];
    for (file, schema) in schemas {
        let generated = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        if std::env::var_os("PALPATE_WRITE_SCHEMA").is_some() {
            std::fs::write(file, &generated).unwrap();
        }
        assert_eq!(std::fs::read_to_string(file).unwrap(), generated, "{file}");
    }
}

/// Words of JSON Schema that say something to people alone.
const WORDS: [&str; 3] = ["$schema", "title", "description"];

/// What is wrong with a value. A key that the schema does not name is a fault here, and so is a word of JSON Schema that is not known.
fn fault(at: &str, value: &Value, schema: &Value) -> Result<(), String> {
    let schema = schema.as_object().ok_or(format!("{at} has no schema"))?;
    for (word, rule) in schema.iter().filter(|(word, _)| !WORDS.contains(&word.as_str())) {
        let holds = match word.as_str() {
            "const" => value == rule,
            "enum" => rule.as_array().is_some_and(|list| list.contains(value)),
            "type" => of_kind(value, rule),
            "minimum" => value.as_f64().is_none_or(|number| Some(number) >= rule.as_f64()),
            "minItems" => value.as_array().is_none_or(|items| Some(items.len() as u64) >= rule.as_u64()),
            "maxItems" => value.as_array().is_none_or(|items| Some(items.len() as u64) <= rule.as_u64()),
            "required" => rule
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(Value::as_str)
                .all(|key| value.as_object().is_none_or(|object| object.contains_key(key))),
            "anyOf" | "oneOf" => {
                let faults: Vec<String> =
                    rule.as_array().into_iter().flatten().filter_map(|one| fault(at, value, one).err()).collect();
                let all = rule.as_array().map_or(0, Vec::len);
                if faults.len() == all {
                    return Err(faults.join("; "));
                }
                word == "anyOf" || faults.len() + 1 == all
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    fault(&format!("{at}[{k}]"), item, rule)?;
                }
                true
            }
            "properties" | "additionalProperties" => true,
            _ => false,
        };
        if !holds {
            return Err(format!("{at} is {value}, against {word} {rule}"));
        }
    }
    // the keys of what is one of several are those of that one
    if ["anyOf", "oneOf"].iter().any(|word| schema.contains_key(*word)) {
        return Ok(());
    }
    for (key, item) in value.as_object().into_iter().flatten() {
        let named = schema.get("properties").and_then(|properties| properties.get(key));
        let rule = named.or_else(|| schema.get("additionalProperties"));
        fault(&format!("{at}.{key}"), item, rule.ok_or(format!("{at}.{key} is not in the schema"))?)?;
    }
    Ok(())
}

/// Whether a value is of one of these kinds. A number that is written without a point is an integer and nothing else.
fn of_kind(value: &Value, kinds: &Value) -> bool {
    let found = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(n) if n.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    kinds == found || kinds.as_array().is_some_and(|list| list.iter().any(|kind| kind == found))
}

fn check(at: &str, value: &Value, schema: &Value) {
    if let Err(fault) = fault(at, value, schema) {
        panic!("{fault}");
    }
}

/// The check refuses what does not fit, each by the word that it offends.
#[test]
fn what_does_not_fit_a_schema_is_refused() {
    let (fit, parts) = (palpate_app::report::fit_schema(), palpate_app::report::parts_schema());
    let frame = &fit["properties"]["frame"];
    let relation = &parts["properties"]["relations"]["items"]["properties"]["kind"];
    for (value, schema) in [
        (json!({ "origin": [0.0, 0.0, 0.0], "scale": 1.0 }), frame),
        (json!({ "origin": [0.0, 0.0, 0.0], "axes": [], "scale": 1.0 }), frame),
        (json!([0.0, 0.0]), &frame["properties"]["origin"]),
        (json!([0.0, 0.0, 0]), &frame["properties"]["origin"]),
        (json!([0.0, 0.0, null]), &frame["properties"]["origin"]),
        (json!(-1), &fit["properties"]["contacts"]),
        (json!(1.0), &fit["properties"]["contacts"]),
        (json!("palpate.fit/2"), &fit["properties"]["schema"]),
        (json!({ "mean": 0.5, "sd": null, "more": 1.0 }), &fit["properties"]["shape"]["properties"]["k1"]),
        (json!("skew"), relation),
        (json!(null), relation),
    ] {
        assert!(fault("$", &value, schema).is_err(), "{value} passes {schema}");
    }
    assert_eq!(fault("$", &json!("coaxial"), relation), Ok(()));
}

#[test]
fn what_is_printed_obeys_the_schema() {
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(FIT).unwrap()).unwrap();
    let lines: [&[&str]; 7] = [
        &["run", "paper-fig6-r5.7-degree3", "--surface", "auto", "--json"],
        &["run", "paper-cylinder", "--surface", "parametric", "--sigma", "0.02,2", "--json"],
        &["run", "--json"],
        &["run", "paper-cylinder", "--json"],
        &["run", "paper-plane", "--json"],
        &["run", "paper-cylinder", "--sigma", "0.01,1", "--json"],
        &["run", "paper-cylinder", "--sigma", "auto", "--grid", "1", "--json"],
    ];
    for line in lines {
        let output = Command::cargo_bin("palpate").unwrap().args(line).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        check("$", &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
}

/// Documents of every path, stop, class and of a scene in which nothing varies.
#[test]
fn every_study_obeys_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(STUDY).unwrap()).unwrap();
    let lines = [
        "study paper-table2 --replicates 500 --attribution 64",
        "study paper-table2 --replicates 500 --attribution 0 --quantity k1 --quantity S@0,1.5 --quantile 0.1",
        "study paper-table2 --replicates 500 --range 100:300 --part half",
        "study paper-table2 --tolerance 1 --attribution 0",
        "study paper-table2 --budget 0.000001 --attribution 0",
        "study paper-table2 --sigma auto --replicates 3",
        "study paper-plane --replicates 20",
        "study paper-cylinder --replicates 1",
    ];
    for line in lines {
        let mut command = Command::cargo_bin("palpate").unwrap();
        let output = command.current_dir(folder.path()).args(line.split(' ')).arg("--json").output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        check(line, &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
}

/// Documents of a budget, a goal met, a goal out of reach, a plane, a named model.
#[test]
fn every_exploration_obeys_the_schema() {
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(EXPLORE).unwrap()).unwrap();
    let lines = [
        "explore paper-cylinder --contacts 40",
        "explore paper-table2 --contacts 60 --u-s 0.05 --u-r 0.05",
        "explore paper-table2 --contacts 60 --u-s 0.00001 --u-r 0.00001 --strategy lattice",
        "explore paper-plane --contacts 40 --u-s 0.01 --u-r 0.01",
        "explore paper-table2 --contacts 40 --degree 2 --sigma 0.02,2 --strategy random",
    ];
    for line in lines {
        let mut command = Command::cargo_bin("palpate").unwrap();
        let output = command.args(line.split(' ')).arg("--json").output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        check(line, &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
}

/// Documents of a scene of solids, of a scene that is none, and of a file.
#[test]
fn every_document_of_parts_obeys_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(PARTS).unwrap()).unwrap();
    let mut simulate = Command::cargo_bin("palpate").unwrap();
    simulate.current_dir(folder.path()).args(["simulate", "parts-cone", "-o", "contacts.csv"]).assert().success();
    for line in ["parts parts-capsule", "parts parts-box --tolerance 0.1", "parts paper-table2", "parts contacts.csv"] {
        let mut command = Command::cargo_bin("palpate").unwrap();
        let output = command.current_dir(folder.path()).args(line.split(' ')).arg("--json").output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        check(line, &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
    let promised = "schema parts joints";
    promised.split(' ').for_each(|name| assert!(schema["properties"].get(name).is_some(), "no {name}"));
    let part = &schema["properties"]["parts"]["items"]["properties"];
    "id kind parameters u class points rejected"
        .split(' ')
        .for_each(|key| assert!(part.get(key).is_some(), "no {key}"));
    let joint = &schema["properties"]["joints"]["items"]["properties"];
    "parts kind angle_deg".split(' ').for_each(|key| assert!(joint.get(key).is_some(), "no {key}"));
}

/// Documents of a scene with noise, of one without, of a request, and of a file.
#[test]
fn every_frontier_obeys_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(FRONTIER).unwrap()).unwrap();
    let mut simulate = Command::cargo_bin("palpate").unwrap();
    simulate.current_dir(folder.path()).args(["simulate", "paper-table2", "-o", "contacts.csv"]).assert().success();
    let lines = [
        "frontier paper-cylinder --all --stages --keep-stations --seconds 0.01 --error-r 1e-12",
        "frontier paper-table2 --keep-stations --seconds 0.01 --budget 1ms",
        "frontier paper-table2 --seconds 0.01",
        "frontier contacts.csv --seconds 0.01 --budget 1s",
    ];
    for line in lines {
        let mut command = Command::cargo_bin("palpate").unwrap();
        let output = command.current_dir(folder.path()).args(line.split(' ')).arg("--json").output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        check(line, &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
}

/// Documents of two surfaces with uncertainties, of two without, and of several files of which one fails.
#[test]
fn every_comparison_and_every_table_obeys_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| {
        let mut command = Command::cargo_bin("palpate").unwrap();
        command.current_dir(folder.path()).args(line.split(' ')).output().unwrap()
    };
    run("run paper-table2 --quiet --save a.json");
    run("run paper-plane --quiet --save b.step");
    run("simulate paper-table2 -o c.csv --quiet");
    for (line, file) in [
        ("diff a.json a.json --json", DIFF),
        ("diff b.step b.step --json", DIFF),
        ("diff a.json b.step --json", DIFF),
        ("fit c.csv missing.csv --json", FITS),
    ] {
        let output = run(line);
        let schema: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        check(line, &serde_json::from_slice(&output.stdout).unwrap(), &schema);
    }
    let saved: Value = serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    assert!(saved["uncertainty"]["position"].is_array());
    check("a.json", &saved, &serde_json::from_str(&std::fs::read_to_string(FIT).unwrap()).unwrap());
}

/// Every key of the design's section 4, spelt out here once more.
#[test]
fn no_promised_key_is_missing() {
    let schema = palpate_app::report::fit_schema();
    let keys = |path: &[&str]| -> Vec<String> {
        let part = path.iter().fold(&schema, |part, key| &part["properties"][key]);
        part["properties"].as_object().unwrap().keys().cloned().collect()
    };
    let promised: [(&[&str], &str); 7] = [
        (&[], "schema contacts frame fit shape truth surface seconds"),
        (&["frame"], "origin axes scale"),
        (
            &["fit"],
            "degree segments weights sigma method reason equations unknowns rank condition backward_error smooth rms notes",
        ),
        (&["fit", "sigma"], "z normal_deg slope"),
        (&["shape"], "grid S R radius class class_probability k1 k2 direction_deg support plane_p"),
        (&["surface"], "kind degree knots coefficients"),
        (&["seconds"], "read fit shape total"),
    ];
    for (path, names) in promised {
        let found = keys(path);
        names.split(' ').for_each(|name| assert!(found.iter().any(|key| key == name), "{path:?} lacks {name}"));
    }
    let explore = palpate_app::report::explore_schema();
    let promised = "schema strategy stopped contacts steps shape";
    promised.split(' ').for_each(|name| assert!(explore["properties"].get(name).is_some(), "no {name}"));
    let steps = &explore["properties"]["steps"]["items"]["properties"];
    "contacts S R touched".split(' ').for_each(|name| assert!(steps.get(name).is_some(), "no {name}"));
    let promised = "schema replicates stopped level path S R class linear effects seconds replicates_per_second seed range \
                    scene_hash";
    let study = palpate_app::report::study_schema();
    promised.split_whitespace().for_each(|name| assert!(study["properties"].get(name).is_some(), "no {name}"));
    for name in "mean sd bias lo hi shortest standard_error".split(' ') {
        ["S", "R"].iter().for_each(|q| assert!(study["properties"][q]["properties"].get(name).is_some(), "{q}.{name}"));
    }
    for name in "name share_S share_R".split(' ') {
        assert!(study["properties"]["effects"]["items"]["properties"].get(name).is_some(), "effects.{name}");
    }
}
