//! Outputs are one transaction: what would be lost is refused before any work, and what one run writes is of that run alone.

use std::path::Path;

use assert_cmd::Command;

fn palpate(here: &Path, line: &str) -> (Option<i32>, String, String) {
    let arguments = line.split_whitespace();
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// A folder with contacts of a bowl, its saved surface, and a scene that touches that surface.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let row = |(x, y): (f64, f64)| format!("{x},{y},{}\n", 0.05 * (x * x + y * y));
    let places = (0..36).map(|k| (f64::from(k % 6) - 2.5, f64::from(k / 6) - 2.5));
    let contacts = "x,y,z\n".to_string() + &places.map(row).collect::<String>();
    std::fs::write(folder.path().join("bowl.csv"), contacts).unwrap();
    let scene = "[surface]\nkind = \"imported\"\nfile = \"saved.json\"\n\n[sweep]\nfingers = [-2.0, 0.0, 2.0]\nfrom = -2.0\nto = 2.0\n\
                 stations = 6\n\n[effects.position_noise]\nsigma = 0.01\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let (code, _, message) = palpate(folder.path(), "fit bowl.csv --degree 2 --save saved.json --quiet");
    assert_eq!(code, Some(0), "{message}");
    folder
}

#[test]
fn two_outputs_of_one_place_are_refused() {
    let folder = workplace();
    let here = folder.path();
    std::fs::create_dir(here.join("out")).unwrap();
    let lines = [
        "study paper-table2 --replicates 50 --records r.csv --part r.csv",
        "study paper-table2 --replicates 50 --records r.csv --checkpoint ./r.csv",
        "study paper-table2 --replicates 50 --out out --part out/study.json",
        "fit bowl.csv --out out --save out/maps.npz",
        "fit bowl.csv --out out --save out/../out/points.csv",
        "parts parts-box --out out --points out/parts.csv",
        "run paper-cylinder --out out --save out/maps.csv",
    ];
    for line in lines {
        let (code, out, message) = palpate(here, line);
        assert!(code == Some(2) && out.is_empty() && message.contains("another"), "{line}: {code:?} {message}");
    }
    assert_eq!(std::fs::read_dir(here.join("out")).unwrap().count(), 0);
    assert!(!here.join("r.csv").exists());
}

#[test]
fn what_a_scene_names_is_an_input() {
    let folder = workplace();
    let here = folder.path();
    let before = std::fs::read(here.join("saved.json")).unwrap();
    let lines = [
        "run scene.toml --save saved.json",
        "study scene.toml --replicates 50 --part saved.json",
        "study scene.toml --replicates 50 --records saved.json",
        "simulate scene.toml -o saved.json",
    ];
    for line in lines {
        let (code, _, message) = palpate(here, line);
        assert_eq!(code, Some(2), "{line}: {message}");
        assert_eq!(std::fs::read(here.join("saved.json")).unwrap(), before, "{line}");
    }
    // in a directory of --out, where the name is one of its own
    std::fs::create_dir(here.join("out")).unwrap();
    std::fs::rename(here.join("saved.json"), here.join("out/fit.json")).unwrap();
    let scene = std::fs::read_to_string(here.join("scene.toml")).unwrap();
    std::fs::write(here.join("scene.toml"), scene.replace("saved.json", "out/fit.json")).unwrap();
    let (code, _, message) = palpate(here, "run scene.toml --out out");
    assert!(code == Some(2) && message.contains("fit.json"), "{message}");
    assert_eq!(std::fs::read(here.join("out/fit.json")).unwrap(), before);
}

#[test]
fn a_kind_of_picture_named_twice_is_one_file() {
    let folder = workplace();
    let (code, _, message) = palpate(folder.path(), "fit bowl.csv --out out --pictures svg,svg --quiet");
    assert_eq!(code, Some(0), "{message}");
    let mut names: Vec<String> = std::fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert!(names.contains(&"shape.svg".to_string()) && names.contains(&"fit.json".to_string()), "{names:?}");
    assert!(names.iter().all(|name| !name.starts_with('.')), "{names:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_and_a_reader_who_has_gone_lose_nothing_silently() {
    let folder = workplace();
    let here = folder.path();
    std::fs::copy(here.join("bowl.csv"), here.join("dish.csv")).unwrap();
    let program = assert_cmd::cargo::cargo_bin("palpate");
    let shell = |line: &str| {
        std::process::Command::new("sh").current_dir(here).env("P", &program).args(["-c", line]).output().unwrap()
    };
    let full = shell("\"$P\" --help > /dev/full");
    assert_eq!(full.status.code(), Some(1), "{}", String::from_utf8_lossy(&full.stderr));
    assert!(String::from_utf8_lossy(&full.stderr).contains("cannot be written"));
    let gone = shell("\"$P\" fit bowl.csv dish.csv --table t.csv | true");
    assert!(here.join("t.csv").exists(), "{}", String::from_utf8_lossy(&gone.stderr));
}

#[cfg(target_os = "linux")]
#[test]
fn what_a_killed_run_left_is_cleared_by_the_next() {
    let folder = workplace();
    let here = folder.path();
    // above the largest number that Linux gives a process
    let left = here.join(format!(".palpate-{}-Abc123", u32::MAX));
    std::fs::create_dir(&left).unwrap();
    std::fs::write(left.join("fit.json"), "half").unwrap();
    let (code, _, message) = palpate(here, "fit bowl.csv --degree 2 --save again.json --quiet");
    assert_eq!(code, Some(0), "{message}");
    assert!(!left.exists());
}

#[test]
fn names_that_reverse_the_text_are_written_out() {
    let folder = workplace();
    let here = folder.path();
    let name = "bowl\u{202e}vsc.csv";
    std::fs::copy(here.join("bowl.csv"), here.join(name)).unwrap();
    let (_, out, message) = palpate(here, &format!("fit {name}"));
    assert!(!format!("{out}{message}").contains('\u{202e}') && out.contains("\\u{202e}"), "{out}{message}");
    let (code, _, message) = palpate(here, "fit no\u{2066}such.csv");
    assert!(code == Some(2) && !message.contains('\u{2066}'), "{message}");
    let (_, _, message) = palpate(here, "fi\u{202e}t");
    assert!(!message.contains('\u{202e}'), "{message}");
}

#[test]
fn far_outside_the_surface_is_undefined_and_no_nan() {
    let folder = workplace();
    let here = folder.path();
    std::fs::write(here.join("far.csv"), "x,y\n1e200,1e200\n0.5,0.5\n").unwrap();
    let (code, out, message) = palpate(here, "show saved.json --at far.csv");
    assert_eq!(code, Some(0), "{message}");
    assert!(!out.contains("NaN") && !out.contains("inf"), "{out}");
    let cells: Vec<usize> = out.lines().map(|line| line.split(',').filter(|cell| cell.is_empty()).count()).collect();
    assert!(cells[1] > 0 && cells[2] == 0, "{out}");
}
