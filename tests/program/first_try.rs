//! `palpate fit FILE` and nothing else: right where the contacts show a simple shape, and a word where they do not.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

use crate::draws::uniform;

type Vector = [f64; 3];

/// Numbers between -1 and 1.
fn chance(k: usize, stream: usize) -> f64 {
    2.0 * uniform(k, stream) - 1.0
}

fn write(folder: &Path, name: &str, points: &[Vector], normals: Option<&[Vector]>) {
    let mut text = String::from(if normals.is_some() { "x,y,z,nx,ny,nz\n" } else { "x,y,z\n" });
    for (k, [x, y, z]) in points.iter().enumerate() {
        text.push_str(&format!("{x},{y},{z}"));
        if let Some(normals) = normals {
            let [a, b, c] = normals[k];
            text.push_str(&format!(",{a},{b},{c}"));
        }
        text.push('\n');
    }
    std::fs::write(folder.join(name), text).unwrap();
}

/// Contacts on a square of half width 4 with noise of sd about 0.006.
fn patch(count: usize, height: impl Fn(f64, f64) -> f64) -> Vec<Vector> {
    let noise = |k| 0.01 * (chance(k, 2) * chance(k, 3) + chance(k, 4)) / 1.2;
    (0..count)
        .map(|k| (4.0 * chance(k, 0), 4.0 * chance(k, 1), noise(k)))
        .map(|(x, y, e)| [x, y, height(x, y) + e])
        .collect()
}

fn ball(x: f64, y: f64) -> f64 {
    (100.0 - x * x - y * y).sqrt()
}

fn ball_with_normals() -> (Vec<Vector>, Vec<Vector>) {
    let points = patch(400, ball);
    let normals = points.iter().map(|[x, y, _]| [x / 10.0, y / 10.0, ball(*x, *y) / 10.0]).collect();
    (points, normals)
}

fn fitted(folder: &Path, arguments: &str) -> Value {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments}");
    String::from_utf8(output.stderr).unwrap()
}

fn run(folder: &Path, arguments: &str) -> std::process::Output {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(folder).args(arguments.split_whitespace()).arg("--json").output().unwrap()
}

fn notes(document: &Value) -> String {
    document["fit"]["notes"].to_string()
}

fn near(document: &Value, class: &str, radius: f64, share: f64) {
    assert_eq!(document["shape"]["class"], class, "{}", document["fit"]["chosen"]);
    let found = document["shape"]["radius"].as_f64().unwrap();
    assert!((found / radius - 1.0).abs() < share, "radius {found} for {radius}");
}

#[test]
fn what_was_chosen_is_said_and_the_saved_surface_lies_on_the_contacts() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let bar = |x: f64, y: f64| (100.0 - (0.6 * x + 0.8 * y).powi(2)).sqrt();
    write(at, "bar.csv", &patch(400, bar), None);
    let found = fitted(at, "fit bar.csv --save bar.json");
    near(&found, "ridge", 10.0, 0.02);
    let chosen = &found["fit"]["chosen"];
    assert_eq!((&chosen["surface"], &chosen["hypothesis"]), (&"height".into(), &"cylinder".into()));
    assert!(chosen["why"].as_str().unwrap().contains("cylinder") && chosen["tried"].as_array().unwrap().len() > 3);
    assert!(found["fit"]["lack_of_fit"]["p"].as_f64().is_some());
    let interval = found["shape"]["R"]["interval"].as_array().unwrap();
    let truth = 1.0 / (10.0 * 2.0_f64.sqrt());
    assert!(interval[0].as_f64().unwrap() < truth && truth < interval[1].as_f64().unwrap());
    // the axis of the bar goes through the origin
    let centre: Vector = serde_json::from_value(found["shape"]["centre"].clone()).unwrap();
    assert!((0.6 * centre[0] + 0.8 * centre[1]).hypot(centre[2]) < 0.05, "{centre:?}");
    std::fs::write(at.join("at.csv"), "x,y\n0,0\n1,-2\n3,3\n").unwrap();
    let shown = fitted(at, "show bar.json --at at.csv");
    for point in shown["points"].as_array().unwrap() {
        let [x, y, z] = ["x", "y", "z"].map(|key| point[key].as_f64().unwrap());
        assert!((z - bar(x, y)).abs() < 0.02, "{x} {y} {z}");
    }
}

