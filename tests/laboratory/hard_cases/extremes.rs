//! Numbers whose squares overflow or vanish.

use super::HardCase;
use super::inputs::{FULL, equal, explicit, options, sphere, sweep, tangent, with_slopes};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::{Contacts, Orientation};

fn ball() -> Contacts {
    with_slopes(&sweep(5), sphere(10.0))
}

/// All lengths times a power of two.
fn lengths(name: &'static str, tests: &'static str, by: f64) -> HardCase {
    let mut contacts = ball();
    for column in [&mut contacts.x, &mut contacts.y, &mut contacts.z] {
        column.iter_mut().for_each(|v| *v *= by);
    }
    let options = FitOptions { domain: Some(FULL.map(|v| v * by)), ..options(2, tangent()) };
    HardCase::contacts(name, tests, contacts, options)
}

/// Heights and slopes alone times a number: another surface.
fn heights(name: &'static str, tests: &'static str, by: f64) -> HardCase {
    let mut contacts = ball();
    contacts.z.iter_mut().for_each(|v| *v *= by);
    if let Orientation::Slopes { zx, zy } = &mut contacts.orientation {
        zx.iter_mut().chain(zy).for_each(|v| *v *= by);
    }
    HardCase::contacts(name, tests, contacts, options(2, equal()))
}

pub(super) fn cases() -> Vec<HardCase> {
    let uniform = |name, tests, w| HardCase::contacts(name, tests, ball(), options(2, explicit(w, w, w)));
    vec![
        lengths("lengths_near_overflow", "lengths of 1e301: squares overflow", 2.0_f64.powi(1000)),
        lengths("lengths_near_underflow", "lengths of 1e-301: squares vanish", 2.0_f64.powi(-1000)),
        heights("heights_1e100", "slopes of 1e100: curvatures of 1e-200, whose squares vanish", 1e100),
        heights("heights_1e_minus_200", "curvatures of 1e-200 over an honest patch", 1e-200),
        uniform("weights_1e200", "weights whose squares overflow", 1e200),
        uniform("weights_1e_minus_200", "weights whose squares vanish", 1e-200),
    ]
}
