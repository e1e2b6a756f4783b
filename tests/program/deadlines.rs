//! Studies end when they are asked to, whatever they compute at that moment, and keep what is done.

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A ring felt all round: one whole fit takes seconds, the linear law hundreds of them.
const RING: &str = "[surface]\nkind = \"torus\"\nmajor = 8.0\nminor = 3.0\n\n[sweep]\npath = \"around\"\nfingers = [0.0, 45.0, 90.0, 135.0, \
                    180.0, 225.0, 270.0, 315.0]\nstations = 12\n\n[effects.position_noise]\nsigma = 0.02\n\n[fit]\nsurface = \"parametric\"\nclosed = \
                    \"u,v\"\ndegree = 3\nsegments = 6\nsigma = [0.02, 1.7]\ngrid = [8, 8]\n";

fn start(here: &Path, line: &str) -> Child {
    std::process::Command::new(assert_cmd::cargo::cargo_bin("palpate"))
        .current_dir(here)
        .args(line.split_whitespace())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// A minute stands for "at once": without a deadline these studies take many minutes of two processors.
fn ends(mut child: Child) -> (Option<i32>, String, String) {
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            let output = child.wait_with_output().unwrap();
            let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
            return (status.code(), text(output.stdout), text(output.stderr));
        }
        if began.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it went on");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_budget_ends_whole_fits_and_the_linear_law() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ring.toml"), RING).unwrap();
    let (code, out, message) = ends(start(folder.path(), "study ring.toml --replicates 100000 --budget 1 --json"));
    assert_eq!(code, Some(0), "{message}");
    assert!(out.contains("left out, because the budget was over"), "{out}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_whole_fits_and_what_is_computed_of_them() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ring.toml"), RING).unwrap();
    for (signal, line) in [
        ("-INT", "study ring.toml --replicates 100000 --attribution 0"),
        ("-TERM", "study ring.toml --replicates 2 --attribution 0"),
        ("-INT", "study ring.toml --sweep effects.position_noise.sigma=0.01,0.02 --replicates 1000"),
    ] {
        let child = start(folder.path(), line);
        std::thread::sleep(Duration::from_secs(3));
        let sent = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let (code, _, message) = ends(child);
        assert!(matches!(code, Some(0 | 130)), "{line}: {code:?} {message}");
    }
}
