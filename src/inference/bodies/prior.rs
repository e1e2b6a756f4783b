//! What is thought of a primitive before any contact is looked at: densities in the coordinates by which the descent moves it.
//!
//! ```text
//! lengths in units of the contacts' size, c from their middle
//! p(h) = 1/2 in -1 < h < 1           the surface passes near the contacts
//! p(direction) = 1/(4 pi)            which of its places does; of an axis 1/(2 pi)
//! p(k) = 2 / (pi (1 + k^2))          half Cauchy: half of all radii lie beyond the contacts' size
//! p(angle of a cone) = 1/pi          -90 to 90 degrees
//! sphere    dh domega dk = dc dr / (|c|^2 r^2)        1 + |c|^2 in place of |c|^2 keeps it finite where c is the middle
//! ```

use std::f64::consts::PI;

use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_numeric::vector::dot;

/// Log density of a primitive by `tau omega size1 size2`, as far as its kind has them.
pub(super) fn log_prior(primitive: &Primitive) -> f64 {
    let c = primitive.origin;
    let height = 0.5_f64.ln();
    let axis = -(2.0 * PI).ln();
    // a radius r through its curvature 1/r
    let radius = |r: f64| (2.0 / (PI * (1.0 + r * r))).ln();
    let around_point = -(4.0 * PI * (1.0 + dot(c, c))).ln();
    let across = primitive.own([0.0; 3]);
    let around_axis = -(2.0 * PI * (1.0 + across[0].hypot(across[1]))).ln();
    let [one, two] = primitive.sizes;
    match primitive.kind {
        PartKind::Plane | PartKind::Patch => height + axis,
        PartKind::Sphere => height + around_point + radius(one),
        PartKind::Cylinder => height + axis + around_axis + radius(one),
        PartKind::Cone => height + axis + around_axis + radius(one) - PI.ln(),
        PartKind::Torus => height + around_point + axis + radius(one) + radius(two),
    }
}

/// Standard deviations that bound each unknown where contacts leave it open.
pub(super) fn widths(primitive: &Primitive) -> [f64; MOST_UNKNOWNS] {
    let c = primitive.origin;
    let place = 1.0 + dot(c, c).sqrt();
    let [one, two] = primitive.sizes.map(|r| 1.0 + r * r);
    let second = if primitive.kind == PartKind::Cone { 1.0 } else { two };
    [place, place, place, 1.0, 1.0, one, second]
}
