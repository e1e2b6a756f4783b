//! Sweeps that nobody placed: tilted, upright, upside down, far from the origin, in another unit, over outlines that are no
//! rectangle. The answer is that of the same sweep lying level, by the law of rotation, or a word says what would help.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

use crate::draws::uniform;

type Vector = [f64; 3];

/// A pose: axis, degrees, offset, unit.
type Pose = (Vector, f64, f64, f64);

const POSES: [Pose; 5] = [
    ([1.0, 0.4, 0.0], 30.0, 0.0, 1.0),
    ([1.0, 0.0, 0.0], 90.0, 5.0, 1e-3),
    ([0.0, 1.0, 0.0], 90.0, -2.0, 1e3),
    ([0.3, 1.0, 0.2], 60.0, 1e5, 1.0),
    ([1.0, 0.4, 0.0], 180.0, 0.0, 1.0),
];

/// Outlines within the square of half width 1.
fn l_shape(x: f64, y: f64) -> bool {
    x < 0.0 || y < 0.0
}

fn ring(x: f64, y: f64) -> bool {
    (0.5..1.0).contains(&x.hypot(y))
}

fn band(x: f64, y: f64) -> bool {
    (x - y).abs() < 0.4
}

/// Contacts with normals of a height field over an outline of half width 4, with noise of sd 0.006 along z.
fn sweep(
    count: usize,
    outline: impl Fn(f64, f64) -> bool,
    height: impl Fn(f64, f64) -> (f64, [f64; 2]),
) -> (Vec<Vector>, Vec<Vector>) {
    let places = (0..20 * count).map(|k| (k, 2.0 * uniform(k, 0) - 1.0, 2.0 * uniform(k, 1) - 1.0));
    places
        .filter(|(_, x, y)| outline(*x, *y))
        .take(count)
        .map(|(k, x, y)| {
            let (x, y) = (4.0 * x, 4.0 * y);
            let (z, [zx, zy]) = height(x, y);
            let length = (1.0 + zx * zx + zy * zy).sqrt();
            let noise = 0.02 * (uniform(k, 2) - 0.5);
            ([x, y, z + noise], [-zx / length, -zy / length, 1.0 / length])
        })
        .unzip()
}

fn ridge(x: f64, y: f64) -> (f64, [f64; 2]) {
    let (s, c) = (0.6 * x + 0.8 * y, [0.6, 0.8]);
    let z = (100.0 - s * s).sqrt();
    (z, c.map(|c| -c * s / z))
}

fn saddle(x: f64, y: f64) -> (f64, [f64; 2]) {
    (0.05 * (x * x - y * y), [0.1 * x, -0.1 * y])
}

fn waves(x: f64, y: f64) -> (f64, [f64; 2]) {
    (
        0.4 * (1.5 * x).sin() * (1.2 * y).cos(),
        [0.6 * (1.5 * x).cos() * (1.2 * y).cos(), -0.48 * (1.5 * x).sin() * (1.2 * y).sin()],
    )
}

/// Rodrigues' formula.
fn rotated([x, y, z]: Vector, axis: Vector, degrees: f64) -> Vector {
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let [a, b, c] = axis.map(|v| v / length);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let along = (1.0 - cos) * (a * x + b * y + c * z);
    [
        cos * x + sin * (b * z - c * y) + along * a,
        cos * y + sin * (c * x - a * z) + along * b,
        cos * z + sin * (a * y - b * x) + along * c,
    ]
}

fn write(at: &Path, (points, normals): &(Vec<Vector>, Vec<Vector>), with_normals: bool, pose: Pose) {
    let (axis, degrees, offset, unit) = pose;
    let mut text = String::from(if with_normals { "x,y,z,nx,ny,nz\n" } else { "x,y,z\n" });
    for (p, n) in points.iter().zip(normals) {
        let [x, y, z] = rotated(*p, axis, degrees).map(|v| (v + offset) * unit);
        let [a, b, c] = rotated(*n, axis, degrees);
        text.push_str(&format!("{x:e},{y:e},{z:e}"));
        if with_normals {
            text.push_str(&format!(",{a:e},{b:e},{c:e}"));
        }
        text.push('\n');
    }
    std::fs::write(at.join("sweep.csv"), text).unwrap();
}

