//! Nothing lost, nothing killed: sizes that nobody means, names that command terminals, outputs over inputs, full disks.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use assert_cmd::Command;

fn palpate(here: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Contacts of a bowl.
fn bowl() -> String {
    let row = |(x, y): (f64, f64)| format!("{x},{y},{}\n", 0.05 * (x * x + y * y));
    let places = (0..36).map(|k| (f64::from(k % 6) - 2.5, f64::from(k / 6) - 2.5));
    "x,y,z\n".to_string() + &places.map(row).collect::<String>()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// What the readers ask for meanwhile is counted in `tests/bounds.rs`.
#[test]
fn sizes_that_nobody_means_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let elements: String = (0..40_000).map(|k| format!("element e{k} 0\nproperty float x\n")).collect();
    std::fs::write(here.join("many.ply"), format!("ply\nformat ascii 1.0\n{elements}end_header\n")).unwrap();
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let mut many = zip::ZipWriter::new(std::fs::File::create(here.join("many.npz")).unwrap());
    (0..60_000).for_each(|k| many.start_file(format!("a{k}.npy"), stored).unwrap());
    many.finish().unwrap();
    let mut zeros = zip::ZipWriter::new(std::fs::File::create(here.join("zeros.npz")).unwrap());
    let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (33554432,), }\n";
    for name in ["x.npy", "y.npy"] {
        zeros.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zeros.write_all(b"\x93NUMPY\x01\x00").unwrap();
        zeros.write_all(&(text.len() as u16).to_le_bytes()).unwrap();
        zeros.write_all(text.as_bytes()).unwrap();
        (0..256).for_each(|_| zeros.write_all(&[0; 1 << 20]).unwrap());
    }
    zeros.finish().unwrap();
    // what sizes ask for is told by the numbers alone, before a file is opened: this one is not there
    let cases: [(&[&str], &str); 5] = [
        (&["fit", "many.ply"], "header"),
        (&["fit", "many.npz"], "60000 members"),
        (&["fit", "zeros.npz"], "hundredfold"),
        (&["fit", "absent.csv", "--segments", "100000"], "262144"),
        (&["fit", "absent.csv", "--grid", "10000x10000"], "4000000"),
    ];
    for (arguments, word) in cases {
        let (code, out, message) = palpate(here, arguments);
        assert!(code == Some(2) && out.is_empty() && message.contains(word), "{arguments:?}: {code:?} {message}");
    }
    let scene = "[surface]\nkind = \"plane\"\n[sweep]\nfrom = -1.0\nto = 1.0\nstations = 9\nfingers = [0.0, 1.0]\n[fit]\ngrid = 1000000\n";
    std::fs::write(here.join("s.toml"), scene).unwrap();
    let (code, _, message) = palpate(here, &["run", "s.toml"]);
    assert!(code == Some(2) && message.contains("grid") && message.contains("4000000"), "{message}");
}

#[test]
fn no_output_overwrites_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("c.csv"), bowl()).unwrap();
    std::fs::create_dir(here.join("d")).unwrap();
    std::fs::write(here.join("d/contacts.csv"), bowl()).unwrap();
    std::fs::hard_link(here.join("c.csv"), here.join("again.csv")).unwrap();
    let (code, toml, _) = palpate(here, &["scenes", "paper-plane"]);
    assert_eq!(code, Some(0));
    std::fs::write(here.join("s.csv"), &toml).unwrap();
    let cases: [&[&str]; 6] = [
        &["fit", "c.csv", "--save", "c.csv"],
        &["fit", "c.csv", "--save", "d/../again.csv"],
        &["fit", "d/contacts.csv", "--out", "d"],
        &["simulate", "s.csv", "-o", "s.csv"],
        &["run", "s.csv", "--save", "s.csv"],
        &["study", "s.csv", "--range", "0:9", "--part", "s.csv"],
    ];
    for arguments in cases {
        let (code, out, message) = palpate(here, arguments);
        assert!(code == Some(2) && out.is_empty() && message.contains("is the input"), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_to_string(here.join("c.csv")).unwrap(), bowl());
    assert_eq!(std::fs::read_to_string(here.join("s.csv")).unwrap(), toml);
    assert_eq!(names(&here.join("d")), ["contacts.csv"]);
}

