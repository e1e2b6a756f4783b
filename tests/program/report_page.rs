//! `report.html`: stands by itself, stays small, keeps markup harmless, and reads back to the same bits.

use std::path::Path;

use serde_json::Value;

/// Standard output of a run that must succeed.
fn text(directory: &Path, arguments: &[&str]) -> String {
    let mut command = assert_cmd::Command::cargo_bin("palpate").unwrap();
    let assert = command.current_dir(directory).args(arguments).assert().success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&text(directory, &[arguments, &["--json"]].concat())).unwrap()
}

/// Bytes of the largest page less its data: the promise is 1 MB.
const MOST_BYTES: usize = 1_000_000;

fn page(directory: &Path, folder: &str) -> String {
    std::fs::read_to_string(directory.join(folder).join("report.html")).unwrap()
}

/// The scripts' and the style's own text, and everything else.
fn without_scripts(page: &str) -> String {
    let mut out = String::new();
    let mut rest = page;
    while let Some((before, after)) = rest.split_once("<script") {
        out.push_str(before);
        rest = after.split_once("</script>").map_or("", |(_, rest)| rest);
    }
    out + rest
}

/// Bytes of the data that a page embeds.
fn data(page: &str) -> usize {
    page.split("<script type=\"application/json\"")
        .skip(1)
        .map(|part| part.split("</script>").next().unwrap().len())
        .sum()
}

fn assert_stands_alone(page: &str) {
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"));
    assert!(page.contains("default-src 'none'") && !page.contains("connect-src"));
    let markup = without_scripts(page);
    for load in
        ["src=\"", "http:", "https:", "url(", "@import", "<link rel=\"stylesheet", "<iframe", "<object", "<embed"]
    {
        assert!(!markup.contains(load), "{load}");
    }
    // what is linked is a mark of the page itself, or data
    for (at, _) in markup.match_indices("href=\"") {
        let rest = &markup[at + 6..];
        assert!(rest.starts_with('#') || rest.starts_with("data:"), "{}", &rest[..40.min(rest.len())]);
    }
    assert!(page.len() - data(page) < MOST_BYTES, "{} bytes", page.len() - data(page));
    // a tag within a script would end it early
    let [open, close] = ["<script", "</script>"].map(|tag| page.matches(tag).count());
    assert_eq!(open, close);
}

#[test]
fn every_verb_writes_a_page_that_stands_alone() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    text(at, &["simulate", "paper-cylinder", "-o", "c.csv"]);
    std::fs::write(at.join("p.csv"), "x,y\n0,0\n1,1\n").unwrap();
    text(at, &["run", "paper-cylinder", "--out", "run"]);
    text(at, &["fit", "c.csv", "--out", "fit"]);
    text(at, &["fit", "c.csv", "--degree", "2", "--out", "named"]);
    text(at, &["show", "run/fit.json", "--out", "show"]);
    text(at, &["show", "run/fit.json", "--at", "p.csv", "--out", "points"]);
    let study = ["study", "paper-table2", "--replicates", "2000"];
    text(at, &[&study[..], &["--attribution", "0", "--out", "study"]].concat());
    let sweep = ["--sweep", "surface.radius=5:20:lin3", "--out", "sweep"];
    text(at, &[&study[..], &sweep].concat());
    text(at, &["explore", "paper-table2", "--contacts", "40", "--out", "explore"]);
    text(at, &["parts", "parts-box", "--out", "parts"]);
    for (folder, words) in [
        ("run", "like the outside of a pipe"),
        ("fit", "Standard uncertainty"),
        ("named", "Residuals"),
        ("show", "not saved with the surface"),
        ("points", "points that were asked for"),
        ("study", "How the measurements scatter"),
        ("sweep", "surface.radius"),
        ("explore", "How the uncertainty fell"),
        ("parts", "Where they lie and how large they are"),
    ] {
        let page = page(at, folder);
        assert!(page.contains(words), "{folder}");
        assert_stands_alone(&page);
    }
    // the library for drawing in space is there only where something stands in space
    assert!(page(at, "run").contains("three.js") && !page(at, "study").contains("three.js"));
    // what stands below it waits for its buttons, and for nothing where there is no script
    for folder in ["run", "parts", "study"] {
        let page = page(at, folder);
        let waits = page.contains("<body class=\"waiting\">");
        assert!(waits == (folder != "study") && page.contains("<noscript><style>.waiting #space ~ *"), "{folder}");
    }
    // a part that is known to 1e-4 shows no digits beyond, and no switch for contacts in no part where there are none
    let parts = page(at, "parts");
    assert!(!without_scripts(&parts).contains("e-5,") && parts.contains("\"left\":false"));
    // the axis stands beside the radius, with its bounds where the surface was recognised
    assert!(page(at, "fit").contains("Axis, degrees") && page(at, "fit").contains("from x towards y"));
    // the radius of a named fit has the bounds that R gives it
    assert!(page(at, "run").contains("Its radius is 6.948 (between 6.60 and 6.95, 95 % sure)"));
}