fn run(at: &Path, options: &str) -> std::process::Output {
    let mut command = Command::cargo_bin("palpate").unwrap();
    command.current_dir(at).args(["fit", "sweep.csv", "--json"]).args(options.split_whitespace()).output().unwrap()
}

fn fitted(at: &Path, options: &str) -> Value {
    let output = run(at, options);
    assert!(output.status.success(), "{options}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

const LEVEL: Pose = ([0.0, 0.0, 1.0], 0.0, 0.0, 1.0);

/// S, R in the unit of the level sweep, and the support.
fn shape(found: &Value, unit: f64) -> [f64; 3] {
    let shape = &found["shape"];
    [
        shape["S"]["mean"].as_f64().unwrap(),
        shape["R"]["mean"].as_f64().unwrap() * unit,
        shape["support"].as_f64().unwrap(),
    ]
}

/// S and R to `share` of what they are; without normals the free side is that of +z, and S may change its sign.
fn is_the_same(found: &Value, level: &Value, (_, degrees, _, unit): Pose, with_normals: bool, share: f64) {
    let ([s, r, _], [level_s, level_r, _]) = (shape(found, unit), shape(level, 1.0));
    let (s, level_s) = if with_normals { (s, level_s) } else { (s.abs(), level_s.abs()) };
    assert!((s - level_s).abs() < share, "{degrees} degrees, unit {unit}: S {s}, level {level_s}");
    assert!((r / level_r - 1.0).abs() < share, "{degrees} degrees, unit {unit}: R {r}, level {level_r}");
    if with_normals {
        assert_eq!(found["shape"]["class"], level["shape"]["class"], "{degrees} degrees");
    }
}

#[test]
fn simple_shapes_are_the_same_in_every_pose_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for data in [sweep(150, l_shape, ridge), sweep(150, band, ridge)] {
        for with_normals in [true, false] {
            write(at, &data, with_normals, LEVEL);
            let level = fitted(at, "");
            assert_eq!(level["shape"]["class"], "ridge");
            for pose in POSES {
                write(at, &data, with_normals, pose);
                is_the_same(&fitted(at, ""), &level, pose, with_normals, 1e-4);
            }
        }
    }
}

/// Means of S and of R of the saddle over the points of `maps.csv` that have them, in the unit of the level sweep.
fn truth_over_the_map(at: &Path, (axis, degrees, offset, unit): Pose) -> [f64; 2] {
    let text = std::fs::read_to_string(at.join("out/maps.csv")).unwrap();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name).unwrap();
    let (place, of_r) = (["x", "y", "z"].map(column), column("R"));
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for row in text.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        if cells[of_r].is_empty() {
            continue;
        }
        let [x, y, _] = rotated(place.map(|k| cells[k].parse::<f64>().unwrap() / unit - offset), axis, -degrees);
        let (p, q, a) = (0.1 * x, -0.1 * y, 0.1);
        let w = (1.0 + p * p + q * q).sqrt();
        let mean = 0.5 * ((1.0 + q * q) * a - (1.0 + p * p) * a) / w.powi(3);
        let gauss = -a * a / w.powi(4);
        let apart = (mean * mean - gauss).sqrt();
        sums[0] -= 2.0 / std::f64::consts::PI * (mean / apart).atan();
        sums[1] += (mean * mean + apart * apart).sqrt();
        count += 1.0;
    }
    sums.map(|sum| sum / count)
}

