//! What is written is in the input's coordinates, and on the side that the user names.

use std::io::Write;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn document(here: &Path, line: &str) -> Value {
    let output = Command::cargo_bin("palpate").unwrap().current_dir(here).args(line.split(' ')).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn mean_s(document: &Value) -> f64 {
    document["shape"]["S"]["mean"].as_f64().unwrap()
}

/// How far a point is from a bowl that leans by 60 degrees, along its axis.
fn off_the_bowl([x, y, z]: [f64; 3]) -> f64 {
    let (sine, cosine) = (0.75_f64.sqrt(), 0.5);
    let (along, across) = (x * cosine - z * sine, x * sine + z * cosine);
    across - 0.04 * (along * along + y * y)
}

#[test]
fn maps_of_a_model_with_axes_of_its_own_lie_on_the_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let (sine, cosine) = (0.75_f64.sqrt(), 0.5);
    let row = |k: i32| {
        let (u, y) = (f64::from(k % 7) - 3.0, f64::from(k / 7) - 3.0);
        let w = 0.04 * (u * u + y * y);
        format!("{},{y},{}\n", u * cosine + w * sine, w * cosine - u * sine)
    };
    let table = "x,y,z\n".to_string() + &(0..49).map(row).collect::<String>();
    std::fs::write(folder.path().join("lean.csv"), table).unwrap();
    document(folder.path(), "fit lean.csv --degree 2 --out out --json");
    let maps = std::fs::read_to_string(folder.path().join("out/maps.csv")).unwrap();
    for row in maps.lines().skip(1) {
        let place: Vec<f64> = row.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        let off = off_the_bowl([place[0], place[1], place[2]]);
        assert!(off.abs() < 1e-6, "{row}: {off}");
    }
}

#[test]
fn a_viewpoint_below_a_grid_turns_its_side() {
    let folder = tempfile::tempdir().unwrap();
    let mut npz = zip::ZipWriter::new(std::fs::File::create(folder.path().join("cup.npz")).unwrap());
    let axis: Vec<f64> = (0..7).map(|k| f64::from(k) - 3.0).collect();
    let z: Vec<f64> =
        axis.iter().flat_map(|x| axis.iter().map(move |y| 20.0 - (400.0 - x * x - y * y).sqrt())).collect();
    for (name, shape, values) in [("x", "(7,)", &axis), ("y", "(7,)", &axis), ("z", "(7, 7)", &z)] {
        npz.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        npz.write_all(b"\x93NUMPY\x01\x00").unwrap();
        npz.write_all(&(header.len() as u16).to_le_bytes()).unwrap();
        npz.write_all(header.as_bytes()).unwrap();
        values.iter().for_each(|value| npz.write_all(&value.to_le_bytes()).unwrap());
    }
    npz.finish().unwrap();
    let seen = |options: &str| mean_s(&document(folder.path(), &format!("fit cup.npz{options} --json")));
    let [above, named, below] = ["", " --viewpoint 0,0,90", " --viewpoint 0,0,-90"].map(seen);
    assert!(above < -0.9 && named == above && below > 0.9, "{above} {named} {below}");
}

/// A scene that is seen from inside: parts say the other side of every joint.
#[test]
fn options_of_the_input_hold_for_the_contacts_of_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "[surface]\nkind = \"solids\"\n[[surface.parts]]\nkind = \"block\"\nsize = [16.0, 12.0, 10.0]\n[sweep]\npath = \"scan\"\n\
                 spacing = 1.0\neye = [50.0, 40.0, 45.0]\n";
    std::fs::write(folder.path().join("box.toml"), scene).unwrap();
    let joints = |options: &str| -> Vec<String> {
        let found = document(folder.path(), &format!("parts box.toml{options} --json"));
        found["joints"].as_array().unwrap().iter().map(|joint| joint["kind"].to_string()).collect()
    };
    let (plain, flipped) = (joints(""), joints(" --flip-normals"));
    assert!(plain.len() == 3 && flipped.len() == 3, "{plain:?} {flipped:?}");
    assert!(plain.iter().zip(&flipped).all(|(a, b)| a != b), "{plain:?} {flipped:?}");
    assert_eq!(joints(" --viewpoint 50,40,45"), plain);
    assert_eq!(joints(" --viewpoint -50,-40,-45"), flipped);
    let part = document(folder.path(), "parts box.toml --box -90,90,-90,90,4.99,90 --json");
    assert_eq!(part["parts"].as_array().unwrap().len(), 1);
}

/// The README recommends a robust loss, which gave a ball of 40 touches up for a plane, because it turned recognition off.
#[test]
fn another_loss_inset_or_axes_name_no_model() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let scene = "[surface]\nkind = \"cylinder\"\nradius = 20.0\n[sweep]\nfingers = [-6, -3, 0, 3, 6]\nfrom = -6\nto = 6\nstations = 9\n\
                 [effects.position_noise]\nsigma = 0.02\n[fit]\nrobust = \"huber\"\n";
    std::fs::write(here.join("bar.toml"), scene).unwrap();
    document(here, "simulate bar.toml -o bar.csv --json");
    let plain = document(here, "fit bar.csv --json");
    let of = |found: &Value| found["fit"]["chosen"]["hypothesis"].clone();
    let robust = document(here, "fit bar.csv --robust tukey --frame keep --json");
    assert_eq!((of(&robust), &robust["shape"]), (of(&plain), &plain["shape"]));
    assert!(of(&plain).is_string() && robust["fit"]["notes"].to_string().contains("--robust has no effect"));
    assert!(of(&document(here, "run bar.toml --json")).is_string());
    document(here, "fit bar.csv --inset 0.25 --out cut --json");
    document(here, "fit bar.csv --out whole --json");
    let [whole, cut] = ["whole", "cut"].map(|out| {
        let text = std::fs::read_to_string(here.join(out).join("maps.csv")).unwrap();
        let x = |row: &str| row.split(',').next().unwrap().parse::<f64>().unwrap();
        let all: Vec<f64> = text.lines().skip(1).map(x).collect();
        [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
    });
    let side = whole[1] - whole[0];
    assert!(
        (cut[0] - whole[0] - 0.25 * side).abs() < 1e-9 && (cut[1] - whole[1] + 0.25 * side).abs() < 1e-9,
        "{whole:?} {cut:?}"
    );
}
