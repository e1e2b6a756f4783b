//! Many contacts within one ten-thousandth of the patch, and a few elsewhere.

use super::HardCase;
use super::inputs::{Lcg, equal, linspace, options, sites, sphere, with_heights, with_slopes};

/// `wide` x `wide` sites over the patch, then `count` within 0.0008 around (1, 1).
fn crowd(count: usize, wide: usize) -> Vec<[f64; 2]> {
    let lcg = &mut Lcg::new(24);
    let axis = linspace(-4.0, 4.0, wide);
    let mut sites = sites(&axis, &axis);
    for _ in 0..count {
        let x = 1.0 + 0.0008 * (lcg.uniform() - 0.5);
        sites.push([x, 1.0 + 0.0008 * (lcg.uniform() - 0.5)]);
    }
    sites
}

pub(super) fn cases() -> Vec<HardCase> {
    vec![
        HardCase::contacts(
            "clustered_ten_thousand_to_one",
            "10,000 contacts in one spot and 9 elsewhere",
            with_slopes(&crowd(10_000, 3), sphere(10.0)),
            options(2, equal()),
        ),
        HardCase::contacts(
            "clustered_heights",
            "200 heights 10,000 times closer to each other than the other 16",
            with_heights(&crowd(200, 4), sphere(10.0)),
            options(2, equal()),
        ),
    ]
}
