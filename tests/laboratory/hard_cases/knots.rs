//! Knots that coincide or nearly do, and contacts exactly on knots: right limits inside, the left limit at xmax.

use super::HardCase;
use super::inputs::{equal, options, sphere, sweep, with_slopes};
use palpate_fitting::fit::FitOptions;

/// `-|x| / 4 - y^2 / 16`; at x = 0 the right limit of the slope, as the spline's.
fn crease(x: f64, y: f64) -> [f64; 3] {
    [-x.abs() / 4.0 - y * y / 16.0, if x < 0.0 { 0.25 } else { -0.25 }, -y / 8.0]
}

/// Clamped knots over -4..4 with `inner` in x and none in y.
fn with_inner(degree: usize, inner: &[f64]) -> FitOptions {
    let ends = [vec![-4.0; degree + 1], vec![4.0; degree + 1]];
    let x = [&ends[0][..], inner, &ends[1]].concat();
    FitOptions { knots: Some([x, ends.concat()]), ..options(degree, equal()) }
}

pub(super) fn cases() -> Vec<HardCase> {
    let ball = || with_slopes(&sweep(9), sphere(10.0));
    let four = |degree| FitOptions { segments: [4, 4], grid: [9, 9], ..options(degree, equal()) };
    vec![
        HardCase::contacts("knots_coincident", "a double knot", ball(), with_inner(3, &[0.0, 0.0])),
        HardCase::contacts("knots_nearly_coincident", "two knots 1e-8 apart", ball(), with_inner(3, &[0.0, 1e-8])),
        HardCase::contacts(
            "crease_on_double_knot",
            "slopes measured on the knot where they jump",
            with_slopes(&sweep(9), crease),
            with_inner(2, &[0.0, 0.0]),
        ),
        HardCase::contacts("contacts_on_knots", "a contact on every knot and on xmax, ymax", ball(), four(2)),
        HardCase::contacts("degree_one_slopes_on_knots", "slopes of a polyhedron at its edges", ball(), four(1)),
    ]
}
