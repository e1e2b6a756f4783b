//! The highest degree in a single segment: 100 unknowns, Bernstein's basis of degree 9.

use super::HardCase;
use super::inputs::{equal, linspace, options, sites, sphere, tangent, with_heights, with_slopes};

pub(super) fn cases() -> Vec<HardCase> {
    let axis = linspace(-4.0, 4.0, 12);
    let sites = sites(&axis, &axis);
    vec![
        HardCase::contacts(
            "degree_nine_single_segment",
            "condition 7e3 with slopes",
            with_slopes(&sites, sphere(10.0)),
            options(9, tangent()),
        ),
        HardCase::contacts(
            "degree_nine_heights",
            "condition 3e5 without",
            with_heights(&sites, sphere(10.0)),
            options(9, equal()),
        ),
    ]
}
