//! A disc of radius 0.6 without contacts, wider than the support of one basis function: one column of E is empty and
//! its neighbours depend on a few contacts at the rim.

use super::inputs::{Lcg, equal, options, with_heights, with_slopes};
use super::{Expectation, HardCase};
use palpate_fitting::fit::FitOptions;

/// 600 sites over [-1, 1]^2 outside the disc.
fn sites_around_the_disc(lcg: &mut Lcg) -> Vec<[f64; 2]> {
    let mut sites = Vec::with_capacity(600);
    while sites.len() < 600 {
        let (a, b) = (2.0 * lcg.uniform() - 1.0, 2.0 * lcg.uniform() - 1.0);
        if a * a + b * b >= 0.36 {
            sites.push([a, b]);
        }
    }
    sites
}

/// `1 / (1 + a^2 + 2 b^2)`, noise of sd 0.01 on the height.
fn hill(lcg: &mut Lcg, a: f64, b: f64) -> [f64; 3] {
    let q = 1.0 + a * a + 2.0 * b * b;
    [1.0 / q + 0.01 * lcg.normal(), -2.0 * a / (q * q), -4.0 * b / (q * q)]
}

pub(super) fn cases() -> Vec<HardCase> {
    let lcg = &mut Lcg::new(1997);
    let sites = sites_around_the_disc(lcg);
    let heights = with_heights(&sites, |a, b| hill(lcg, a, b));
    let slopes = with_slopes(&sites, |a, b| hill(lcg, a, b));
    let flank = with_heights(&sites, |a, b| hill(lcg, a - 1.0, b));
    let options =
        FitOptions { segments: [10, 10], domain: Some([-1.0, 1.0, -1.0, 1.0]), grid: [21, 21], ..options(3, equal()) };
    let case =
        |name, tests, contacts| HardCase::contacts(name, tests, contacts, options.clone()).expecting(Expectation::Gap);
    vec![
        case("disc_gap_heights", "plain least squares says 687 inside the hole of data in 0.25 to 0.75", heights),
        case("disc_gap_slopes", "the same hole with slopes at its rim", slopes),
        case("disc_gap_flank", "the same hole on the flank of a hill whose top is touched", flank),
    ]
}