/// S and R of a saddle differ from place to place, and their means are over the map that is written, which lies otherwise
/// in every pose: each answer is compared with the truth over its own map.
#[test]
fn a_saddle_is_right_over_its_own_map_in_every_pose_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let data = sweep(150, ring, saddle);
    for pose in POSES {
        for with_normals in [true, false] {
            write(at, &data, with_normals, pose);
            let found = fitted(at, "--out out");
            let [true_s, true_r] = truth_over_the_map(at, pose);
            let ([s, r, _], unit) = (shape(&found, pose.3), pose.3);
            let s = if with_normals { s } else { s.abs() };
            let true_s = if with_normals { true_s } else { true_s.abs() };
            let [u_s, u_r] = ["S", "R"].map(|key| found["shape"][key]["u"].as_f64().unwrap());
            assert!((s - true_s).abs() < 3.0 * u_s, "{pose:?}: S {s}, truth {true_s}, u {u_s}");
            assert!((r - true_r).abs() < 3.0 * u_r * unit, "{pose:?}: R {r}, truth {true_r}, u {}", u_r * unit);
            assert!(u_s < 0.03 && u_r * unit < 0.05 * true_r, "{pose:?}: u {u_s}, {u_r}");
            assert_eq!(found["shape"]["class"], "saddle", "{pose:?}");
        }
    }
}

/// A surface that is no simple shape is described by a height field over the patch's own plane.
#[test]
fn waves_are_the_same_in_every_pose_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let data = sweep(700, band, waves);
    for with_normals in [true, false] {
        write(at, &data, with_normals, LEVEL);
        let level = fitted(at, "");
        assert!(
            level["fit"]["chosen"]["why"].as_str().unwrap().contains("no simple shape"),
            "{}",
            level["fit"]["chosen"]
        );
        for pose in [POSES[1], POSES[3], POSES[4]] {
            write(at, &data, with_normals, pose);
            is_the_same(&fitted(at, ""), &level, pose, with_normals, 1e-4);
        }
    }
}

/// A named model keeps the input's axes to the digit while it leans little, and takes its own where it is steep.
#[test]
fn a_named_model_over_a_steep_sweep_takes_its_own_axes_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let data = sweep(150, l_shape, saddle);
    for with_normals in [true, false] {
        let said = |found: &Value| found["fit"]["notes"].to_string().contains("--frame keep");
        write(at, &data, with_normals, ([1.0, 0.4, 0.0], 30.0, 0.0, 1.0));
        let [unnamed, kept] = ["--degree 3", "--degree 3 --frame keep"].map(|options| fitted(at, options));
        assert!(!said(&unnamed));
        assert_eq!(unnamed["surface"]["coefficients"], kept["surface"]["coefficients"]);
        let mut upright = Vec::new();
        for pose in [POSES[1], POSES[2], POSES[3]] {
            write(at, &data, with_normals, pose);
            let found = fitted(at, "--degree 3");
            assert!(said(&found), "{:?}: {}", pose, found["fit"]["notes"]);
            let [s, r, _] = shape(&found, pose.3);
            let truth = 0.0923;
            assert!(s.abs() < 0.03 && (r / truth - 1.0).abs() < 0.06, "{:?}: S {s}, R {r}", pose.0);
            assert_eq!(found["shape"]["R"]["mean"], fitted(at, "--degree 3 --frame auto")["shape"]["R"]["mean"]);
            upright.push(found);
        }
        for (found, pose) in upright.iter().zip([POSES[1], POSES[2], POSES[3]]).skip(1) {
            let first = shape(&upright[0], POSES[1].3);
            let next = shape(found, pose.3);
            assert!((next[1] / first[1] - 1.0).abs() < 1e-6, "{next:?} {first:?}");
        }
    }
}

#[test]
fn a_sweep_that_is_upside_down_is_asked_about_where_its_model_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, &sweep(60, l_shape, saddle), true, POSES[4]);
    let output = run(at, "--degree 3");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("--flip-normals") && message.contains("--frame auto"), "{message}");
    let found = fitted(at, "--degree 3 --frame auto");
    assert_eq!(found["shape"]["class"], "saddle");
}

/// Corners, bays and holes without contacts are in no mean.
#[test]
fn the_support_follows_an_outline_that_is_no_rectangle() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (outline, area) in [(l_shape as fn(f64, f64) -> bool, 0.75), (ring, 0.59), (band, 0.36)] {
        write(at, &sweep(2000, outline, |_, _| (0.0, [0.0, 0.0])), true, LEVEL);
        let support = fitted(at, "--degree 2 --grid 40x40")["shape"]["support"].as_f64().unwrap();
        // what is nearer than two and a half spacings to a contact counts as supported
        assert!((area - 0.05..area + 0.15).contains(&support), "support {support} of {area}");
    }
}
