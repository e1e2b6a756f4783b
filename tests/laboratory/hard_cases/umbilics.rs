//! Points where `k1 = k2`: the root in `H +- sqrt(H^2 - K)` cancels completely there.

use ndarray::Array2;

use super::HardCase;
use super::inputs::{equal, linspace, options, paraboloid, sphere, sweep, tangent, with_slopes};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Grid;

/// A generic umbilic (three lines of curvature or one) at the origin.
fn lemon(x: f64, y: f64) -> [f64; 3] {
    [
        -(x * x + y * y) / 16.0 + (x * x * x + x * y * y) / 512.0,
        -x / 8.0 + (3.0 * x * x + y * y) / 512.0,
        -y / 8.0 + x * y / 256.0,
    ]
}

/// `k1 = k2 = 0` at the origin, where S does not exist.
fn monkey_saddle(x: f64, y: f64) -> [f64; 3] {
    [(x * x * x - 3.0 * x * y * y) / 128.0, 3.0 * (x * x - y * y) / 128.0, -x * y * 6.0 / 128.0]
}

pub(super) fn cases() -> Vec<HardCase> {
    let nine = |degree| FitOptions { grid: [9, 9], ..options(degree, equal()) };
    let pixels = linspace(-10.0, 10.0, 21);
    let bowl = Array2::from_shape_fn((21, 21), |(i, j)| pixels[i] * pixels[i] + pixels[j] * pixels[j]);
    let whole = FitOptions { domain: Some([-10.0, 10.0, -10.0, 10.0]), grid: [20, 20], ..options(2, equal()) };
    vec![
        HardCase::contacts(
            "umbilic_paraboloid",
            "an umbilic at the vertex, data exact in doubles",
            with_slopes(&sweep(9), paraboloid),
            nine(2),
        ),
        HardCase::grid(
            "umbilic_cup_pixels",
            "x^2 + y^2 on pixels: a cup everywhere, where others find the wrong sign",
            Grid::new(pixels.clone(), pixels, bowl),
            whole,
        ),
        HardCase::contacts(
            "umbilic_lemon",
            "a generic umbilic: the direction of k1 rotates around it",
            with_slopes(&sweep(9), lemon),
            nine(3),
        ),
        HardCase::contacts(
            "umbilic_monkey_saddle",
            "a flat point on the shape grid: S is undefined there and nowhere else",
            with_slopes(&sweep(9), monkey_saddle),
            nine(3),
        ),
        HardCase::contacts(
            "umbilic_sphere_quartic",
            "a sphere that a quartic cannot hold: near-umbilic everywhere",
            with_slopes(&sweep(5), sphere(10.0)),
            options(4, tangent()),
        ),
    ]
}
