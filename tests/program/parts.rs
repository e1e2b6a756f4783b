//! `palpate parts`: scenes beside their truth, files of every kind, and what is refused.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

fn palpate(folder: &Path, line: &str) -> Output {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(folder).args(line.split_whitespace()).output().unwrap()
}

fn document(folder: &Path, line: &str) -> Value {
    let output = palpate(folder, &format!("{line} --json"));
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// `kind, kind, ...` and `a-b kind, ...`, in an order of their own.
fn summary(found: &Value) -> (Vec<String>, Vec<String>) {
    let mut kinds: Vec<String> =
        found["parts"].as_array().unwrap().iter().map(|p| p["kind"].as_str().unwrap().to_string()).collect();
    let mut joints: Vec<String> = found["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|joint| {
            let mut pair: Vec<&str> = (0..2)
                .map(|k| found["parts"][joint["parts"][k].as_u64().unwrap() as usize]["kind"].as_str().unwrap())
                .collect();
            pair.sort_unstable();
            format!("{} {}", pair.join("-"), joint["kind"].as_str().unwrap())
        })
        .collect();
    kinds.sort();
    joints.sort();
    (kinds, joints)
}

#[test]
fn every_scene_of_parts_is_taken_apart() {
    let folder = tempfile::tempdir().unwrap();
    // what simple bodies come to shows with a third of their contacts, too
    let cases: [(&str, &str, &[&str], &[&str]); 5] = [
        ("parts-box", "0.85", &["plane"; 3], &["plane-plane convex"; 3]),
        (
            "parts-capsule",
            "0.8",
            &["cylinder", "plane", "sphere"],
            &["cylinder-plane convex", "cylinder-sphere smooth"],
        ),
        (
            "parts-cone",
            "1.0",
            &["cone", "cylinder", "plane", "plane"],
            &["cone-cylinder convex", "cone-plane convex", "cylinder-plane convex"],
        ),
        (
            "parts-mug",
            "0.7",
            &["cylinder", "cylinder", "plane", "plane", "plane", "torus"],
            &[
                "cylinder-plane concave",
                "cylinder-plane convex",
                "cylinder-plane convex",
                "cylinder-plane convex",
                "cylinder-torus concave",
            ],
        ),
        (
            "parts-pipe",
            "0.6",
            &["cylinder", "cylinder", "plane", "plane", "torus"],
            &[
                "cylinder-plane convex",
                "cylinder-plane convex",
                "cylinder-plane convex",
                "cylinder-plane convex",
                "cylinder-torus convex",
            ],
        ),
    ];
    for (scene, spacing, kinds, joints) in cases {
        let text = String::from_utf8(palpate(folder.path(), &format!("scenes {scene}")).stdout).unwrap();
        let own = text.lines().find(|line| line.starts_with("spacing = ")).unwrap();
        let coarser = text.replace(own, &format!("spacing = {spacing}"));
        std::fs::write(folder.path().join("scene.toml"), coarser).unwrap();
        let found = document(folder.path(), "parts scene.toml");
        let (found_kinds, found_joints) = summary(&found);
        assert_eq!(found_kinds, kinds, "{scene}");
        assert_eq!(found_joints, joints, "{scene}");
        assert!(found["truth"]["right"].as_f64().unwrap() > 0.985, "{scene}: {}", found["truth"]["right"]);
        assert!(found["truth"]["boundary_error"].as_f64().unwrap() < 0.5, "{scene}");
    }
}

#[test]
fn the_table_says_size_joints_and_truth_in_plain_words() {
    let folder = tempfile::tempdir().unwrap();
    let output = palpate(folder.path(), "parts parts-capsule");
    let text = String::from_utf8(output.stdout).unwrap();
    for words in [
        "3 of capped cylinder",
        "radius 5.00",
        "smooth, the normal turns by",
        "of the contacts in the part of their face",
    ] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
}

#[test]
fn the_directory_gets_a_document_a_table_and_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    assert!(palpate(folder.path(), "parts parts-box --out made --quiet").stdout.is_empty());
    let made = |name: &str| std::fs::read_to_string(folder.path().join("made").join(name)).unwrap();
    let document: Value = serde_json::from_str(&made("parts.json")).unwrap();
    let rows = made("parts.csv");
    assert_eq!(rows.lines().count() as u64, document["contacts"].as_u64().unwrap() + 1);
    assert!(made("parts.svg").contains("3 parts from both sides"));
}

#[test]
fn a_file_without_normals_is_taken_apart_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    assert!(palpate(folder.path(), "simulate parts-box -o box.csv").status.success());
    let text = std::fs::read_to_string(folder.path().join("box.csv")).unwrap();
    let bare: Vec<String> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').take(3).collect::<Vec<_>>().join(","))
        .collect();
    std::fs::write(folder.path().join("bare.csv"), bare.join("\n")).unwrap();
    let found = document(folder.path(), "parts bare.csv");
    assert!(found["notes"].to_string().contains("there are no normals"), "{}", found["notes"]);
    let (kinds, joints) = summary(&found);
    assert_eq!(kinds, ["plane"; 3]);
    assert_eq!(joints, ["plane-plane convex"; 3]);
}

