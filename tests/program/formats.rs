//! Surfaces for other tools: what stands in the files, what is refused, and STEP and IGES back to the same bits. Other
//! programs open them in `tests/formats/read_back.py`.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn palpate(here: &Path, line: &str) -> (i32, String, String) {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn done(here: &Path, line: &str) -> String {
    let (code, out, message) = palpate(here, line);
    assert_eq!(code, 0, "{line}: {message}");
    out
}

fn refused(here: &Path, line: &str, words: &[&str]) {
    let (code, _, message) = palpate(here, line);
    assert_eq!(code, 2, "{line}: {message}");
    words.iter().for_each(|word| assert!(message.contains(word), "{line}: {word} is not in {message}"));
}

fn surface(path: &Path) -> Value {
    serde_json::from_slice::<Value>(&std::fs::read(path).unwrap()).unwrap()["surface"].take()
}

/// A height field with interior knots, and a surface in space that is closed in no direction.
const SURFACES: [&str; 2] =
    ["run paper-table2 --degree 3 --segments 2x3", "run paper-fig6-r5.7-degree3 --surface parametric"];

#[test]
fn splines_come_back_from_cad_files_to_the_same_bits() {
    for line in SURFACES {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        done(here, &format!("{line} --quiet --save s.json"));
        let saved = surface(&here.join("s.json"));
        for ending in ["step", "igs"] {
            done(here, &format!("show s.json --save s.{ending} --quiet"));
            done(here, &format!("show s.{ending} --save again.json"));
            let again = surface(&here.join("again.json"));
            for key in ["kind", "degree", "knots", "coefficients"] {
                assert_eq!(again[key], saved[key], "{line}, {ending}: {key}");
            }
            // the same spline from the fit and from the saved surface; only titles differ
            done(here, &format!("{line} --quiet --save direct.{ending}"));
            let [a, b] = ["s", "direct"].map(|name| {
                let text = std::fs::read_to_string(here.join(format!("{name}.{ending}"))).unwrap();
                let is_spline =
                    |line: &&str| line.contains("SPLINE") || line.contains("_POINT") || line.get(72..73) == Some("P");
                text.lines().filter(is_spline).map(String::from).collect::<Vec<String>>()
            });
            assert!(a == b && a.len() > 5, "{line}, {ending}");
        }
        let text = std::fs::read_to_string(here.join("s.step")).unwrap();
        for word in ["FILE_SCHEMA(('AUTOMOTIVE_DESIGN", "B_SPLINE_SURFACE_WITH_KNOTS", "ADVANCED_FACE", "OPEN_SHELL"] {
            assert!(text.contains(word), "{word}");
        }
        let text = std::fs::read_to_string(here.join("s.igs")).unwrap();
        assert!(text.lines().all(|record| record.len() == 80));
    }
}

#[test]
fn meshes_hold_the_points_that_their_headers_say() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(here, "run paper-table2 --quiet --save s.json");
    for ending in ["ply", "obj", "stl", "glb", "vtu", "parquet", "npz"] {
        done(here, &format!("show s.json --grid 5x4 --save s.{ending}"));
    }
    let (points, triangles) = (20, 24);
    let read = |ending: &str| std::fs::read(here.join(format!("s.{ending}"))).unwrap();
    let ply = read("ply");
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let head = String::from_utf8(ply[..end].to_vec()).unwrap();
    assert!(head.contains("element vertex 20") && head.contains("element face 24"), "{head}");
    let doubles = head.matches("property double").count();
    assert!(head.contains("property double u_S") && doubles == 16, "{head}");
    assert_eq!(ply.len() - end, points * doubles * 8 + triangles * 13);
    // the corner of the domain, to the bit
    let x = f64::from_le_bytes(ply[end..end + 8].try_into().unwrap());
    assert_eq!(x, surface(&here.join("s.json"))["knots"][0][0].as_f64().unwrap());
    let obj = String::from_utf8(read("obj")).unwrap();
    let count = |mark: &str| obj.lines().filter(|line| line.starts_with(mark)).count();
    assert_eq!([count("v "), count("vn "), count("f ")], [points, points, triangles]);
    let stl = read("stl");
    assert_eq!(stl.len(), 84 + 50 * triangles);
    assert_eq!(u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize, triangles);
    let glb = read("glb");
    assert!(glb.starts_with(b"glTF"));
    assert_eq!(u32::from_le_bytes(glb[8..12].try_into().unwrap()) as usize, glb.len());
    let json = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let document: Value = serde_json::from_slice(&glb[20..20 + json]).unwrap();
    assert_eq!(document["accessors"][0]["count"], points);
    let vtu = String::from_utf8(read("vtu")).unwrap();
    assert!(vtu.contains("NumberOfPoints=\"20\" NumberOfCells=\"24\"") && vtu.contains("Name=\"u_normal_deg\""));
    let parquet = read("parquet");
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    // what is written as contacts elsewhere is read as contacts here
    let fitted: Value = serde_json::from_str(&done(here, "fit s.ply --degree 2 --json")).unwrap();
    assert_eq!(fitted["contacts"], points);
}

