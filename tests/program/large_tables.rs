//! Tables that are more than memory holds: the same bits as in memory, whatever the pieces; what is left behind; what is refused.

use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use assert_cmd::Command;
use palpate_numeric::draws::Lcg;
use serde_json::Value;

/// A run in a folder whose temporary files go to its `tmp`.
fn palpate(here: &Path, line: &str, stdin: &[u8]) -> (i32, String, String) {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(here).env("TMPDIR", here.join("tmp")).args(arguments).write_stdin(stdin);
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn document(here: &Path, line: &str, stdin: &[u8]) -> Value {
    let (code, out, message) = palpate(here, line, stdin);
    assert_eq!(code, 0, "{line}: {message}");
    serde_json::from_str(&out).unwrap()
}

fn refused(here: &Path, line: &str) -> String {
    let (code, _, message) = palpate(here, line, b"");
    assert_eq!(code, 2, "{line}: {message}");
    message
}

/// What is found, without clocks and remarks.
fn found(document: &Value) -> Value {
    let mut document = document.clone();
    let top = document.as_object_mut().unwrap();
    ["seconds", "input", "source"].iter().for_each(|key| drop(top.remove(*key)));
    top.get_mut("fit").unwrap().as_object_mut().unwrap().remove("notes");
    document
}

fn notes(document: &Value) -> String {
    document["fit"]["notes"].to_string()
}

/// A lens with a bump, slopes with it, and a few contacts far off.
fn table(count: usize) -> String {
    let mut draw = Lcg::new(9);
    let mut text = String::from("x [mm],y,z,zx,zy\n");
    for k in 0..count {
        let [x, y] = [0, 1].map(|_| 20.0 * draw.uniform() - 10.0);
        let off = ((x - 3.1_f64).powi(2) + (y + 4.4_f64).powi(2)) / 0.25;
        let (bump, strange) = (0.4 * (-off).exp(), if k % 1000 == 7 { 3.0 } else { 0.0 });
        let z = 3.0 * (0.15 * x).sin() * (0.12 * y + 0.3).cos() + bump + strange + 0.02 * draw.normal();
        let zx = 0.45 * (0.15 * x).cos() * (0.12 * y + 0.3).cos() - 8.0 * (x - 3.1) * bump + 0.1 * draw.normal();
        let zy = -0.36 * (0.15 * x).sin() * (0.12 * y + 0.3).sin() - 8.0 * (y + 4.4) * bump + 0.1 * draw.normal();
        text.push_str(&format!("{x},{y},{z},{zx},{zy}\n"));
    }
    text
}

fn folder_with(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tmp")).unwrap();
    std::fs::write(folder.path().join("lens.csv"), text).unwrap();
    folder
}

fn is_empty(folder: &Path) -> bool {
    std::fs::read_dir(folder).unwrap().next().is_none()
}

#[test]
fn pieces_are_fitted_to_the_bits_of_one_memory() {
    let text = table(30_000);
    let folder = folder_with(&text);
    let here = folder.path();
    let whole = document(here, "fit lens.csv --adaptive --json", b"");
    assert!(
        whole["fit"]["adaptive"]["halvings"].as_u64() >= Some(2)
            && whole["fit"]["adaptive"]["left_out"].as_u64() >= Some(30)
    );
    let pieces = document(here, "fit lens.csv --adaptive --memory 1 --json --out d", b"");
    assert_eq!(found(&pieces), found(&whole));
    assert!(notes(&pieces).contains("more than 1 MB of memory and were fitted from files"), "{}", notes(&pieces));
    assert!(!notes(&whole).contains("from files"));
    assert!(
        here.join("d/report.html").exists()
            && here.join("d/maps.csv").exists()
            && !here.join("d/contacts.csv").exists()
    );
    let piped = document(here, "fit - --adaptive --memory 1 --json", text.as_bytes());
    assert_eq!(found(&piped), found(&whole));
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    std::fs::write(here.join("lens.csv.gz"), packed.finish().unwrap()).unwrap();
    let packed = document(here, "fit lens.csv.gz --adaptive --memory 1 --json", b"");
    assert_eq!(found(&packed), found(&whole));
    let part = "--box -5,10,-10,5,-99,99 --ignore-normals";
    let [part_of_whole, part_of_pieces] = ["", "--memory 1"]
        .map(|memory| document(here, &format!("fit lens.csv --adaptive --json {part} {memory}"), b""));
    assert_eq!(found(&part_of_pieces), found(&part_of_whole));
    assert!(notes(&part_of_pieces).contains("of 30000 contacts are in the part"));
    assert!(is_empty(&here.join("tmp")));
}

/// Nobody has to say that it is large: what fits is recognised, what does not is fitted.
#[test]
fn without_a_model_what_is_too_large_is_adaptive() {
    let folder = folder_with(&table(12_000));
    let found = document(folder.path(), "fit lens.csv --memory 1 --json", b"");
    assert_eq!(found["surface"]["kind"], "adaptive");
    assert!(notes(&found).contains("no kind is recognised"));
}

#[test]
fn faults_have_their_lines_and_leave_nothing_behind() {
    let text = table(12_000);
    let folder = folder_with(&text);
    let here = folder.path();
    let domain = refused(here, "fit lens.csv --adaptive --memory 1 --domain -10,10,-10,9.9");
    let outside = |line: &&str| line.split(',').nth(1).and_then(|y| y.parse().ok()).is_some_and(|y: f64| y > 9.9);
    let line = text.lines().position(|line| outside(&line)).unwrap() + 1;
    assert!(domain.contains(&format!("lens.csv, line {line}:")) && domain.contains("outside"), "{domain}");
    std::fs::write(here.join("torn.csv"), format!("{text}1,2,\n")).unwrap();
    assert!(refused(here, "fit torn.csv --adaptive --memory 1").contains("torn.csv, line 12002"));
    assert!(refused(here, "fit lens.csv --degree 2 --memory 1").contains("--memory is for an adaptive surface"));
    assert!(refused(here, "fit lens.csv --adaptive --memory 1 --normals estimate").contains("of all contacts at once"));
    assert!(
        refused(here, "fit lens.csv --adaptive --memory 1 --near 99,99,99,1").contains("no contact lies in the part")
    );
    std::fs::write(here.join("cloud.npy"), [b"\x93NUMPY".to_vec(), vec![0; 1 << 20]].concat()).unwrap();
    assert!(refused(here, "fit cloud.npy --adaptive --memory 1").contains("tables of text alone"));
    assert!(is_empty(&here.join("tmp")));
}

/// Ctrl-C ends it and removes what was written, as it ends every fit.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let folder = folder_with("");
    let here = folder.path();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("palpate"))
        .current_dir(here)
        .env("TMPDIR", here.join("tmp"))
        .args(["fit", "-", "--adaptive", "--memory", "1"])
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // more than a piece, and the pipe stays open
    child.stdin.as_mut().unwrap().write_all(table(12_000).as_bytes()).unwrap();
    let until = std::time::Instant::now() + std::time::Duration::from_secs(60);
    while is_empty(&here.join("tmp")) && std::time::Instant::now() < until {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(!is_empty(&here.join("tmp")));
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(is_empty(&here.join("tmp")));
}