/// Turned, moved, scaled, shuffled: the same class, S and relative radius.
#[test]
fn a_turned_and_scaled_patch_is_the_same_patch() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (points, normals) = ball_with_normals();
    let (a, b) = (2.3_f64, -1.1_f64);
    let turn = |[x, y, z]: Vector| {
        let [x, y] = [x * a.cos() - y * a.sin(), x * a.sin() + y * a.cos()];
        [x * b.cos() - z * b.sin(), y, x * b.sin() + z * b.cos()]
    };
    let mut moved: Vec<(Vector, Vector)> =
        points.iter().zip(&normals).map(|(p, n)| (turn(*p).map(|v| 1000.0 * v - 7e3), turn(*n))).collect();
    moved.reverse();
    let (points, normals): (Vec<Vector>, Vec<Vector>) = moved.into_iter().unzip();
    write(at, "ball.csv", &points, Some(&normals));
    near(&fitted(at, "fit ball.csv"), "cap", 10_000.0, 0.01);
}

#[test]
fn normals_of_mixed_sign_of_length_zero_and_at_random_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (points, normals) = ball_with_normals();
    let with = |change: &dyn Fn(usize, Vector) -> Vector| -> Value {
        let changed: Vec<Vector> = normals.iter().enumerate().map(|(k, n)| change(k, *n)).collect();
        write(at, "ball.csv", &points, Some(&changed));
        fitted(at, "fit ball.csv")
    };
    let mixed = with(&|k, n| if k % 3 == 0 { n.map(|v| -v) } else { n });
    near(&mixed, "cap", 10.0, 0.01);
    assert!(notes(&mixed).contains("134 normals pointed to the other side"), "{}", notes(&mixed));
    let zeros = with(&|k, n| if k % 8 == 0 { [0.0; 3] } else { n });
    near(&zeros, "cap", 10.0, 0.01);
    assert!(notes(&zeros).contains("50 normals of length 0"), "{}", notes(&zeros));
    let random = with(&|k, _| [chance(k, 3), chance(k, 4), chance(k, 5)]);
    near(&random, "cap", 10.0, 0.01);
    assert!(notes(&random).contains("not used"), "{}", notes(&random));
    let ignored = fitted(at, "fit ball.csv --ignore-normals");
    near(&ignored, "cap", 10.0, 0.01);
    assert!(notes(&ignored).contains("ignored"));
    near(&fitted(at, "fit ball.csv --normals estimate"), "cap", 10.0, 0.01);
    // seen from inside, the same ball is a cup
    near(&fitted(at, "fit ball.csv --ignore-normals --viewpoint 0,0,0"), "cup", 10.0, 0.01);
}

#[test]
fn what_is_no_simple_shape_is_not_called_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "waves.csv", &patch(2000, |x, _| (2.0 * x).sin()), None);
    let waves = fitted(at, "fit waves.csv");
    assert!(waves["shape"]["class"].is_null(), "{}", waves["shape"]["class"]);
    let by_area = &waves["shape"]["class_by_area"];
    assert!(by_area["ridge"].is_number() && by_area["rut"].is_number(), "{by_area}");
    write(at, "groove.csv", &patch(3000, |x, _| if x.abs() < 1.0 { -1.0 } else { 0.0 }), None);
    assert!(refused(at, "fit groove.csv").contains("several things: a plane"));
    // a corner of a room: floor and two walls
    let corner = |k: usize| {
        let [a, b] = [0, 1].map(|s| 2.0 + 2.0 * chance(k, s));
        [[a, b, 0.0], [0.0, a, b], [a, 0.0, b]][k % 3]
    };
    let room: Vec<Vector> = (0..3000).map(corner).collect();
    write(at, "room.csv", &room, None);
    let said = refused(at, "fit room.csv");
    assert!(said.contains("room.csv") && said.contains("--near") && said.contains("--box"), "{said}");
    assert!(said.contains("a plane (33 % of them), a plane (33 %) and a plane (33 %)"), "{said}");
    // one wall of it
    let floor = fitted(at, "fit room.csv --box 0.2,4,0.2,4,-0.1,0.1");
    assert_eq!(floor["shape"]["class"], "plane");
    assert!(notes(&floor).contains("in the part that was asked for"));
    assert!(refused(at, "fit room.csv --near 99,0,0,1").contains("--near"));
}