#[test]
fn a_page_reads_back_to_the_same_bits() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    for (name, arguments) in [("run", &["run"][..]), ("space", &["run", "around-cylinder"])] {
        text(at, &[arguments, &["--out", name]].concat());
        let (file, page) = (format!("{name}/fit.json"), format!("{name}/report.html"));
        let (from_file, from_page): (Value, Value) = (json(at, &["show", &file]), json(at, &["show", &page]));
        for part in ["surface", "frame", "fit", "shape"] {
            assert_eq!(from_file[part], from_page[part], "{name}: {part}");
        }
        let saved: Value = serde_json::from_slice(&std::fs::read(at.join(&file)).unwrap()).unwrap();
        assert_eq!(from_page["surface"], saved["surface"], "{name}");
        let [a, b] =
            [&file, &page].map(|file| text(at, &["show", file]).lines().skip(1).collect::<Vec<_>>().join("\n"));
        assert_eq!(a, b);
    }
    // values at points come from the page's surface, too
    std::fs::write(at.join("p.csv"), "x,y\n0.1,0.2\n1,-1\n").unwrap();
    let at_points = |file: &str| text(at, &["show", file, "--at", "p.csv"]);
    assert_eq!(at_points("run/fit.json"), at_points("run/report.html"));
}

#[test]
fn pages_without_a_surface_give_back_their_document_and_their_table() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let printed = text(at, &["study", "paper-table2", "--replicates", "2000", "--out", "d"]);
    let saved: Value = serde_json::from_slice(&std::fs::read(at.join("d/study.json")).unwrap()).unwrap();
    assert_eq!(json(at, &["show", "d/report.html"]), saved);
    let shown = text(at, &["show", "d/report.html"]);
    let first = |text: &str| text.lines().next().unwrap().to_string();
    assert_eq!(first(&shown), first(&printed));
    std::fs::write(at.join("p.csv"), "x,y\n0,0\n").unwrap();
    let mut refused = assert_cmd::Command::cargo_bin("palpate").unwrap();
    let refused = refused.current_dir(at).args(["show", "d/report.html", "--at", "p.csv"]).assert().code(2);
    let message = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(message.contains("holds a study") && message.contains("--at"), "{message}");
}

#[test]
fn markup_in_names_is_harmless() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let name = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\\u202e\\u001b[31m";
    let long = "n".repeat(10_000);
    let body = "[surface]\nkind = \"sphere\"\nradius = 10.0\n[sweep]\nfingers = [-2.0, 0.0, 2.0]\nfrom = -2.0\nto = 2.0\nstations = 6\n";
    for (file, name) in [("markup.toml", name), ("long.toml", &long)] {
        std::fs::write(at.join(file), format!("name = \"{name}\"\n{body}")).unwrap();
    }
    for (scene, folder) in [("markup.toml", "markup"), ("long.toml", "long")] {
        text(at, &["run", scene, "--out", folder]);
        let page = page(at, folder);
        assert_stands_alone(&page);
        let markup = without_scripts(&page);
        assert!(!markup.contains("<img") && !page.contains("alert(1)</script>"), "{folder}");
        assert!(!page.contains('\u{202e}') && !page.contains('\u{1b}'), "{folder}");
        let saved: Value = serde_json::from_slice(&std::fs::read(at.join(folder).join("fit.json")).unwrap()).unwrap();
        assert_eq!(json(at, &["show", &format!("{folder}/report.html")])["surface"], saved["surface"]);
    }
    let heading = page(at, "long");
    let heading = heading.split("<h1>").nth(1).unwrap().split("</h1>").next().unwrap();
    assert!(heading.len() < 120, "{}", heading.len());
}

#[test]
fn other_pages_and_cut_ones_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    text(at, &["run", "--out", "d"]);
    let whole = page(at, "d");
    let within = whole.find("\"coefficients\"").unwrap();
    for (content, word) in
        [("<html><body>no page of ours</body></html>", "report.html"), (&whole[..within], "ends within")]
    {
        std::fs::write(at.join("p.html"), content).unwrap();
        let mut command = assert_cmd::Command::cargo_bin("palpate").unwrap();
        let refused = command.current_dir(at).args(["show", "p.html"]).assert().code(2);
        let message = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(message.contains("p.html") && message.contains(word), "{message}");
    }
}

/// Ctrl-C while a study runs: exit 130, and what was done by then stands in the directory, which says so.
#[cfg(unix)]
#[test]
fn an_interrupted_study_keeps_what_there_was() {
    use std::process::{Command, Stdio};
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    // a shell that runs the tests in the background may have told its children to ignore the signal
    let mut command = Command::new("env");
    if cfg!(target_os = "linux") {
        command.arg("--default-signal");
    }
    let mut child = command
        .arg(assert_cmd::cargo::cargo_bin("palpate"))
        .current_dir(at)
        .args(["study", "paper-table2", "--replicates", "4000000000", "--attribution", "0"])
        .args(["--checkpoint", "c.study", "--out", "d", "--quiet"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // the first checkpoint says that the study runs
    while !at.join("c.study").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "ended before it could be interrupted");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let ended = child.wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(130), "{message}");
    assert!(message.contains("interrupted after"), "{message}");
    let document: Value = serde_json::from_slice(&std::fs::read(at.join("d/study.json")).unwrap()).unwrap();
    assert_eq!(document["stopped"], "interrupted");
    assert!(document["replicates"].as_u64().is_some_and(|done| done > 0));
    let page = page(at, "d");
    assert!(page.contains("class=\"notice\"") && page.contains("of 4000000000 replicates are done"));
    assert_eq!(json(at, &["show", "d/report.html"])["stopped"], "interrupted");
}