/// Normals turn to the free side, and every triangle turns with them.
#[test]
fn triangles_turn_to_the_free_side() {
    for line in SURFACES {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        done(here, &format!("{line} --quiet --grid 9 --save s.obj"));
        let text = std::fs::read_to_string(here.join("s.obj")).unwrap();
        let numbers = |mark: &str| -> Vec<[f64; 3]> {
            let lines = text.lines().filter_map(|line| line.strip_prefix(mark));
            lines.map(|l| l.split(' ').map(|v| v.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap()).collect()
        };
        let (points, normals) = (numbers("v "), numbers("vn "));
        assert!(!points.is_empty() && points.len() == normals.len());
        for face in text.lines().filter_map(|line| line.strip_prefix("f ")) {
            let at: Vec<usize> =
                face.split(' ').map(|c| c.split('/').next().unwrap().parse::<usize>().unwrap() - 1).collect();
            let edge = |k: usize| -> [f64; 3] { std::array::from_fn(|d| points[at[k]][d] - points[at[0]][d]) };
            let (a, b, n) = (edge(1), edge(2), normals[at[0]]);
            let turned = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            assert!((0..3).map(|d| turned[d] * n[d]).sum::<f64>() > 0.0, "{line}: {face}");
        }
    }
}

/// Contacts on a disc: corners of the box have no triangles, in every way to the mesh.
#[test]
fn meshes_are_cut_where_contacts_end() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut csv = String::from("x,y,z\n");
    for i in -10_i32..=10 {
        for j in (-10_i32..=10).filter(|j| i * i + j * j <= 100) {
            let (x, y) = (f64::from(i) * 0.1, f64::from(j) * 0.1);
            csv.push_str(&format!("{x},{y},{}\n", 0.1 * x * x + 0.05 * y * y));
        }
    }
    std::fs::write(here.join("disc.csv"), csv).unwrap();
    for model in ["--degree 2", ""] {
        done(here, &format!("fit disc.csv {model} --quiet --save disc.json"));
        assert!(surface(&here.join("disc.json"))["support_map"].is_array());
        for way in [format!("fit disc.csv {model} --quiet --save disc.obj"), "show disc.json --save disc.obj".into()] {
            done(here, &way);
            let text = std::fs::read_to_string(here.join("disc.obj")).unwrap();
            let points = text.lines().filter_map(|line| line.strip_prefix("v "));
            let farthest = points.map(|line| {
                let v: Vec<f64> = line.split(' ').map(|v| v.parse().unwrap()).collect();
                v[0].hypot(v[1])
            });
            let farthest = farthest.fold(0.0, f64::max);
            assert!((1.0..1.3).contains(&farthest), "{way}: {farthest}");
        }
        let (_, _, message) = palpate(here, "show disc.json --save disc.step");
        assert!(message.contains("beyond the contacts"), "{message}");
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(here, "run around-cylinder --quiet --save tube.json");
    refused(here, "show tube.json --save tube.step", &["tube.step", "STEP", "closes on itself in v", ".ply"]);
    refused(here, "show tube.json --save tube.igs", &["IGES", "closes on itself"]);
    done(here, "show tube.json --save tube.ply");
    done(here, "show tube.json --save tube.npz");
    // a hole in the data leaves coefficients free
    let mut csv = String::from("x,y,z\n");
    for i in 0..400 {
        let (x, y) = (f64::from(i % 20), f64::from(i / 20));
        if (x - 9.5).hypot(y - 9.5) > 6.0 {
            csv.push_str(&format!("{x},{y},{}\n", 0.01 * x * y));
        }
    }
    std::fs::write(here.join("hole.csv"), csv).unwrap();
    done(here, "fit hole.csv --degree 2 --segments 12 --quiet --save hole.json");
    refused(here, "show hole.json --save hole.step", &["gap", "coefficients without data", ".vtu"]);
    done(here, "show hole.json --save hole.vtu");
    assert!(!here.join("hole.step").exists() && !here.join("tube.step").exists());
    refused(here, "show hole.json --save hole.dwg", &["hole.dwg", ".step", ".ply"]);
    refused(here, "run --save s.txt", &["s.txt", ".json"]);
    refused(here, "show hole.json --at hole.csv --save hole.ply", &["--at"]);
}

#[test]
fn cad_files_of_others_are_read_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(here, "run paper-cylinder --quiet --save s.step");
    done(here, "run paper-cylinder --quiet --save s.igs");
    let step = std::fs::read_to_string(here.join("s.step")).unwrap();
    let igs = std::fs::read_to_string(here.join("s.igs")).unwrap();
    let surface = step.lines().find(|line| line.contains("B_SPLINE_SURFACE_WITH_KNOTS")).unwrap();
    let rational = surface
        .replace("=B_SPLINE_SURFACE_WITH_KNOTS", "=(RATIONAL_B_SPLINE_SURFACE(((1.,2.)))B_SPLINE_SURFACE_WITH_KNOTS");
    let rational = rational.replace(");", "));");
    let again = format!("{surface}\n{}", surface.replacen('#', "#9", 1));
    let cases = [
        (step.replace(surface, &rational), "RATIONAL_B_SPLINE_SURFACE"),
        (step.replace("B_SPLINE_SURFACE_WITH_KNOTS(", "SPHERICAL_SURFACE("), "it holds SPHERICAL_SURFACE"),
        (step.replace(surface, &again), "2 spline surfaces"),
        (step.replace("OPEN_SHELL(", "MAPPED_ITEM("), "MAPPED_ITEM"),
        (step.replace("CARTESIAN_POINT('',(-4.", "CARTESIAN_POINT('',(1.E999"), "is no number"),
        (step.replace(surface, &surface.replace("(3,3)", "(3,999999999)")), "no whole number"),
        (step.replace(surface, &surface.replace("(3,3)", "(3,262144)")), "knots"),
        (step[..step.len() / 2].to_string(), "STEP"),
        (igs.replace("1.,1.,1.,1.", "1.,2.,1.,1."), "rational"),
        (igs.replace("     128", "     144"), "entity 128"),
    ];
    for (k, (text, word)) in cases.iter().enumerate() {
        std::fs::write(here.join("other"), text).unwrap();
        let (code, _, message) = palpate(here, "show other");
        assert!(code == 2 && message.contains(word), "{k}: {word} is not in {message}");
    }
    // several types at once without weights, as other programs write them
    let (head, tail) = surface.split_once("WITH_KNOTS('',").unwrap();
    let at = tail.match_indices(".F.,(").next().unwrap().0 + 4;
    let parted = format!(
        "{}(BOUNDED_SURFACE()B_SPLINE_SURFACE({})B_SPLINE_SURFACE_WITH_KNOTS({})GEOMETRIC_REPRESENTATION_ITEM()\
         REPRESENTATION_ITEM('')SURFACE());",
        head.strip_suffix("B_SPLINE_SURFACE_").unwrap(),
        &tail[..at - 1],
        tail[at..].strip_suffix(");").unwrap()
    );
    std::fs::write(here.join("parted.step"), step.replace(surface, &parted)).unwrap();
    assert!(done(here, "show parted.step --json").contains("\"ridge\""));
}

/// A name with markup, quotes and control characters stays harmless in every file.
#[test]
fn names_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let name = "it's <b>\\ \u{1b}[31m\u{e9}.json";
    done(here, "run --quiet --save s.json");
    std::fs::rename(here.join("s.json"), here.join(name)).unwrap();
    for ending in ["step", "igs", "ply", "obj", "glb", "vtu"] {
        let file = format!("s.{ending}");
        let mut command = Command::cargo_bin("palpate").unwrap();
        let output = command.current_dir(here).args(["show", name, "--save", &file]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let bytes = std::fs::read(here.join(&file)).unwrap();
        let text = ["step", "igs", "obj"].contains(&ending);
        assert!(!text || bytes.iter().all(|b| b.is_ascii_graphic() || b" \n".contains(b)), "{ending}");
    }
    for line in ["show s.step --json", "show s.igs --json"] {
        assert!(done(here, line).contains("\"ridge\""), "{line}");
    }
}
