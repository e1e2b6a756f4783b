//! Contacts that are plainly wrong, by a factor of 1e6: a large residual reported, not hidden.

use super::HardCase;
use super::inputs::{options, sphere, sweep, tangent, with_slopes};
use palpate_geometry::contact::Orientation;

pub(super) fn cases() -> Vec<HardCase> {
    let mut heights = with_slopes(&sweep(5), sphere(10.0));
    (heights.z[7], heights.z[31]) = (1e6, -1e6);
    let mut slope = with_slopes(&sweep(5), sphere(10.0));
    if let Orientation::Slopes { zx, .. } = &mut slope.orientation {
        zx[22] = 1e6;
    }
    vec![
        HardCase::contacts("gross_outlier_heights", "two heights of +-1e6", heights, options(3, tangent())),
        HardCase::contacts("gross_outlier_slope", "one slope of 1e6", slope, options(3, tangent())),
    ]
}
