//! Studies end when they are asked to, whatever they compute at that moment, and keep what is done.

use std::io::Read;
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
    // a document is longer than a pipe holds
    let read = |mut from: Box<dyn Read + Send>| {
        std::thread::spawn(move || {
            let mut text = String::new();
            from.read_to_string(&mut text).map(|_| text)
        })
    };
    let (out, err) = (read(Box::new(child.stdout.take().unwrap())), read(Box::new(child.stderr.take().unwrap())));
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return (status.code(), out.join().unwrap().unwrap(), err.join().unwrap().unwrap());
        }
        if began.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it went on");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A ball under three fingers.
const BALL: &str = "name = \"ball\"\n[surface]\nkind = \"sphere\"\nradius = 10.0\n[sweep]\nfingers = [-2.0, 0.0, 2.0]\n\
                    from = -2.0\nto = 2.0\nstations = 5\n[effects.row_noise]\nsigma_z = 0.02\n[fit]\ngrid = [4, 4]\n";

/// A box, a ring and a ball scanned so densely that their shapes take a second, and their parts more than that.
const DENSE: &str = "name = \"things\"\n[surface]\nkind = \"solids\"\n[[surface.parts]]\nkind = \"block\"\n\
                     size = [16.0, 12.0, 10.0]\n[[surface.parts]]\nkind = \"ring\"\nmajor = 6.0\nminor = 2.0\n\
                     offset = [0.0, 0.0, 8.0]\n[[surface.parts]]\nkind = \"ball\"\nradius = 4.0\noffset = [14.0, 0.0, 0.0]\n\
                     [sweep]\npath = \"scan\"\nspacing = 0.1\neye = [50.0, 40.0, 45.0]\n\
                     [effects.position_noise]\nsigma = 0.02\n";

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
    std::fs::write(
        folder.path().join("hoop.toml"),
        RING.replace("stations = 12", "stations = 6").replace("segments = 6", "segments = 4"),
    )
    .unwrap();
    for (signal, line) in [
        ("-INT", "study ring.toml --replicates 100000 --attribution 0"),
        // so many replicates that the linear law is asked for, and so few that it takes nearly all of the time
        ("-TERM", "study hoop.toml --replicates 60 --attribution 0"),
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

/// Sends the signal as soon as it is time, which must be before the line ends by itself: how it ended.
#[cfg(unix)]
fn signalled(
    here: &Path,
    signal: &str,
    line: &str,
    is_time: impl Fn(Duration) -> bool,
) -> (Option<i32>, String, String) {
    let mut child = start(here, line);
    let began = Instant::now();
    while !is_time(began.elapsed()) {
        // short against every stage of the work, so that the gap between two stages is met, too
        std::thread::sleep(Duration::from_micros(200));
        assert!(child.try_wait().unwrap().is_none(), "{line} ended by itself within {:?}", began.elapsed());
    }
    assert!(std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
    ends(child)
}

/// Sends the signal later and later, until standard error says what is `wanted`: what was printed by then, and that message.
/// The times lie close together, so that no stage of the work is stepped over on a quicker or slower machine.
#[cfg(unix)]
fn interrupted(here: &Path, signal: &str, line: &str, wanted: &str) -> (String, String) {
    let times = std::iter::successors(Some(0.5), |seconds| Some(seconds * 1.4)).take_while(|seconds| *seconds < 60.0);
    for time in times.map(Duration::from_secs_f64) {
        let (code, out, message) = signalled(here, signal, line, |elapsed| elapsed >= time);
        // no code: the signal came before the program was ready for it
        assert!(matches!(code, Some(130) | None), "{line}: {code:?} {message}");
        if message.contains(wanted) {
            assert_eq!(code, Some(130), "{line}: {message}");
            assert_eq!(message.matches("interrupted").count(), 1, "{message}");
            return (out, message);
        }
        // too soon for anything to be kept: then nothing is printed, and one line at most says so
        assert!(out.is_empty() && message.lines().count() <= 1, "{line}: {out} {message}");
    }
    panic!("{line}: never said {wanted}");
}

#[cfg(unix)]
#[test]
fn what_was_found_before_an_interrupt_is_kept_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("ball.toml"), BALL).unwrap();
    let simulated = ends(start(here, "simulate ball.toml -o ball.csv"));
    assert_eq!(simulated.0, Some(0), "{}", simulated.2);
    let more = std::fs::read_to_string(here.join("ball.csv")).unwrap();
    let rows: Vec<&str> = more.lines().filter(|row| !row.starts_with('#')).collect();
    // 15 contacts are too few to leave some out
    std::fs::write(here.join("twice.csv"), [&rows[..], &rows[1..]].concat().join("\n")).unwrap();
    for (signal, line, list) in [
        ("-INT", "explore ball.toml --contacts 10000 --per-round 1 --json", "steps"),
        ("-TERM", "frontier ball.toml --all --seconds 600 --json", "points"),
        ("-INT", "frontier ball.toml --seconds 600 --json", "points"),
        ("-TERM", "frontier twice.csv --seconds 600 --json", "points"),
        ("-INT", "study ball.toml --replicates 1000000 --coverage --json", "scenes"),
    ] {
        let (out, message) = interrupted(here, signal, line, "interrupted after");
        let document: serde_json::Value = serde_json::from_str(&out).unwrap();
        let done = document[list].as_array().unwrap().len();
        assert!(done > 0 && message.contains("kept"), "{line}: {message}");
        if list == "points" {
            assert!(message.contains(&format!("after {done} points")), "{message}");
        }
        if list == "scenes" {
            let replicates = document["replicates"].as_u64().unwrap();
            assert!(message.contains(&format!("after {replicates} of 1000000 replicates")), "{message}");
        }
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_before_the_parts_are_known_says_what_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("dense.toml"), DENSE).unwrap();
    let (out, _) =
        interrupted(here, "-TERM", "parts dense.toml --json", "before the parts were known; nothing is kept");
    assert!(out.is_empty(), "{out}");
    let line = "parts dense.toml --points p.csv --json";
    let (code, out, message) = signalled(here, "-INT", line, |_| here.join("p.csv").exists());
    assert_eq!(code, Some(130), "{message}");
    assert!(message.contains("before the parts were known; the shape of every point is kept in p.csv"), "{message}");
    assert!(out.is_empty() && std::fs::read_to_string(here.join("p.csv")).unwrap().lines().count() > 1000);
}

