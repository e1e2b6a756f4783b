//! The paper reproduced from the built-in scenes: Figures 4, 5, 6, the planes of 5.3, the model part of Table 2.
//!
//! The figures are those of an independent least squares fit (dense NumPy) on the 8 x 8 patch: means and sample sds of S
//! over the 4 x 4 grid, rounded to the digits given; the comparison allows 0.001.

use palpate::Fit;
use palpate::fit::{Method, fit_contacts};
use palpate::geometry::ShapeClass;
use palpate_app::io::scene_file::builtin;

fn fit_scene(name: &str, method: Method) -> Fit {
    let scene = builtin(name).unwrap_or_else(|e| panic!("{name}: {e}"));
    let (contacts, _) = scene.world.compile().unwrap().simulate(scene.seed, 0);
    fit_contacts(&contacts, &scene.fit.with_method(method)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn run(name: &str) -> Fit {
    fit_scene(name, Method::Auto)
}

fn near(found: Option<f64>, expected: f64, tolerance: f64, what: &str) {
    let found = found.unwrap_or_else(|| panic!("{what}: undefined"));
    assert!((found - expected).abs() <= tolerance, "{what}: {found} for {expected}");
}

const ANGLES: [u32; 7] = [0, 10, 30, 45, 60, 80, 90];
const RADII: [&str; 6] = ["5.7", "6", "8", "10", "20", "50"];

#[test]
fn figure_4_rms_error_of_s_on_turned_cylinders() {
    let table = [
        ("6", "", [0.0, 0.0263, 0.2524, 0.3125, 0.2361, 0.0228, 0.0]),
        ("10", "", [0.0, 0.0036, 0.0409, 0.0610, 0.0403, 0.0036, 0.0]),
        ("20", "", [0.0, 0.0007, 0.0079, 0.0119, 0.0079, 0.0007, 0.0]),
        ("6", "-position", [0.0, 0.0208, 0.1982, 0.2474, 0.1910, 0.0207, 0.0]),
        ("10", "-position", [0.0, 0.0035, 0.0388, 0.0582, 0.0389, 0.0037, 0.0]),
        ("20", "-position", [0.0, 0.0007, 0.0079, 0.0118, 0.0079, 0.0007, 0.0]),
    ];
    for (radius, weights, errors) in table {
        for (angle, expected) in ANGLES.iter().zip(errors) {
            let name = format!("paper-fig4-r{radius}-{angle}deg{weights}");
            let fit = run(&name);
            let maps = &fit.shape().maps;
            let squares: f64 = maps.shape_index.iter().map(|s| (s - 0.5).powi(2)).sum();
            near(Some((squares / maps.grid.len() as f64).sqrt()), expected, 0.001, &name);
        }
    }
}

fn means_and_sds(figure: &str, degree: usize, weights: &str, expected: [(f64, f64); 6]) {
    for (radius, (mean, sd)) in RADII.iter().zip(expected) {
        let name = format!("paper-{figure}-r{radius}-degree{degree}{weights}");
        let fit = run(&name);
        near(fit.shape().shape_index.mean, mean, 0.001, &name);
        near(fit.shape().shape_index.sd, sd, 0.001, &name);
    }
}

#[test]
fn figure_5_cylinders_at_45_degrees() {
    let two = [(0.153, 0.366), (0.386, 0.300), (0.500, 0.124), (0.501, 0.063), (0.500, 0.012), (0.500, 0.002)];
    means_and_sds("fig5", 2, "", two);
    let two = [(0.353, 0.301), (0.469, 0.254), (0.511, 0.112), (0.506, 0.060), (0.502, 0.012), (0.500, 0.002)];
    means_and_sds("fig5", 2, "-position", two);
    let four = [(0.191, 0.373), (0.449, 0.255), (0.501, 0.027), (0.500, 0.007), (0.500, 0.0), (0.500, 0.0)];
    means_and_sds("fig5", 4, "", four);
    let four = [(0.133, 0.372), (0.457, 0.255), (0.503, 0.028), (0.501, 0.007), (0.500, 0.0), (0.500, 0.0)];
    means_and_sds("fig5", 4, "-position", four);
}

#[test]
fn figure_6_spheres() {
    let tangent = [(0.182, 0.378), (0.651, 0.215), (0.926, 0.056), (0.958, 0.035), (0.990, 0.008), (0.999, 0.001)];
    let position = [(0.463, 0.362), (0.779, 0.100), (0.934, 0.053), (0.962, 0.035), (0.991, 0.009), (0.999, 0.001)];
    for degree in [2, 3] {
        means_and_sds("fig6", degree, "", tangent);
        means_and_sds("fig6", degree, "-position", position);
    }
    let four = [(0.315, 0.473), (0.869, 0.117), (0.991, 0.005), (0.997, 0.002), (1.0, 0.0), (1.0, 0.0)];
    means_and_sds("fig6", 4, "", four);
    let four = [(0.220, 0.528), (0.816, 0.184), (0.990, 0.006), (0.997, 0.002), (1.0, 0.0), (1.0, 0.0)];
    means_and_sds("fig6", 4, "-position", four);
}

/// The paper found S worse at radius 1000 and at high degrees; with heights measured from the patch nothing remains.
#[test]
fn radius_1000_is_no_harder() {
    for weights in ["", "-position"] {
        for degree in [2, 4] {
            let name = format!("paper-fig5-r1000-degree{degree}{weights}");
            near(run(&name).shape().shape_index.mean, 0.5, 1e-4, &name);
        }
        for degree in [2, 3, 4] {
            let name = format!("paper-fig6-r1000-degree{degree}{weights}");
            near(run(&name).shape().shape_index.mean, 1.0, 1e-4, &name);
        }
    }
}

#[test]
fn planes_of_section_5_3() {
    for name in ["paper-plane", "paper-plane-tilted", "paper-plane-oblique"] {
        let fit = run(name);
        let shape = fit.shape();
        assert_eq!(shape.class, ShapeClass::Plane, "{name}");
        assert_eq!(shape.shape_index.mean, None, "{name}");
        assert!(shape.curvedness.mean.unwrap() < 1e-12, "{name}");
    }
}

#[test]
fn table_2_model_part() {
    for (name, r, sd, radius) in
        [("paper-cylinder", 0.10177, 0.02465, 6.95), ("paper-cylinder-position", 0.09547, 0.01960, 7.41)]
    {
        let fit = run(name);
        let shape = fit.shape();
        assert_eq!(shape.class, ShapeClass::Ridge);
        near(shape.shape_index.mean, 0.5, 1e-12, name);
        near(shape.curvedness.mean, r, 0.00001, name);
        near(shape.curvedness.sd, sd, 0.00001, name);
        near(shape.radius, radius, 0.005, name);
    }
}

#[test]
fn cholesky_and_qr_agree_on_every_built_in_scene_without_effects() {
    let mut worst = 0.0_f64;
    use palpate_app::io::scene_file::{builtin_scenes, family_members};
    for scene in builtin_scenes().into_iter().chain(family_members()) {
        // surfaces in space, and bodies of several faces, have no height field to compare
        if scene.name.starts_with("parts-") {
            continue;
        }
        if palpate_app::io::scene_file::builtin(&scene.name).unwrap().fit.surface
            == palpate::fit::SurfaceKind::Parametric
        {
            continue;
        }
        let (a, b) = (fit_scene(&scene.name, Method::Cholesky), fit_scene(&scene.name, Method::Qr));
        let (a, b) = (&a.solution().coefficients, &b.solution().coefficients);
        let largest = a.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let gap = a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
        // a level plane has coefficients of size zero: there the gap itself is held
        worst = worst.max(gap / largest.max(1e-3));
        assert!(gap <= 1e-12 * largest.max(1e-3), "{}: {gap:e} of {largest:e}", scene.name);
    }
    println!("largest relative difference between Cholesky and QR: {worst:e}");
}