/// Waves on a plate of 12 by 12, touched at 30 by 30 places: seven to a wave or ten, and no field follows the shorter ones.
#[test]
fn a_plate_with_waves_is_not_flat() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let waves = |length: f64| {
        let height = |v: f64| (std::f64::consts::TAU * v / length).sin();
        let touch = |k: usize| {
            let [x, y] = [k % 30, k / 30].map(|i| 12.0 * i as f64 / 29.0 - 6.0);
            [x, y, height(x) * height(y) + 0.02 * chance(k, 0)]
        };
        (0..900).map(touch).collect::<Vec<Vector>>()
    };
    write(at, "long.csv", &waves(4.0), None);
    assert!(fitted(at, "fit long.csv")["shape"]["class_by_area"]["saddle"].is_number());
    write(at, "shorter.csv", &waves(3.0), None);
    assert!(fitted(at, "fit shorter.csv")["shape"]["class_by_area"]["saddle"].is_number());
    // six touches a wave are enough
    write(at, "short.csv", &waves(2.4), None);
    assert!(fitted(at, "fit short.csv")["shape"]["class_by_area"]["saddle"].is_number());
    // the same heights a hundredth as high are what a sensor may err by
    let low: Vec<Vector> = waves(3.0).into_iter().map(|[x, y, z]| [x, y, 0.01 * z]).collect();
    write(at, "low.csv", &low, None);
    assert_eq!(fitted(at, "fit low.csv")["shape"]["class"], "plane");
}

#[test]
fn a_closed_body_and_a_background_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let body: Vec<Vector> = (0..3000)
        .map(|k| {
            let (angle, z) = (std::f64::consts::PI * chance(k, 0), chance(k, 1));
            let across = (1.0 - z * z).sqrt();
            [across * angle.cos(), 0.7 * across * angle.sin(), 0.5 * z]
        })
        .collect();
    write(at, "body.csv", &body, None);
    let half = fitted(at, "fit body.csv");
    assert_eq!((&half["shape"]["class"], &half["fit"]["chosen"]["hypothesis"]), (&"dome".into(), &"quadric".into()));
    assert_eq!(half["shape"]["other_class"], "trough");
    let mut scene: Vec<Vector> = patch(1500, |_, _| 0.0);
    scene.extend(body.iter().filter(|p| p[2] > 0.1).take(250).map(|p| [p[0], p[1], p[2] + 0.5]));
    write(at, "table.csv", &scene, None);
    let table = fitted(at, "fit table.csv");
    assert_eq!(table["shape"]["class"], "plane");
    assert!(notes(&table).contains("belong to something else"), "{}", notes(&table));
}

#[test]
fn options_without_effect_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "ball.csv", &patch(60, ball), None);
    assert!(refused(at, "fit ball.csv --flip-normals").contains("--flip-normals"));
    assert!(refused(at, "fit ball.csv --ignore-normals").contains("--ignore-normals"));
    assert!(refused(at, "fit ball.csv --degree 2 --viewpoint 0,0,0").contains("viewpoint"));
    let (points, normals) = ball_with_normals();
    write(at, "ball.csv", &points, Some(&normals));
    let found = fitted(at, "fit ball.csv --surface parametric --method qr --smooth auto");
    assert!(notes(&found).contains("--method has no effect") && notes(&found).contains("--smooth has no effect"));
}