#[test]
fn an_output_directory_holds_one_runs_files_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("c.csv"), bowl()).unwrap();
    assert_eq!(palpate(here, &["fit", "c.csv", "--out", "d", "--quiet"]).0, Some(0));
    let files = [
        "contacts.csv",
        "fit.json",
        "maps.csv",
        "maps.npz",
        "perspective.svg",
        "report.html",
        "section.svg",
        "shape.svg",
    ];
    assert_eq!(names(&here.join("d")), files);
    let first = std::fs::read(here.join("d/fit.json")).unwrap();
    // a second run replaces all of them; one that would leave some is refused, one that fails changes none
    assert_eq!(palpate(here, &["fit", "c.csv", "--out", "d", "--quiet", "--grid", "3"]).0, Some(0));
    let second = std::fs::read(here.join("d/fit.json")).unwrap();
    assert_ne!(first, second);
    let (code, _, message) = palpate(here, &["simulate", "paper-plane", "--out", "d"]);
    assert!(code == Some(2) && message.contains("of another run"), "{message}");
    std::fs::remove_file(here.join("d/shape.svg")).unwrap();
    std::fs::create_dir(here.join("d/shape.svg")).unwrap();
    let (code, _, message) = palpate(here, &["fit", "c.csv", "--out", "d", "--quiet"]);
    assert!(code == Some(1) && message.contains("shape.svg"), "{message}");
    assert_eq!(std::fs::read(here.join("d/fit.json")).unwrap(), second);
    assert_eq!(names(&here.join("d")), files);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("c.csv"), bowl()).unwrap();
    let (code, _, message) = palpate(here, &["fit", "c.csv", "--save", "/dev/full"]);
    assert!(code == Some(1) && message.contains("/dev/full"), "{code:?} {message}");
    for arguments in [&["fit", "c.csv"][..], &["fit", "c.csv", "--json"], &["simulate", "paper-plane", "-o", "-"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("palpate"));
        let status = child.current_dir(here).args(arguments).stdout(full).stderr(std::process::Stdio::null()).status();
        assert_eq!(status.unwrap().code(), Some(1), "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn control_characters_reach_neither_terminal_nor_picture() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let name = "a\u{1b}[31m<b>&.csv";
    std::fs::write(here.join(name), bowl().replace("x,y,z", "x,y,q\u{1b}]0;t\u{7}")).unwrap();
    let (code, out, message) = palpate(here, &["fit", name]);
    assert!(code == Some(2) && !message.contains('\u{1b}') && message.contains("u{1b}[31m"), "{out} {message:?}");
    std::fs::write(here.join(name), bowl()).unwrap();
    let (code, out, message) = palpate(here, &["fit", name, "--out", "d"]);
    assert_eq!((code, message.as_str()), (Some(0), ""));
    assert!(out.contains("u{1b}[31m<b>&.csv") && !out.contains('\u{1b}'), "{out:?}");
    let picture = std::fs::read_to_string(here.join("d/shape.svg")).unwrap();
    assert!(picture.contains("u{1b}[31m&lt;b&gt;&amp;.csv") && !picture.contains('\u{1b}'));
    let scene = "name = \"evil\\u001b[2J\"\n[surface]\nkind = \"plane\"\n[sweep]\nfrom = -1.0\nto = 1.0\nstations = 9\nfingers = [-1.0, 0.0, 1.0]\n";
    std::fs::write(here.join("s.toml"), scene).unwrap();
    let (_, out, message) = palpate(here, &["run", "s.toml"]);
    assert!(out.contains("evil") && !(out + &message).contains('\u{1b}'));
}

/// Started with the hangup signal ignored, a run outlives its terminal.
#[cfg(target_os = "linux")]
#[test]
fn nohup_works() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = std::process::Command::new("nohup")
        .arg(assert_cmd::cargo::cargo_bin("palpate"))
        .args(["fit", "-", "--quiet"])
        .current_dir(folder.path())
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let id = child.id().to_string();
    // until nohup has become palpate, which has had its time to set handlers
    let status = || std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    while !status().contains("Name:\tpalpate") {
        std::thread::yield_now();
    }
    std::thread::sleep(Duration::from_millis(200));
    assert!(std::process::Command::new("kill").args(["-HUP", &id]).status().unwrap().success());
    child.stdin.take().unwrap().write_all(bowl().as_bytes()).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