#[test]
fn normals_of_mixed_side_are_turned_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    assert!(palpate(folder.path(), "simulate parts-cone -o cone.csv").status.success());
    let text = std::fs::read_to_string(folder.path().join("cone.csv")).unwrap();
    let mut rows = 0;
    let mut flipped = String::new();
    for line in text.lines() {
        let numbers: Result<Vec<f64>, _> = line.split(',').map(str::parse::<f64>).collect();
        match numbers {
            Ok(mut numbers) => {
                rows += 1;
                if rows % 10 == 0 {
                    (3..6).for_each(|k| numbers[k] = -numbers[k]);
                }
                flipped += &numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            }
            Err(_) => flipped += line,
        }
        flipped.push('\n');
    }
    std::fs::write(folder.path().join("mixed.csv"), flipped).unwrap();
    let found = document(folder.path(), "parts mixed.csv");
    let note = format!("{} of {rows} normals point to the other side", rows / 10);
    assert!(found["notes"].to_string().contains(&note), "{}", found["notes"]);
    assert_eq!(summary(&found).0, ["cone", "cylinder", "plane", "plane"]);
}

#[test]
fn bad_usage_and_bad_input_name_the_place_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("one.csv", "x,y,z\n1,2,3\n");
    write("same.csv", &format!("x,y,z\n{}", "1,2,3\n".repeat(50)));
    let random = |k: u64| (k as f64 * 0.618).fract() - 0.5;
    let rows: String = (0..400_u64)
        .map(|k| {
            format!("{},{},0,{},{},{}\n", k % 20, k / 20, random(7 * k), random(11 * k + 3), random(5 * k * k + 1))
        })
        .collect();
    write("noise.csv", &format!("x,y,z,nx,ny,nz\n{rows}"));
    write(
        "bad.toml",
        "[surface]\nkind = \"solids\"\n[[surface.parts]]\nkind = \"bal\"\nradius = 1.0\n[sweep]\npath = \"scan\"\nspacing = 0.1\n",
    );
    write("sphere.toml", "[surface]\nkind = \"sphere\"\nradius = 1.0\n[sweep]\npath = \"scan\"\nspacing = 0.1\n");
    let cases = [
        ("parts one.csv", "1 contact cannot be cut into parts"),
        ("parts same.csv", "no extent"),
        ("parts noise.csv", "no normals of a surface"),
        ("parts parts-box --tolerance -1", "--tolerance -1: a length"),
        ("parts one.csv --seed 3", "--seed is for scenes"),
        ("parts nothing.csv", "nothing.csv"),
        ("parts bad.toml", "ball"),
        ("parts sphere.toml", "only solids are scanned"),
    ];
    for (line, words) in cases {
        let output = palpate(folder.path(), line);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.stdout.len(), output.status.code()), (0, Some(2)), "{line}: {told}");
        assert!(told.contains(words), "{line}: {told}");
    }
}

/// A ball of radius 5, all round.
fn ball(with_normals: bool) -> String {
    let mut text = String::from(if with_normals { "x,y,z,nx,ny,nz\n" } else { "x,y,z\n" });
    for k in 0..600 {
        let (z, angle): (f64, f64) = ((f64::from(k) + 0.5) / 300.0 - 1.0, 2.399_963 * f64::from(k));
        let rho = (1.0 - z * z).sqrt();
        let [x, y] = [rho * angle.cos(), rho * angle.sin()];
        text.push_str(&format!("{},{},{}", 5.0 * x, 5.0 * y, 5.0 * z));
        text.push_str(&if with_normals { format!(",{x},{y},{z}\n") } else { "\n".into() });
    }
    text
}

#[test]
fn every_point_of_a_closed_body_gets_its_shape() {
    let folder = tempfile::tempdir().unwrap();
    for (file, with_normals) in [("ball.csv", true), ("bare.csv", false)] {
        std::fs::write(folder.path().join(file), ball(with_normals)).unwrap();
        for ending in ["csv", "npz", "ply", "parquet"] {
            let output = palpate(folder.path(), &format!("parts {file} --points shape.{ending}"));
            let text = String::from_utf8(output.stdout).unwrap();
            assert!(output.status.success() && text.starts_with("points     600 of"), "{text}");
            assert_eq!(text.contains("there are no normals"), !with_normals, "{text}");
        }
        let written = std::fs::read_to_string(folder.path().join("shape.csv")).unwrap();
        assert!(written.starts_with("x,y,z,nx,ny,nz,k1,k2,S,R,u_S,u_R\n"));
        for line in written.lines().skip(1) {
            let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
            assert!((row[8] - 1.0).abs() < 0.05 && (row[9] - 0.2).abs() < 0.02, "{file}: {line}");
        }
        // what was written is a cloud that can be read
        assert!(palpate(folder.path(), "parts shape.ply --points again.csv --quiet").status.success());
        assert!(palpate(folder.path(), "parts shape.npz --points again.csv --quiet").status.success());
    }
    let printed = palpate(folder.path(), "parts ball.csv --points -");
    assert_eq!(String::from_utf8(printed.stdout).unwrap().lines().count(), 601);
    assert!(document(folder.path(), "parts ball.csv --points both.csv")["parts"].is_array());
}

