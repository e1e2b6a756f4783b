//! Grids whose normal matrices are as bad as Hilbert's: axes at 1/12, 1/11, .. 1, and degree 9 over equal steps.

use ndarray::Array2;

use super::HardCase;
use super::inputs::{equal, linspace, options};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Grid;

/// Heights `1 / (1 + x + y)` on the product of an axis with itself.
fn bowl(axis: Vec<f64>) -> Grid {
    let z = Array2::from_shape_fn((axis.len(), axis.len()), |(i, j)| 1.0 / (1.0 + axis[i] + axis[j]));
    Grid::new(axis.clone(), axis, z)
}

fn over(degree: usize, low: f64) -> FitOptions {
    FitOptions { domain: Some([low, 1.0, low, 1.0]), ..options(degree, equal()) }
}

pub(super) fn cases() -> Vec<HardCase> {
    let reciprocal = (1..=12).map(|i| 1.0 / (13 - i) as f64).collect();
    vec![
        HardCase::grid("hilbert_axes", "pixels at 1/12, 1/11, .. 1", bowl(reciprocal), over(5, 1.0 / 12.0)),
        HardCase::grid(
            "hilbert_even_degree_nine",
            "twelve equal steps carry ten unknowns each way",
            bowl(linspace(0.0, 1.0, 12)),
            over(9, 0.0),
        ),
    ]
}