#[test]
fn declared_noise_that_the_contacts_contradict_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (points, normals) = ball_with_normals();
    write(at, "ball.csv", &points, Some(&normals));
    let low = fitted(at, "fit ball.csv --degree 4 --segments 2 --sigma 0.001,5");
    assert!(notes(&low).contains("the heights lie") && notes(&low).contains("take it for noise"), "{}", notes(&low));
    let high = fitted(at, "fit ball.csv --degree 4 --segments 2 --sigma 1,5");
    assert!(notes(&high).contains("the noise is smaller"), "{}", notes(&high));
}

/// The contacts of every built-in scene, as if they were somebody's own: an answer, or a refusal that speaks of the contacts
/// and not of what the program makes of them on its way.
#[test]
fn the_contacts_of_every_built_in_scene_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    let list = run(folder.path(), "scenes");
    let list: Value = serde_json::from_slice(&list.stdout).unwrap();
    let names: Vec<&str> =
        list["scenes"].as_array().unwrap().iter().map(|scene| scene["name"].as_str().unwrap()).collect();
    // bodies of several faces are no patch
    let patches: Vec<&&str> = names.iter().filter(|name| !name.starts_with("parts-")).collect();
    let mut answered = 0;
    for name in &patches {
        let mut command = Command::cargo_bin("palpate").unwrap();
        command.current_dir(folder.path()).args(["simulate", name, "-o", &format!("{name}.csv")]).assert().success();
        let output = run(folder.path(), &format!("fit {name}.csv"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() || message.contains("the normals point all ways"), "{name}: {message}");
        answered += usize::from(output.status.success());
    }
    assert!(answered >= 9, "{answered} of {}", patches.len());
}

/// Mean of a column of `maps.csv` over the rows that have a value, and how many rows these are.
fn mean_of_map(folder: &Path, column: &str) -> (f64, usize) {
    let text = std::fs::read_to_string(folder.join("out/maps.csv")).unwrap();
    let mut rows = text.lines();
    let at = rows.next().unwrap().split(',').position(|name| name == column).unwrap();
    let values: Vec<f64> = rows.filter_map(|row| row.split(',').nth(at)?.parse().ok()).collect();
    (values.iter().sum::<f64>() / values.len() as f64, values.len())
}

#[test]
fn the_means_are_those_of_the_map_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    // S and R differ from place to place, and the principal directions lie aslant to x and y
    let hill = |x: f64, y: f64| 0.9 * (-0.06 * (x + 0.5 * y).powi(2) - 0.03 * (y - 1.0).powi(2)).exp() + 0.02 * x * y;
    let level = patch(500, hill);
    let upright: Vec<Vector> = level.iter().map(|[x, y, z]| [*z, *x, *y]).collect();
    for (name, points) in [("level.csv", &level), ("upright.csv", &upright)] {
        write(folder.path(), name, points, None);
        for grid in ["", " --grid 24"] {
            let shape = fitted(folder.path(), &format!("fit {name} --out out{grid}"))["shape"].clone();
            for (key, column) in [("S", "S"), ("R", "R")] {
                let (mean, count) = mean_of_map(folder.path(), column);
                let (said, u) = (shape[key]["mean"].as_f64().unwrap(), shape[key]["u"].as_f64().unwrap());
                // nothing tells the free side of places alone: S is said by its size, and the map shows one of the two
                let mean = mean.abs();
                // the map shows the spline of one surface, the mean counts less likely ones too
                assert!((mean - said).abs() < 0.25 * u, "{name} {grid} {key}: {mean} in the map, {said} said, u {u}");
                let (u_at_points, known) = mean_of_map(folder.path(), &format!("u_{column}"));
                // one point is less sure than the mean, and surer than nothing
                let believable = (0.5 * u..0.3 * said).contains(&u_at_points);
                assert!(known == count && believable, "{name} {grid} {key}: {u_at_points} at points, {u} of the mean");
                let all = shape["grid"].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).product::<f64>();
                assert_eq!(shape["support"].as_f64().unwrap(), count as f64 / all, "{name} {grid}");
            }
        }
    }
}
