//! `palpate study` and `palpate merge`: the same bits however a run is cut, and bad input named.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

const NOISY: &str = "name = \"noisy\"\nseed = 3\n[surface]\nkind = \"cylinder\"\nradius = 6.6\naxis_deg = 30.0\n\
    [sweep]\nfingers = [-4.0, 0.0, 4.0]\nfrom = -4.0\nto = 4.0\nstations = 9\n[effects.row_noise]\nsigma_z = 0.02\n\
    sigma_slope = 0.05\n[fit]\ndegree = 2\nweights = \"tangent\"\ngrid = [4, 4]\n";

fn palpate(folder: &Path, line: &str) -> Command {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(folder).args(line.split_whitespace());
    command
}

/// `/dev/full` is a disk without room, and endless where it is read.
#[cfg(target_os = "linux")]
#[test]
fn full_disks_and_strangers_are_named() {
    let folder = folder();
    let at = folder.path();
    for file in ["full.csv", "full.parquet", "full"] {
        std::os::unix::fs::symlink("/dev/full", at.join(file)).unwrap();
    }
    json(at, "study noisy.toml --replicates 100 --attribution 0 --json --range 0:50 --part a");
    let part = std::fs::read(at.join("a")).unwrap();
    std::fs::write(at.join("short"), &part[..part.len() / 2]).unwrap();
    std::fs::write(at.join("empty"), "").unwrap();
    for (line, words) in [
        ("study noisy.toml --records full.csv", "full.csv\": cannot be written: No space left"),
        ("study noisy.toml --records full.parquet", "full.parquet\": cannot be written: No space left"),
        ("study noisy.toml --part full", "full\": cannot be written: No space left"),
        ("study noisy.toml --checkpoint full", "full: no checkpoint or part of a study"),
        ("merge full", "full: no checkpoint or part of a study"),
        ("merge a empty", "empty: no checkpoint or part of a study"),
        ("merge a short", "short: a corrupted checkpoint or part of a study"),
        ("merge noisy.toml", "noisy.toml: no checkpoint or part of a study"),
        ("merge a", "replicates 50 to 100 of 100 stand in no part"),
    ] {
        let output = palpate(at, line).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && output.stdout.is_empty(), "{line}");
        assert!(message.contains(words), "{line}: {message}");
    }
}

/// The document without what a clock says.
fn json(folder: &Path, line: &str) -> Value {
    let output = palpate(folder, line).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    let mut value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let object = value.as_object_mut().unwrap();
    object.remove("seconds");
    object.remove("replicates_per_second");
    value
}

fn said(folder: &Path, line: &str) -> String {
    let output = palpate(folder, line).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.is_empty(), "{line}");
    String::from_utf8(output.stderr).unwrap()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("noisy.toml"), NOISY).unwrap();
    let moving = NOISY
        .replace("[effects.row_noise]\nsigma_z = 0.02\nsigma_slope = 0.05", "[effects.position_noise]\nsigma = 0.05");
    std::fs::write(folder.path().join("moving.toml"), moving).unwrap();
    folder
}

#[test]
fn parts_in_any_order_are_the_whole_run() {
    let folder = folder();
    let at = folder.path();
    for scene in ["noisy.toml", "moving.toml"] {
        let common = format!("study {scene} --replicates 3000 --seed 9 --attribution 64 --json");
        let whole = json(at, &common);
        assert_eq!(whole["schema"], "palpate.study/1");
        assert_eq!(whole["replicates"], 3000);
        assert_eq!(whole["range"], serde_json::json!([0, 3000]));
        for (name, range) in [("a", "0:700"), ("b", "700:701"), ("c", "701:3000")] {
            json(at, &format!("{common} --range {range} --part {name}"));
        }
        assert_eq!(json(at, "merge c a b --json"), whole);
        let missing = said(at, "merge c a --json");
        assert!(missing.contains("replicates 700 to 701 of 3000 stand in no part"), "{missing}");
        let twice = said(at, "merge a b c b");
        assert!(twice.contains("replicates 700 to 701 stand in two parts"), "{twice}");
        json(at, &format!("study {scene} --replicates 3000 --seed 10 --json --range 700:701 --part other"));
        let stranger = said(at, "merge a other c");
        assert!(stranger.contains("the seed differs: 9 here, 10 there"), "{stranger}");
    }
}

