//! No heights: the surface is known up to a constant, the shape completely.

use super::inputs::{equal, explicit, options, sphere, sweep, with_slopes};
use super::{Expectation, HardCase};

pub(super) fn cases() -> Vec<HardCase> {
    let ball = with_slopes(&sweep(5), sphere(10.0));
    let mut by_row = ball.clone();
    by_row.weights.z = Some(vec![0.0; by_row.len()]);
    let case = |name, tests, contacts, objective| {
        HardCase::contacts(name, tests, contacts, options(3, objective)).expecting(Expectation::UpToHeight)
    };
    vec![
        case("slopes_only", "the block of heights has weight zero", ball, explicit(0.0, 1.0, 1.0)),
        case("slopes_only_by_row_weights", "every contact's height has weight zero", by_row, equal()),
    ]
}
