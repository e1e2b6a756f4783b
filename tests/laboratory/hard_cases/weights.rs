//! Weights that differ by 1e12, between heights and slopes and between contacts. Each case has a solution of its own; it is
//! not one problem scaled.

use super::HardCase;
use super::inputs::{Lcg, equal, explicit, options, sphere, sweep, with_slopes};
use palpate_geometry::contact::Contacts;

/// A sphere with noise of sd 0.01 on the heights, so that heights and slopes contradict each other.
fn noisy() -> Contacts {
    let lcg = &mut Lcg::new(7);
    let mut contacts = with_slopes(&sweep(5), sphere(10.0));
    contacts.z.iter_mut().for_each(|z| *z += 0.01 * lcg.normal());
    contacts
}

pub(super) fn cases() -> Vec<HardCase> {
    let mut by_row = noisy();
    by_row.weights.z = Some((0..by_row.len()).map(|r| [1e12, 1.0, 1e-12][r % 3]).collect());
    vec![
        HardCase::contacts(
            "weights_heights_1e12",
            "heights rule, slopes fill in",
            noisy(),
            options(3, explicit(1e12, 1.0, 1.0)),
        ),
        HardCase::contacts(
            "weights_slopes_1e12",
            "slopes rule; the mean height hangs on rows 1e-12 as heavy",
            noisy(),
            options(3, explicit(1e-12, 1.0, 1.0)),
        ),
        HardCase::contacts(
            "weights_rows_1e12",
            "heights of contacts weighted 1e12, 1, 1e-12 in turn",
            by_row,
            options(3, equal()),
        ),
        HardCase::contacts(
            "weights_blocks_1e12",
            "x slopes weighted 1e12, y slopes 1e-12",
            noisy(),
            options(3, explicit(1.0, 1e12, 1e-12)),
        ),
    ]
}