#[test]
fn shapes_of_points_go_to_files_that_have_a_meaning() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.csv"), ball(true)).unwrap();
    for (line, words) in [
        ("parts ball.csv --points shape.txt", ".csv, .npz, .ply or .parquet"),
        ("parts ball.csv --points - --json", "both want standard output"),
        ("parts ball.csv --points ball.csv", "it is the input"),
    ] {
        let output = palpate(folder.path(), line);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(words), "{line}: {said}");
    }
}

/// A capsule's ball lies on the axis of its bar and is as wide; the graphs tell the same.
#[test]
fn relations_tie_what_the_makers_tied() {
    let folder = tempfile::tempdir().unwrap();
    let found = document(folder.path(), "parts parts-capsule");
    let kind = |id: &Value| found["parts"][id.as_u64().unwrap() as usize]["kind"].as_str().unwrap();
    let mut ties: Vec<String> = (found["relations"].as_array().unwrap().iter())
        .map(|relation| {
            assert!(relation["probability"].as_f64().unwrap() > 0.95, "{relation}");
            let mut pair = [0, 1].map(|k| kind(&relation["parts"][k]));
            pair.sort_unstable();
            format!("{} {}", pair.join("-"), relation["kind"].as_str().unwrap())
        })
        .collect();
    ties.sort();
    assert_eq!(ties, ["cylinder-plane perpendicular", "cylinder-sphere coaxial", "cylinder-sphere equal_radius"]);
    let output = palpate(folder.path(), "parts parts-capsule --out out");
    assert!(output.status.success());
    let words = String::from_utf8(output.stdout).unwrap();
    assert!(words.contains("relation   coaxial: 0 and 1 (more than 99 %)"), "{words}");
    let made = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let edges = found["joints"].as_array().unwrap().len() + ties.len();
    assert_eq!(made("parts.dot").matches(" -- ").count(), edges);
    assert_eq!(made("parts.graphml").matches("<edge ").count(), edges);
    assert!(made("report.html").contains("What ties them"));
    let step = made("parts.step");
    for surface in ["PLANE(", "CYLINDRICAL_SURFACE(", "SPHERICAL_SURFACE("] {
        assert_eq!(step.matches(surface).count(), 1, "{surface}");
    }
    assert_eq!(step.matches("ADVANCED_FACE('").count(), 3);
    every_instance_stands(&step);
}

/// What a line of a STEP file names stands in a line before it.
fn every_instance_stands(step: &str) {
    let mut known = std::collections::HashSet::new();
    for line in step.lines().filter(|line| line.starts_with('#')) {
        let (own, entity) = line.split_once('=').unwrap();
        let named = entity.split('#').skip(1).map(|rest| rest.split(|c: char| !c.is_ascii_digit()).next().unwrap());
        for number in named {
            assert!(known.contains(number), "#{number} in {line}");
        }
        assert!(known.insert(own[1..].to_string()), "{own} stands twice");
    }
}

/// A scan of the mug with a seed of its own is the mug of a library, as a document and as a scene; a capsule is none of them.
#[test]
fn a_library_tells_which_object_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    std::fs::create_dir(root.join("known")).unwrap();
    assert!(palpate(root, "parts parts-mug --out mug --quiet").status.success());
    std::fs::copy(root.join("mug/parts.json"), root.join("known/mug.json")).unwrap();
    let scene = palpate(root, "scenes parts-cone");
    std::fs::write(root.join("known/cone.toml"), scene.stdout).unwrap();
    let found = document(root, "parts parts-mug --seed 77 --library known");
    let objects = found["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 3, "{objects:?}");
    assert_eq!(objects[0]["name"], "mug");
    assert!(objects[0]["probability"].as_f64().unwrap() > 0.95, "{objects:?}");
    assert_eq!(objects[0]["pairs"].as_array().unwrap().len(), found["parts"].as_array().unwrap().len());
    let other = palpate(root, "parts parts-capsule --library known");
    let words = String::from_utf8(other.stdout).unwrap();
    assert!(words.contains("object     none of the library ("), "{words}");
}

#[test]
fn a_library_that_is_none_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    std::fs::create_dir(root.join("empty")).unwrap();
    std::fs::create_dir(root.join("wrong")).unwrap();
    std::fs::write(root.join("wrong/note.json"), "{\"schema\": \"palpate.fit/1\"}").unwrap();
    for (library, words) in [("nowhere", "cannot be read"), ("empty", "has no files"), ("wrong", "note.json")] {
        let refused = palpate(root, &format!("parts parts-box --library {library}"));
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(words) && said.contains(library), "{said}");
    }
}
