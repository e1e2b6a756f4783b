//! The verbs as a user meets them: tables, pure JSON, pipes, files whole or not at all.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;

use assert_cmd::Command;
use serde_json::Value;

fn palpate(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(directory).args(arguments);
    command
}

fn text(directory: &Path, arguments: &[&str]) -> String {
    let output = palpate(directory, arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    let output = palpate(directory, arguments).output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn without_seconds(mut document: Value) -> Value {
    document.as_object_mut().unwrap().remove("seconds");
    document
}

#[test]
fn run_tells_the_shape_of_the_cylinder() {
    let directory = tempfile::tempdir().unwrap();
    let table = text(directory.path(), &["run", "paper-cylinder"]);
    assert!(
        table.contains("shape      ridge: like the outside of a pipe") && table.contains("0.5000   0.49999"),
        "{table}"
    );
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    let document = json(directory.path(), &["run", "paper-cylinder", "--json"]);
    assert_eq!(document["schema"], "palpate.fit/1");
    assert!((document["shape"]["S"]["mean"].as_f64().unwrap() - 0.5).abs() < 0.01);
    assert!(text(directory.path(), &["run", "paper-cylinder", "--quiet"]).is_empty());
}

/// A biquadratic height field makes R of this cylinder 5 % too small, and noise says nothing of it.
#[test]
fn the_interval_of_a_named_model_counts_other_kinds_of_surface() {
    let directory = tempfile::tempdir().unwrap();
    let document = json(directory.path(), &["run", "paper-cylinder", "--json"]);
    let (found, truth) = (&document["shape"]["R"], document["truth"]["R"].as_f64().unwrap());
    let number = |key: &str| found[key].as_f64().unwrap();
    let [lo, hi] = [0, 1].map(|k| found["interval"][k].as_f64().unwrap());
    assert!(lo < truth && truth <= hi && number("mean") < 0.97 * truth, "{found}");
    assert!((number("u_noise").hypot(number("u_model")) / number("u") - 1.0).abs() < 1e-12);
    // u reaches the farther end
    let reach = (hi - number("mean")).max(number("mean") - lo);
    assert!((number("coverage_factor") * number("u") / reach - 1.0).abs() < 1e-9);
    let notes = document["fit"]["notes"].to_string();
    assert!(notes.contains("model 0.00") && notes.contains("palpate fit without a named model"), "{notes}");
}

/// Nine heights and nine unknowns leave nothing from which noise could be told.
#[test]
fn without_degrees_of_freedom_there_is_no_interval() {
    let directory = tempfile::tempdir().unwrap();
    let heights: String = (0..9).map(|r| format!("{},{},{}\n", r % 3, r / 3, (r * r) % 5)).collect();
    std::fs::write(directory.path().join("few.csv"), format!("x,y,z\n{heights}")).unwrap();
    let document = json(directory.path(), &["fit", "few.csv", "--degree", "2", "--json"]);
    let found = &document["shape"]["R"];
    let counted = found["u_model"].is_number() || found["interval"].is_null();
    assert!(found["mean"].is_number() && counted, "{found}");
}

/// What is declined is null in the document, has no line in the table, and is said; all else stays to the digit.
#[test]
fn bare_declines_certificate_and_intervals_alone() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let (mut whole, mut bare) =
        (json(here, &["run", "paper-cylinder", "--json"]), json(here, &["run", "paper-cylinder", "--json", "--bare"]));
    let declined = [
        "/fit/condition",
        "/fit/backward_error",
        "/fit/promise",
        "/fit/sigma",
        "/shape/S/u",
        "/shape/S/interval",
        "/shape/R/u",
        "/shape/R/interval",
        "/shape/class_probability",
        "/shape/direction_deg",
    ];
    for key in declined {
        assert!(bare.pointer(key).unwrap().is_null(), "{key}");
        assert!(!std::mem::take(whole.pointer_mut(key).unwrap()).is_null(), "{key}");
    }
    // keys that stand beside an interval are not there without one
    for quantity in ["S", "R"] {
        let found = whole["shape"][quantity].as_object_mut().unwrap();
        for key in ["u_noise", "u_model", "level", "coverage_factor", "dof"] {
            assert!(found.remove(key).is_some(), "{quantity} {key}");
        }
    }
    for key in ["cov_S_R", "intervals", "axis_deg"] {
        assert!(whole["shape"].as_object_mut().unwrap().remove(key).is_some(), "{key}");
    }
    // the truth has the directions that the answer has
    for key in ["direction_deg", "axis_deg"] {
        assert!(whole["truth"].as_object_mut().unwrap().remove(key).is_some(), "{key}");
    }
    let notes = std::mem::take(bare.pointer_mut("/fit/notes").unwrap());
    whole["fit"]["notes"].take();
    assert!(whole["fit"].as_object_mut().unwrap().remove("technical_notes").is_some());
    assert!(notes[0].as_str().unwrap().contains("--bare"), "{notes}");
    assert_eq!(without_seconds(whole), without_seconds(bare));
    let table = text(here, &["run", "paper-cylinder", "--bare", "--verbose"]);
    assert!(!table.contains("numbers ") && !table.contains("digits ") && !table.contains("u ="), "{table}");
    text(here, &["simulate", "paper-cylinder", "-o", "c.csv"]);
    let refused = palpate(here, &["fit", "c.csv", "--bare"]).output().unwrap();
    let message = String::from_utf8_lossy(&refused.stderr);
    assert!(refused.status.code() == Some(2) && message.contains("--degree"), "{message}");
    let space = json(here, &["run", "paper-cylinder", "--bare", "--surface", "parametric", "--json"]);
    assert!(space["shape"]["S"]["u"].is_null() && space["fit"]["condition"].is_null());
}

#[test]
fn contacts_of_a_scene_fit_alike_from_every_format_and_from_a_pipe() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let fit = ["--weights", "tangent", "--json"];
    let mut shapes = Vec::new();
    for file in ["c.csv", "c.npz", "c.ply"] {
        text(here, &["simulate", "paper-cylinder", "-o", file]);
        shapes.push(without_seconds(json(here, &[&["fit", file], &fit[..]].concat())));
    }
    let csv = text(here, &["simulate", "paper-cylinder", "-o", "-"]);
    assert_eq!(csv, std::fs::read_to_string(here.join("c.csv")).unwrap());
    let piped = palpate(here, &[&["fit", "-"], &fit[..]].concat()).write_stdin(csv).output().unwrap();
    shapes.push(without_seconds(serde_json::from_slice(&piped.stdout).unwrap()));
    shapes.windows(2).for_each(|pair| assert_eq!(pair[0], pair[1]));
    let run = json(here, &["run", "paper-cylinder", "--json"]);
    assert_eq!(run["surface"], shapes[0]["surface"]);
}