/// What is started with a signal ignored goes on when that one comes, and keeps what it has when another comes.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_that_is_ignored_stays_so_and_the_others_are_heeded() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.toml"), BALL).unwrap();
    for (ignored, heeded) in [("HUP", "INT"), ("HUP", "TERM"), ("INT", "HUP"), ("INT QUIT", "TERM")] {
        // a busy machine may have nothing to keep by then
        let kept = [3, 12, 40].into_iter().any(|seconds| {
            let (code, out, message) = signalled_beside(folder.path(), ignored, heeded, Duration::from_secs(seconds));
            let is_kept = message.contains("interrupted after") && message.contains("kept");
            if is_kept {
                assert_eq!(code, Some(130), "{ignored} ignored, {heeded} sent: {message}");
                assert!(serde_json::from_str::<serde_json::Value>(&out).unwrap()["replicates"].as_u64().unwrap() > 0);
            }
            is_kept
        });
        assert!(kept, "{ignored} ignored, {heeded} sent: nothing is kept");
    }
}

/// How a study ends that ignores some signals, of which the first is sent after so long, and a second later the one that it heeds.
#[cfg(target_os = "linux")]
fn signalled_beside(here: &Path, ignored: &str, heeded: &str, wait: Duration) -> (Option<i32>, String, String) {
    let program = assert_cmd::cargo::cargo_bin("palpate");
    let line = "study ball.toml --replicates 1000000 --coverage --json";
    let mut child = std::process::Command::new("sh")
        .current_dir(here)
        .args(["-c", &format!("trap '' {ignored}; exec {} {line}", program.display())])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let of = child.id().to_string();
    let send = |signal: &str| {
        assert!(std::process::Command::new("kill").args(["-s", signal, of.as_str()]).status().unwrap().success());
    };
    std::thread::sleep(wait);
    ignored.split(' ').take(1).for_each(send);
    std::thread::sleep(Duration::from_secs(1));
    assert!(child.try_wait().unwrap().is_none(), "{ignored} ended it");
    send(heeded);
    ends(child)
}
