//! `--adaptive`: small cells where the contacts ask for them, by name and by itself; what is saved and read back; what is refused.

use std::path::Path;

use assert_cmd::Command;
use palpate_numeric::draws::Lcg;
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

fn document(here: &Path, line: &str) -> Value {
    serde_json::from_str(&done(here, line)).unwrap()
}

fn refused(here: &Path, line: &str) -> String {
    let (code, _, message) = palpate(here, line);
    assert_eq!(code, 2, "{line}: {message}");
    message
}

const TOP: [f64; 2] = [3.1, -4.4];

/// Waves three lengths long, and in them one bump of width 0.5 where it is asked for.
fn lens(x: f64, y: f64, bump: bool) -> f64 {
    let smooth = 3.0 * (0.15 * x).sin() * (0.12 * y + 0.3).cos();
    let off = ((x - TOP[0]).powi(2) + (y - TOP[1]).powi(2)) / (0.5 * 0.5);
    smooth + if bump { 0.4 * (-off).exp() } else { 0.0 }
}

/// Contacts anywhere on [-10, 10]^2, with noise of 0.02.
fn touched(here: &Path, name: &str, count: usize, bump: bool) {
    let mut draw = Lcg::new(9);
    let mut text = String::from("x,y,z\n");
    for _ in 0..count {
        let [x, y] = [0, 1].map(|_| 20.0 * draw.uniform() - 10.0);
        text.push_str(&format!("{x},{y},{}\n", lens(x, y, bump) + 0.02 * draw.normal()));
    }
    std::fs::write(here.join(name), text).unwrap();
}

#[test]
fn a_bump_on_a_lens_is_followed_and_kept_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    touched(here, "lens.csv", 30_000, true);
    let found = document(here, "fit lens.csv --adaptive --json --save lens.json --out d");
    let (fit, surface) = (&found["fit"], &found["surface"]);
    assert_eq!((&surface["kind"], &fit["chosen"]["surface"]), (&"adaptive".into(), &"adaptive".into()));
    let noise = fit["sigma"]["z"].as_f64().unwrap();
    assert!((noise / 0.02 - 1.0).abs() < 0.05, "{noise}");
    let unknowns = fit["unknowns"].as_u64().unwrap();
    assert!(fit["adaptive"]["halvings"].as_u64().unwrap() >= 3 && unknowns < 700, "{fit}");
    let r = &found["shape"]["R"];
    assert!(r["u"].as_f64().unwrap() > 0.0 && r["interval"][0].as_f64() < r["mean"].as_f64(), "{r}");
    // the place of the bump, from the file that was saved and through every form of it
    std::fs::write(here.join("at.csv"), format!("x,y\n{},{}\n", TOP[0], TOP[1])).unwrap();
    let height =
        |file: &str| document(here, &format!("show {file} --at at.csv --json"))["points"][0]["z"].as_f64().unwrap();
    let z = height("lens.json");
    assert!((z - lens(TOP[0], TOP[1], true)).abs() < 0.03, "{z}");
    for form in ["step", "igs", "npz", "ply", "vtu", "glb", "parquet"] {
        done(here, &format!("show lens.json --save lens.{form} --grid 60 --quiet"));
    }
    for form in ["step", "igs"] {
        assert!((height(&format!("lens.{form}")) - z).abs() < 1e-9, "{form}");
    }
    assert!(done(here, "diff lens.json lens.step").contains("the same surface within what the data tell"));
    let maps = std::fs::read_to_string(here.join("d/maps.csv")).unwrap();
    assert!(
        maps.starts_with("x,y,z,k1,k2,S,R,u_position,u_normal_deg,u_S,u_R,u_k1,u_k2\n")
            && maps.lines().count() == 65 * 65 + 1
    );
    // a scene may be touched on it, and an adaptive surface has the truth beside it
    let scene = "[surface]\nkind = \"imported\"\nfile = \"lens.json\"\n[sweep]\nfingers = [0.0, 1.0, 2.0, 3.0]\nfrom = -6.0\nto = 6.0\nstations = 20\n";
    std::fs::write(here.join("again.toml"), scene).unwrap();
    let again = document(here, "run again.toml --adaptive --json");
    assert!(again["truth"]["R"].as_f64().is_some(), "{}", again["truth"]);
}

/// Nobody has to name it: many contacts with a small feature are followed, and those without are fitted as ever.
#[test]
fn small_features_are_found_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for bump in [true, false] {
        touched(here, "lens.csv", 20_000, bump);
        let found = document(here, "fit lens.csv --json");
        assert_eq!(found["surface"]["kind"] == "adaptive", bump, "{}", found["fit"]["chosen"]);
    }
}

#[test]
fn noise_alone_is_a_plane_of_few_cells() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut draw = Lcg::new(2);
    let mut text = String::from("x,y,z\n");
    for _ in 0..3000 {
        let [x, y] = [0, 1].map(|_| 10.0 * draw.uniform());
        text.push_str(&format!("{x},{y},{}\n", 0.2 * x - 0.1 * y + 0.01 * draw.normal()));
    }
    std::fs::write(here.join("plane.csv"), text).unwrap();
    let found = document(here, "fit plane.csv --adaptive --json");
    assert_eq!((&found["shape"]["class"], &found["fit"]["adaptive"]["halvings"]), (&"plane".into(), &0.into()));
    assert!(found["shape"]["S"]["mean"].is_null() && found["shape"]["R"]["interval"][0] == 0.0, "{}", found["shape"]);
}

#[test]
fn what_it_cannot_be_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    touched(here, "lens.csv", 300, false);
    assert!(refused(here, "fit lens.csv --adaptive --degree 2,3").contains("one degree for x and y"));
    assert!(refused(here, "fit lens.csv --adaptive --degree 7").contains("2 to 5"));
    assert!(refused(here, "fit lens.csv --adaptive --segments 4").contains("--segments"));
    assert!(refused(here, "fit lens.csv --adaptive --domain 0,1,0,1").contains("outside the given domain"));
    std::fs::write(here.join("line.csv"), "x,y,z\n0,0,1\n1,0,2\n2,0,3\n3,0,1\n4,0,2\n").unwrap();
    assert!(refused(here, "fit line.csv --adaptive").contains("lie on one line"));
    // a document whose cells lie nowhere
    done(here, "fit lens.csv --adaptive --quiet --save lens.json");
    let text = std::fs::read_to_string(here.join("lens.json")).unwrap();
    let mut value: Value = serde_json::from_str(&text).unwrap();
    value["surface"]["splits"] = serde_json::json!([[1, 4_000_000, 0]]);
    std::fs::write(here.join("broken.json"), value.to_string()).unwrap();
    assert!(refused(here, "show broken.json").contains("lies in no cell of the base grid"));
}