#[test]
fn a_checkpoint_goes_on_to_the_same_bits() {
    let folder = folder();
    let at = folder.path();
    let whole = json(at, "study noisy.toml --replicates 300000 --attribution 0 --json --records whole.csv");
    // a budget ends the first run early; the second goes on to the end
    let line = "study noisy.toml --replicates 300000 --attribution 0 --json --records records.csv --checkpoint state";
    let cut = json(at, &format!("{line} --budget 0.000001"));
    assert_eq!(cut["stopped"], "budget");
    assert!(cut["replicates"].as_u64().unwrap() < 300_000);
    assert_eq!(json(at, line), whole);
    assert_eq!(std::fs::read(at.join("records.csv")).unwrap(), std::fs::read(at.join("whole.csv")).unwrap());
    let other = said(at, "study noisy.toml --replicates 300000 --seed 4 --checkpoint state");
    assert!(other.contains("state: a checkpoint of another study: the seed differs"), "{other}");
    let mut bytes = std::fs::read(at.join("state")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    std::fs::write(at.join("state"), bytes).unwrap();
    let damaged = said(at, "study noisy.toml --replicates 300000 --checkpoint state");
    assert!(damaged.contains("state: a corrupted checkpoint"), "{damaged}");
    std::fs::write(at.join("state"), "x,y,z\n").unwrap();
    assert!(said(at, "study noisy.toml --checkpoint state").contains("no checkpoint or part of a study"));
}

#[test]
fn a_tolerance_is_reached_or_refused() {
    let folder = folder();
    let at = folder.path();
    let found = json(at, "study noisy.toml --tolerance 1 --attribution 0 --json");
    assert_eq!(found["stopped"], "tolerance");
    for quantity in ["S", "R"] {
        let part = &found[quantity];
        let (sd, error) = (part["sd"].as_f64().unwrap(), part["standard_error"]["lo"].as_f64().unwrap());
        assert!(error < 0.05 * sd, "{quantity}: {error} of {sd}");
        // row noise at fixed sites: the linear law stands by, and the replicates count several times over
        assert!(part["control"][0].as_f64().unwrap() > 2.0, "{part}");
    }
    let plain = json(at, "study noisy.toml --replicates 400000 --attribution 0 --json");
    assert!(plain["S"]["control"].is_null());
    for (quantity, end) in [("S", "lo"), ("S", "hi"), ("R", "lo"), ("R", "hi")] {
        let error = |document: &Value| document[quantity]["standard_error"][end].as_f64().unwrap();
        let off = found[quantity][end].as_f64().unwrap() - plain[quantity][end].as_f64().unwrap();
        assert!(off.abs() < 4.0 * error(&found).hypot(error(&plain)), "{quantity} {end} is {off} off");
    }
    let refused = said(at, "study noisy.toml --tolerance 3 --replicates 200000");
    assert!(refused.contains("--tolerance 3 needs about") && refused.contains("200000 are allowed"), "{refused}");
    let late = said(at, "study noisy.toml --tolerance 4 --budget 0.001");
    assert!(late.contains("--budget allows 0.001"), "{late}");
}

#[test]
fn sweeps_name_the_nearest_key() {
    let folder = folder();
    let at = folder.path();
    let sweep = json(
        at,
        "study moving.toml --replicates 64 --sweep effects.position_noise.sigma=0.001:0.1:log3 --sweep fit.degree=2,3 --json --out out",
    );
    assert_eq!(sweep["schema"], "palpate.sweep/1");
    assert_eq!(sweep["points"].as_array().unwrap().len(), 6);
    assert_eq!(sweep["points"][5]["at"], serde_json::json!([0.1, 3.0]));
    for file in ["sweep.csv", "sweep.svg", "sweep.json"] {
        assert!(at.join("out").join(file).exists(), "{file}");
    }
    let csv = std::fs::read_to_string(at.join("out/sweep.csv")).unwrap();
    assert!(csv.starts_with("effects.position_noise.sigma,fit.degree,S_mean,S_sd,"), "{csv}");
    assert_eq!(csv.lines().count(), 7);
    // columns of 8 bytes a row, the points' numbers first
    let parquet = std::fs::read(at.join("out/sweep.parquet")).unwrap();
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    let first = csv.lines().nth(1).unwrap().split(',').nth(2).unwrap().parse::<f64>().unwrap();
    assert!(parquet.windows(8).any(|window| window == first.to_le_bytes()), "S_mean of the first point");
    let wrong = said(at, "study moving.toml --sweep effects.position_nois.sigma=0.001:0.1:log3");
    assert!(wrong.contains("did you mean `position_noise`?"), "{wrong}");
    let wrong = said(at, "study moving.toml --sweep effects.position_noise.sigm=0.001:0.1:log3");
    assert!(wrong.contains("did you mean `sigma`?"), "{wrong}");
    assert!(said(at, "study moving.toml --sweep fit.degree=2.5,3").contains("fit.degree"));
}

#[test]
fn coverage_is_told_by_scene() {
    let folder = folder();
    let found = json(folder.path(), "study noisy.toml --coverage --replicates 50 --json");
    assert_eq!(found["schema"], "palpate.coverage/1");
    let scene = &found["scenes"][0];
    assert_eq!(scene["fitted"], 50);
    assert!(scene["R"]["linear"]["share"].as_f64().unwrap() <= 1.0);
}

/// A named map that stands for the contacts counts as a fit, and its printed intervals are asked.
#[test]
fn coverage_counts_parametric_surfaces_as_fits() {
    let folder = folder();
    let found = json(folder.path(), "study moving.toml --surface parametric --coverage --replicates 3 --json");
    let scene = &found["scenes"][0];
    assert_eq!((&scene["fitted"], &scene["failed"]), (&Value::from(3), &Value::from(0)), "{scene}");
    for quantity in ["S", "R"] {
        assert_eq!(scene[quantity]["linear"]["asked"], 3, "{scene}");
        assert_eq!(scene[quantity]["linear"], scene[quantity]["named"], "{scene}");
    }
}

/// Whole fits beside the replicates are bounded by those asked for: what they leave out is said, with how many bring it.
#[test]
fn few_whole_fits_are_not_followed_by_hundreds() {
    let folder = folder();
    let notes = |line: &str| {
        let found = json(folder.path(), line);
        let notes = found["notes"].as_array().unwrap().clone();
        let left: Vec<String> = notes.iter().map(|note| note.as_str().unwrap().to_string()).collect();
        (found, left.into_iter().filter(|note| note.contains("whole fits")).collect::<Vec<String>>())
    };
    let (found, left) = notes("study moving.toml --robust huber --replicates 3 --json");
    assert!(
        left.len() == 1 && left[0].starts_with("the linear law and the shares of the effects are left out"),
        "{left:?}"
    );
    assert!(found["linear"]["S"]["sd"].is_null() && found["effects"].as_array().unwrap().is_empty(), "{found}");
    let enough = left[0].split_whitespace().skip_while(|word| *word != "--replicates").nth(1).unwrap();
    let (found, left) = notes(&format!("study moving.toml --robust huber --replicates {enough} --json"));
    assert!(left.is_empty(), "{left:?}");
    assert!(found["linear"]["S"]["sd"].is_f64() && !found["effects"].as_array().unwrap().is_empty(), "{found}");
    // who says how many replicates of the shares gets them
    let (found, left) = notes("study moving.toml --robust huber --replicates 3 --attribution 32 --json");
    assert!(left.len() == 1 && left[0].starts_with("the linear law is left out"), "{left:?}");
    assert_eq!(found["effects_replicates"], 32);
}

#[test]
fn coverage_needs_a_scene_of_the_user() {
    let folder = folder();
    let wrong = said(folder.path(), "study --coverage --replicates 2");
    assert!(wrong.contains("a study needs a scene"), "{wrong}");
    let wrong = said(folder.path(), "study cylinder-28-degree2 --coverage --replicates 2");
    assert!(wrong.contains("there is no such file"), "{wrong}");
}

#[test]
fn pictures_and_tables_are_written() {
    let folder = folder();
    let at = folder.path();
    let shown = palpate(
        at,
        "study noisy.toml --replicates 2000 --attribution 64 --quantity k1 --quantity S@0,1.5 --quantile 0.1 --out out",
    );
    let output = { shown }.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    for word in
        ["2000 replicates of noisy", "fixed sites", "95 %", "ridge", "row_noise", "quantile 0.1", "S@0,1.5", "linear"]
    {
        assert!(text.contains(word), "{word} in {text}");
    }
    assert!(std::fs::read_to_string(at.join("out/study.svg")).unwrap().contains("R, curvedness"));
    let laws = "study noisy.toml --replicates 100 --records r.parquet --json";
    json(at, laws);
    assert!(std::fs::read(at.join("r.parquet")).unwrap().ends_with(b"PAR1"));
}

#[test]
fn noise_takes_a_shape_or_says_why_not() {
    let folder = folder();
    let at = folder.path();
    let with = |extra: &str| {
        let text = NOISY.replace("sigma_slope = 0.05\n", &format!("sigma_slope = 0.05\n{extra}\n"));
        std::fs::write(at.join("shape.toml"), text).unwrap();
    };
    with("distribution = \"student_t\"\ndof = 4");
    let heavy = json(at, "study shape.toml --replicates 500 --attribution 0 --json");
    assert_eq!(heavy["path"], "fixed sites");
    for (extra, word) in [
        ("distribution = \"student\"", "did you mean `student_t`?"),
        ("distribution = \"student_t\"\ndof = 2", "more than 2 degrees of freedom"),
    ] {
        with(extra);
        assert!(said(at, "study shape.toml").contains(word), "{extra}");
    }
    let slip =
        NOISY.replace("[fit]", "[effects.slip]\nprobability = 0.1\nsize = 1.0\ndistribution = \"laplace\"\n[fit]");
    std::fs::write(at.join("shape.toml"), slip).unwrap();
    assert!(said(at, "study shape.toml").contains("has no shape"));
}

#[test]
fn bad_usage_is_named() {
    let folder = folder();
    let at = folder.path();
    for (line, word) in [
        ("study", "needs a scene"),
        ("study no-such-scene", "no such file"),
        ("study noisy.toml --replicates 0", "1 to 2^40"),
        ("study noisy.toml --level 1", "between 0 and 1"),
        ("study noisy.toml --level 95", "between 0 and 1"),
        ("study noisy.toml --tolerance 9", "--tolerance"),
        ("study noisy.toml --range 5:3 --part p", "A:B with A < B"),
        ("study noisy.toml --range 0:50000 --part p", "ends beyond the 10000 replicates"),
        ("study noisy.toml --records r.txt", ".csv or .parquet"),
        ("study noisy.toml --records no/such/r.csv", "no/such/r.csv"),
        ("study noisy.toml --records r.parquet --checkpoint c", "--records a .csv"),
        ("study noisy.toml --quantity k3", "k1, k2, radius"),
        ("study noisy.toml --quantile 2", "between 0 and 1"),
        ("study noisy.toml --sweep radius", "KEY=A:B:logN"),
        ("merge nothing", "nothing: cannot be read"),
    ] {
        let message = said(at, line);
        assert!(message.contains(word), "{line}: {message}");
    }
}
