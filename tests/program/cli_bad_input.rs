//! Every bad input ends with exit 2, says where and what would be right, and writes nothing.

use std::path::Path;

use assert_cmd::Command;

fn palpate(directory: &Path, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("palpate").unwrap().current_dir(directory).args(arguments).output().unwrap()
}

/// Runs, expects exit 2, nothing on standard output, and every word in the message.
fn refused(directory: &Path, arguments: &[&str], words: &[&str]) {
    let output = palpate(directory, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert!(!message.contains("panicked"), "{message}");
    words.iter().for_each(|word| assert!(message.contains(word), "{arguments:?}: {message:?} lacks {word:?}"));
}

/// Contacts of a convex paraboloid on a grid of `side * side`, normals by `normal(x, y)`.
fn paraboloid(side: usize, normal: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let mut text = String::from("x,y,z,nx,ny,nz\n");
    for i in 0..side {
        for j in 0..side {
            let [x, y] = [i, j].map(|k| k as f64 - 0.5 * (side - 1) as f64);
            let [nx, ny, nz] = normal(x, y);
            text.push_str(&format!("{x},{y},{},{nx},{ny},{nz}\n", -0.05 * (x * x + y * y)));
        }
    }
    text
}

fn outward(x: f64, y: f64) -> [f64; 3] {
    [0.1 * x, 0.1 * y, 1.0]
}

#[test]
fn contacts_that_cannot_be_read_or_fitted() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let good = paraboloid(5, outward);
    let with_line = |line: usize, replacement: &str| {
        let mut lines: Vec<&str> = good.lines().collect();
        lines[line - 1] = replacement;
        lines.join("\n")
    };
    let one_line: String =
        std::iter::once("x,y,z\n".to_string()).chain((0..20).map(|k| format!("{k},{},0\n", 2 * k))).collect();
    let cases: [(&str, String, &[&str], &[&str]); 16] = [
        ("empty", String::new(), &[], &["bad.csv", "empty", "x,y,z"]),
        ("missing column", good.replace("x,y,z", "x,q,z"), &[], &["bad.csv", "no column y", "x,q,z"]),
        ("duplicate column", good.replace("x,y,z", "x,y,y"), &[], &["bad.csv", "column y", "twice"]),
        ("no number", with_line(4, "1,two,3,0,0,1"), &[], &["bad.csv", "line 4", "column y", "\"two\""]),
        ("nan", with_line(5, "1,2,nan,0,0,1"), &[], &["bad.csv", "line 5", "column z", "--skip-invalid"]),
        ("infinity", with_line(6, "inf,2,3,0,0,1"), &[], &["bad.csv", "line 6", "column x"]),
        ("zero normal", with_line(7, "0,2,3,0,0,0"), &["--degree", "2"], &["bad.csv", "line 7", "normal"]),
        ("short row", with_line(8, "0,2"), &[], &["bad.csv", "line 8", "2 fields"]),
        (
            "nz below zero",
            with_line(9, "-1,0,0,0.1,0,-1"),
            &["--degree", "2", "--frame", "keep"],
            &["bad.csv", "line 9", "nz"],
        ),
        (
            "nz zero in slopes",
            with_line(9, "-1,0,0,1,0,0"),
            &["--weights", "equal", "--frame", "keep"],
            &["bad.csv", "line 9", "--sigma"],
        ),
        ("inward", paraboloid(5, |x, y| outward(x, y).map(|v| -v)), &["--degree", "2"], &["bad.csv", "--flip-normals"]),
        ("too few", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n".into(), &[], &["bad.csv", "3 contacts", "touch a dozen"]),
        ("one line", one_line, &[], &["bad.csv", "on one line"]),
        ("degree", good.clone(), &["--degree", "12"], &["--degree", "1 to 9"]),
        ("segments", good.clone(), &["--segments", "0"], &["--segments", "from 1"]),
        ("outside", good.clone(), &["--domain", "-1,1,-1,1"], &["bad.csv", "line 2", "outside", "[-1, 1]"]),
    ];
    for (name, text, options, words) in cases {
        std::fs::write(here.join("bad.csv"), text).unwrap();
        let mut arguments = vec!["fit", "bad.csv", "--save", "out.json"];
        arguments.extend(options);
        refused(here, &arguments, words);
        assert_eq!(std::fs::read_dir(here).unwrap().count(), 1, "{name} left a file");
    }
    refused(here, &["fit", "nothing.csv"], &["nothing.csv", "cannot be read"]);
    refused(here, &["fit", "."], &["cannot be read"]);
}

#[test]
fn usage_that_contradicts_itself() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("good.csv"), paraboloid(5, outward)).unwrap();
    refused(here, &[], &["Usage"]);
    refused(here, &["feel"], &["feel"]);
    refused(here, &["fit"], &["INPUT"]);
    refused(here, &["fit", "good.csv", "--weights", "auto", "--sigma", "auto"], &["--weights", "--sigma"]);
    refused(here, &["fit", "good.csv", "--weights", "tangents"], &["--weights", "tangent", "WZ,WX,WY"]);
    refused(here, &["fit", "good.csv", "--sigma", "1"], &["--sigma", "Z,DEG"]);
    refused(here, &["fit", "good.csv", "--inset", "0.5"], &["--inset", "below 0.5"]);
    refused(here, &["fit", "good.csv", "--domain", "1,0,0,1"], &["--domain", "X0 < X1"]);
    refused(here, &["fit", "good.csv", "--method", "kronecker"], &["kronecker", "grid"]);
    refused(here, &["fit", "good.csv", "--json", "--save", "-"], &["--save -", "--json"]);
    refused(here, &["simulate", "paper-cylinder"], &["--output"]);
    refused(here, &["simulate", "paper-cylinder", "-o", "-", "--json"], &["-o -", "--json"]);
    refused(here, &["simulate", "paper-cylinder", "-o", "contacts.xls"], &["contacts.xls", ".csv, .npz or .ply"]);
    refused(here, &["run", "paper-cilinder"], &["paper-cilinder", "paper-cylinder"]);
    refused(here, &["scenes", "paper-cilinder"], &["paper-cylinder"]);
    std::fs::write(here.join("scene.toml"), "[surface]\nkind = \"cylinder\"\nradius = 3.0\nconcav = true\n[sweep]\nfingers = [0.0]\nfrom = 0.0\nto = 1.0\nstations = 2\n").unwrap();
    refused(here, &["run", "scene.toml"], &["scene.toml", "line 4", "concav", "concave"]);
    refused(here, &["show", "good.csv"], &["good.csv", "not a saved surface", "--save"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("file"), "x").unwrap();
    refused(here, &["run", "--quiet", "--save", "no/such/place.json"], &["no/such/place.json", "cannot be written"]);
    refused(here, &["run", "--quiet", "--save", "."], &["directory"]);
    refused(here, &["run", "--out", "file"], &["--out file"]);
    refused(here, &["simulate", "paper-cylinder", "-o", "no/contacts.csv"], &["no/contacts.csv"]);
    assert_eq!(std::fs::read_dir(here).unwrap().count(), 1);
}

#[test]
fn grids_whose_axes_do_not_increase() {
    use ndarray::{Array1, Array2};
    let directory = tempfile::tempdir().unwrap();
    let file = std::fs::File::create(directory.path().join("grid.npz")).unwrap();
    let mut npz = super::npz::NpzWriter::new(file);
    npz.add_array("x", &Array1::from(vec![0.0, 2.0, 1.0, 3.0])).unwrap();
    npz.add_array("y", &Array1::from(vec![0.0, 1.0, 2.0])).unwrap();
    npz.add_array("z", &Array2::<f64>::zeros((4, 3))).unwrap();
    npz.finish().unwrap();
    refused(directory.path(), &["fit", "grid.npz"], &["grid.npz", "axis x", "entry 2", "2 then 1"]);
}
