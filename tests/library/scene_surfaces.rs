//! Every surface, in every pose, against references to 50 digits (tests/golden/surfaces.py).

use palpate_app::io::scene_file::read_scene;
use serde_json::Value;

const GOLDEN: &str = include_str!("../golden/surfaces.json");

fn numbers(row: &Value) -> Vec<Option<f64>> {
    row.as_array().unwrap().iter().map(Value::as_f64).collect()
}

/// Heights to 4e-15 of the patch's side per unit of steepness; S to 1e-11 at worst, R to 1e-11 of itself, where the
/// surface is as steep as nz = 0.02 (50 times the conditioning of a level place) and its exponents fractional.
#[test]
fn heights_normals_and_shape_agree_with_fifty_digits() {
    let cases: Value = serde_json::from_str(GOLDEN).unwrap();
    let mut worst: [(f64, String); 4] = Default::default();
    for case in cases.as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let text = format!(
            "[sweep]\nfingers = [0.0]\nat = [0.0]\nunreachable = \"skip\"\n{}",
            case["surface"].as_str().unwrap()
        );
        let surface = read_scene(&text).unwrap_or_else(|error| panic!("{name}: {error}")).world.surface;
        let points = case["points"].as_array().unwrap();
        assert!(points.len() >= 100, "{name}: {} points", points.len());
        for row in points {
            let row = numbers(row);
            let value = |i: usize| row[i].unwrap();
            let (x, y, nz) = (value(0), value(1), value(5));
            let found = surface.at(x, y).unwrap_or_else(|| panic!("{name}: nothing at ({x}, {y})"));
            let steep = 1.0 / nz.abs();
            let height = (found.point[2] - value(2)).abs() / (8.0 * steep);
            let normal =
                (0..3).map(|k| (found.local.normal[k] - value(3 + k)).abs()).fold(0.0, f64::max) / steep.powi(2);
            let curved = value(9);
            let shape = match (found.local.shape_index(), row[8]) {
                (Some(found), Some(expected)) => (found - expected).abs(),
                (None, None) => 0.0,
                other => panic!("{name} at ({x}, {y}): S {other:?}"),
            };
            let curvedness = (found.local.curvedness() - curved).abs() / if curved > 0.0 { curved } else { 1.0 };
            for (slot, error) in worst.iter_mut().zip([height, normal, shape, curvedness]) {
                if error > slot.0 {
                    *slot = (error, format!("{name} at ({x}, {y}), nz = {nz}"));
                }
            }
        }
    }
    for ((error, place), (what, allowed)) in
        worst.iter().zip([("height", 1e-15), ("normal", 1e-14), ("S", 1e-11), ("R", 1e-11)])
    {
        println!("{what:>8}: {error:.2e} at worst, {place}");
        assert!(*error <= allowed, "{what} off by {error:e}, {place}");
    }
}

/// Sagitta of 8 units on radii to 1e9, against the series d^2/(2r) (1 + (d/r)^2/4), exact there to rounding.
#[test]
fn large_radii_do_not_cancel() {
    for exponent in 5..=9 {
        let radius = 10.0_f64.powi(exponent);
        for kind in ["sphere", "cylinder"] {
            for tilt in ["", "rotation_deg = [1e-300, 0.0, 0.0]"] {
                let text = format!(
                    "[surface]\nkind = \"{kind}\"\nradius = {radius:?}\n{tilt}\n[sweep]\nfingers = [0.0]\nat = [0.0]\n"
                );
                let surface = read_scene(&text).unwrap().world.surface;
                let (x, y) = (3.0, 4.0);
                let square: f64 = if kind == "sphere" { x * x + y * y } else { y * y };
                let expected = -square / (2.0 * radius) * (1.0 + square / radius / radius / 4.0);
                let height = surface.height(x, y).unwrap();
                assert!(((height - expected) / expected).abs() < 1e-15, "{kind} {radius}: {height} {expected}");
                let local = surface.at(x, y).unwrap().local;
                assert!(
                    (local.curvedness() * radius * if kind == "sphere" { 1.0 } else { 2.0_f64.sqrt() } - 1.0).abs()
                        < 1e-15
                );
            }
        }
    }
}