#[test]
fn a_scene_may_come_from_a_pipe_or_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let toml = text(here, &["scenes", "paper-cylinder"]);
    let built_in = without_seconds(json(here, &["run", "paper-cylinder", "--json"]));
    let piped = palpate(here, &["run", "-", "--json"]).write_stdin(toml.clone()).output().unwrap();
    assert_eq!(without_seconds(serde_json::from_slice(&piped.stdout).unwrap()), built_in);
    std::fs::write(here.join("mine.toml"), toml).unwrap();
    assert_eq!(without_seconds(json(here, &["run", "mine.toml", "--json"])), built_in);
}

#[test]
fn the_output_directory_holds_pictures_tables_and_records() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    text(here, &["run", "paper-cylinder", "--out", "deep/er", "--grid", "5x4", "--inset", "0.1"]);
    let mut names: Vec<String> = std::fs::read_dir(here.join("deep/er"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let pictures = ["perspective.svg", "section.svg", "shape.svg"];
    let others = ["contacts.csv", "fit.json", "maps.csv", "maps.npz", "report.html"];
    let mut expected = [&others[..], &pictures].concat();
    expected.sort_unstable();
    assert_eq!(names, expected);
    let maps = std::fs::read_to_string(here.join("deep/er/maps.csv")).unwrap();
    assert_eq!(
        (maps.lines().next(), maps.lines().count()),
        (Some("x,y,z,k1,k2,S,R,u_position,u_normal_deg,u_S,u_R,u_k1,u_k2"), 1 + 20)
    );
    let svg = std::fs::read_to_string(here.join("deep/er/shape.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("paper-cylinder: ridge"));
    // other kinds of pictures on request, each below 200 kB
    text(here, &["run", "paper-cylinder", "--out", "kinds", "--pictures", "png,pdf", "--quiet"]);
    for picture in ["shape", "section", "perspective"] {
        for (kind, first) in [("png", &b"\x89PNG"[..]), ("pdf", b"%PDF")] {
            let bytes = std::fs::read(here.join(format!("kinds/{picture}.{kind}"))).unwrap();
            assert!(bytes.starts_with(first) && bytes.len() < 200_000, "{picture}.{kind}: {}", bytes.len());
        }
        assert!(!here.join(format!("kinds/{picture}.svg")).exists());
    }
    for wrong in [&["--pictures", "gif", "--out", "x"][..], &["--pictures", "png"]] {
        palpate(here, &[&["run"], wrong].concat()).assert().code(2);
    }
}

#[test]
fn show_gives_the_shape_back_and_evaluates_anywhere() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let run = text(here, &["run", "paper-cylinder", "--save", "s.json"]);
    let shown = text(here, &["show", "s.json"]);
    // all but the first line, which names scene or file
    assert_eq!(run.split_once('\n').unwrap().1, shown.split_once('\n').unwrap().1);
    let again = json(here, &["show", "s.json", "--grid", "8x8", "--json"]);
    let saved: Value = serde_json::from_slice(&std::fs::read(here.join("s.json")).unwrap()).unwrap();
    for part in ["S", "R"] {
        let mean = |document: &Value| document["shape"][part]["mean"].as_f64().unwrap();
        assert!((mean(&again) - mean(&saved)).abs() < 1e-12);
    }
    assert!(again["shape"]["S"]["u"].is_null());
    std::fs::write(here.join("at.csv"), "label,y,x\na,0,0\nb,1,-2\nc,0,99\n").unwrap();
    let points = json(here, &["show", "s.json", "--at", "at.csv", "--json"]);
    let points = points["points"].as_array().unwrap();
    assert_eq!((points.len(), &points[2]["inside"]), (3, &Value::Bool(false)));
    assert!((points[0]["S"].as_f64().unwrap() - 0.5).abs() < 1e-3);
    assert_eq!(points[1]["x"], -2.0);
    let csv = text(here, &["show", "s.json", "--at", "at.csv"]);
    assert_eq!(csv.lines().next(), Some("x,y,inside,z,zx,zy,nx,ny,nz,k1,k2,S,R"));
    let piped =
        palpate(here, &["show", "-"]).write_stdin(std::fs::read(here.join("s.json")).unwrap()).output().unwrap();
    assert!(piped.status.success());
}

#[test]
fn columns_not_used_and_rows_left_out_are_said() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut csv = text(here, &["simulate", "paper-cylinder", "-o", "-"]);
    csv = csv.replacen("station", "temperature", 1);
    let commas = csv.lines().next().unwrap().matches(',').count();
    csv.push_str(&format!("nan{}\n", ",1".repeat(commas)));
    std::fs::write(here.join("c.csv"), csv).unwrap();
    let document = json(here, &["fit", "c.csv", "--skip-invalid", "--json"]);
    let notes = document["fit"]["notes"].to_string();
    assert!(
        notes.contains("temperature") && notes.contains("1 invalid rows counted out") && document["contacts"] == 36,
        "{notes}"
    );
}

#[test]
fn inward_normals_fit_once_flipped() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let csv = text(here, &["simulate", "paper-cylinder", "-o", "-"]);
    let mut lines = csv.lines();
    let header = lines.next().unwrap();
    let normal = header.split(',').position(|name| name == "nx").unwrap();
    let mut inward = format!("{header}\n");
    for line in lines {
        let mut fields: Vec<String> = line.split(',').map(str::to_string).collect();
        for field in &mut fields[normal..normal + 3] {
            *field = (-field.parse::<f64>().unwrap()).to_string();
        }
        inward.push_str(&(fields.join(",") + "\n"));
    }
    std::fs::write(here.join("in.csv"), inward).unwrap();
    // a model over the input's axes refuses them; a recognition takes any side for the free one, and asks
    let refused = palpate(here, &["fit", "in.csv", "--degree", "2"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--flip-normals"));
    let taken = json(here, &["fit", "in.csv", "--json"]);
    assert!(taken["fit"]["notes"].to_string().contains("--flip-normals") && taken["shape"]["class"] == "rut");
    assert_eq!(json(here, &["fit", "in.csv", "--flip-normals", "--json"])["shape"]["class"], "ridge");
    let flipped = json(here, &["fit", "in.csv", "--flip-normals", "--weights", "tangent", "--json"]);
    assert_eq!(flipped["shape"]["class"], "ridge");
}

/// Standard output closed after one line, as by `head -1`: no panic, no message, exit 0.
#[test]
fn a_closed_pipe_ends_quietly() {
    for arguments in
        [&["scenes"][..], &["run", "paper-cylinder", "--json"], &["simulate", "paper-cylinder", "-o", "-"], &["--help"]]
    {
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("palpate"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // closed before a byte is read, so that the first write meets a closed pipe
        drop(child.stdout.take());
        let mut message = String::new();
        child.stderr.take().unwrap().read_to_string(&mut message).unwrap();
        assert_eq!((child.wait().unwrap().code(), message.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

/// Ctrl-C while a large file is being written: exit 130, neither half a file nor its scaffold.
#[cfg(unix)]
#[test]
fn an_interrupted_write_leaves_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let mut scene = String::from("[surface]\nkind = \"plane\"\n[sweep]\nfrom = -1.0\nto = 1.0\nstations = 1000000\n");
    scene.push_str("fingers = [-1.0, 0.0, 1.0]\n");
    std::fs::write(directory.path().join("s.toml"), scene).unwrap();
    // a shell that runs the tests in the background may have told its children to ignore the signal
    let mut command = std::process::Command::new("env");
    if cfg!(target_os = "linux") {
        command.arg("--default-signal");
    }
    let child = command
        .arg(assert_cmd::cargo::cargo_bin("palpate"))
        .current_dir(directory.path())
        .args(["simulate", "s.toml", "-o", "big.csv"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    // as soon as the scaffold is there, the file is half written
    let scaffold = || std::fs::read_dir(directory.path()).unwrap().any(|e| e.unwrap().file_name() != "s.toml");
    let mut child = child;
    while !scaffold() {
        assert_eq!(child.try_wait().unwrap(), None, "ended before it could be interrupted");
        std::thread::yield_now();
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let status = child.wait().unwrap();
    let left: Vec<_> = std::fs::read_dir(directory.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!((status.code(), left.len()), (Some(130), 1), "{left:?}");
}

#[test]
fn scenes_are_listed_and_written() {
    let directory = tempfile::tempdir().unwrap();
    let list = text(directory.path(), &["scenes"]);
    assert!(list.starts_with("bar ") && list.contains("\npaper-cylinder "), "{list}");
    let document = json(directory.path(), &["scenes", "--json"]);
    assert_eq!(document["scenes"].as_array().unwrap().len(), list.lines().count());
    text(directory.path(), &["scenes", "paper-plane", "--out", "d"]);
    let toml = std::fs::read_to_string(directory.path().join("d/paper-plane.toml")).unwrap();
    assert_eq!(toml, text(directory.path(), &["scenes", "paper-plane"]));
}

#[test]
fn help_and_version_exit_zero() {
    let directory = tempfile::tempdir().unwrap();
    for verb in ["run", "simulate", "fit", "scenes", "show"] {
        let help = text(directory.path(), &[verb, "--help"]);
        for flag in ["--json", "--out", "--quiet"] {
            assert!(help.contains(flag), "{verb} {flag}");
        }
    }
    let mut version = BufReader::new(text(directory.path(), &["--version"]).into_bytes().leak() as &[u8]).lines();
    assert!(version.next().unwrap().unwrap().starts_with("palpate "));
}

#[test]
fn a_saved_fit_can_be_touched_and_every_output_calls_it_an_inverse_crime() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    text(here, &["run", "paper-cylinder", "--save", "fit.json", "--quiet"]);
    let scene = "[surface]\nkind = \"imported\"\nfile = \"fit.json\"\n[sweep]\nfingers = [-3.0, 0.0, 3.0]\nfrom = -3.0\nto = 3.0\nstations = 7\n[fit]\ndegree = 2\n";
    std::fs::write(here.join("again.toml"), scene).unwrap();
    let crime = "inverse crime: the surface is imported from fit.json";
    let document = json(here, &["run", "again.toml", "--json"]);
    assert!(document["fit"]["notes"].as_array().unwrap().iter().any(|n| n.as_str().unwrap().contains(crime)));
    // the model is the surface's own: nothing but rounding is left
    assert!(document["fit"]["rms"]["z"].as_f64().unwrap() < 1e-13);
    assert!(document["truth"]["error_S"].as_f64().unwrap() < 1e-9);
    assert!(text(here, &["run", "again.toml"]).contains(crime));
    assert!(text(here, &["simulate", "again.toml", "--explain"]).contains("inverse crime"));
    assert!(text(here, &["simulate", "again.toml", "-o", "-"]).starts_with(&format!("# {crime}")));
    assert_eq!(
        json(here, &["simulate", "again.toml", "-o", "c.ply", "--json"])["note"].as_str().map(|n| n.starts_with(crime)),
        Some(true)
    );
    assert!(String::from_utf8_lossy(&std::fs::read(here.join("c.ply")).unwrap()).contains(crime));
    text(here, &["simulate", "again.toml", "-o", "c.npz", "--quiet"]);
    let read = palpate(here, &["fit", "c.npz"]).output().unwrap();
    assert!(read.status.success() && String::from_utf8_lossy(&read.stdout).contains("inverse_crime"));
    text(here, &["run", "again.toml", "--out", "o", "--quiet"]);
    assert!(std::fs::read_to_string(here.join("o/shape.svg")).unwrap().contains("(inverse crime)"));
    // off the fitted patch there is no surface
    std::fs::write(here.join("wide.toml"), scene.replace("3.0", "30.0")).unwrap();
    palpate(here, &["run", "wide.toml"]).assert().code(2);
    std::fs::write(here.join("gone.toml"), scene.replace("fit.json", "none.json")).unwrap();
    let gone = palpate(here, &["run", "gone.toml"]).output().unwrap();
    let said = String::from_utf8_lossy(&gone.stderr).to_string();
    assert!(gone.status.code() == Some(2) && said.contains("line 3") && said.contains("none.json"), "{said}");
}

#[test]
fn the_portable_path_differs_by_rounding_alone() {
    let directory = tempfile::tempdir().unwrap();
    let run = |flags: &[&str]| {
        without_seconds(json(directory.path(), &[&["run", "paper-cylinder", "--json"], flags].concat()))
    };
    let (usual, portable) = (run(&[]), run(&["--portable"]));
    for key in ["S", "R"] {
        let mean = |document: &Value| document["shape"][key]["mean"].as_f64().unwrap();
        assert!((mean(&usual) - mean(&portable)).abs() < 1e-12, "{key}");
    }
    assert_eq!(portable, run(&["--portable"]));
}
