//! Spheres and diagonal cylinders of radius 10 to 1e9 on an 8-unit patch: sagittas down to 1.6e-8; and planes.

use super::inputs::{cylinder45, options, sphere, sweep, tangent, with_slopes};
use super::{Expectation, HardCase};

pub(super) fn cases() -> Vec<HardCase> {
    let ball = |name, radius| {
        let contacts = with_slopes(&sweep(5), sphere(radius));
        HardCase::contacts(name, "a sphere much larger than the patch", contacts, options(3, tangent()))
    };
    let log = |name, radius, degree| {
        let contacts = with_slopes(&sweep(5), cylinder45(radius));
        HardCase::contacts(name, "a cylinder along the diagonal of the patch", contacts, options(degree, tangent()))
    };
    let plane = |name, surface: fn(f64, f64) -> [f64; 3]| {
        let contacts = with_slopes(&sweep(3), surface);
        let case = HardCase::contacts(name, "flat is a finding, and S is null", contacts, options(2, tangent()));
        case.expecting(Expectation::Plane)
    };
    vec![
        ball("sphere_r1e3", 1e3),
        ball("sphere_r1e5", 1e5),
        ball("sphere_r1e7", 1e7),
        ball("sphere_r1e9", 1e9),
        log("cylinder45_r10", 10.0, 4),
        log("cylinder45_r1e3", 1e3, 3),
        log("cylinder45_r1e6", 1e6, 3),
        log("cylinder45_r1e9", 1e9, 3),
        plane("plane_level", |_, _| [0.0, 0.0, 0.0]),
        plane("plane_tilted", |x, y| [0.5 * x - 0.25 * y + 3.0, 0.5, -0.25]),
    ]
}
