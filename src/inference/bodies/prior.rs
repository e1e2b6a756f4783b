//! What is thought of a primitive before any contact is looked at: densities in the coordinates by which the descent moves it.
//!
//! ```text
//! lengths in units of the contacts' size, c from their middle
//! p(h) = 1/2 in -1 < h < 1           the surface passes near the contacts
//! p(direction) = 1/(4 pi)            which of its places does; of an axis 1/(2 pi)
//! p(k) = 2 / (pi (1 + k^2))          half Cauchy: half of all radii lie beyond the contacts' size
//! p(angle of a cone) = 1/pi          -90 to 90 degrees
//! p(ln a, ln b, ln c) about their mean: gaussian, `Tuning::half_axes` in two directions    of an ellipsoid; its mean as a radius
//! sphere    dh domega dk = dc dr / (|c|^2 r^2)        1 + |c|^2 in place of |c|^2 keeps it finite where c is the middle
//! ```

use std::f64::consts::PI;

use super::coordinates::DepartureOver;
use super::tuning::Tuning;
use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_numeric::vector::dot;

/// Log density of a primitive by `tau omega sizes`, as far as its kind has them.
pub(super) fn log_prior(primitive: &Primitive, tuning: &Tuning) -> f64 {
    let c = primitive.origin;
    let height = 0.5_f64.ln();
    let axis = -(2.0 * PI).ln();
    // a radius r through its curvature 1/r
    let radius = |r: f64| (2.0 / (PI * (1.0 + r * r))).ln();
    let around_point = -(4.0 * PI * (1.0 + dot(c, c))).ln();
    let across = primitive.own([0.0; 3]);
    let around_axis = -(2.0 * PI * (1.0 + across[0].hypot(across[1]))).ln();
    let [one, two, three] = primitive.sizes;
    match primitive.kind {
        PartKind::Plane | PartKind::Patch => height + axis,
        PartKind::Sphere => height + around_point + radius(one),
        PartKind::Cylinder => height + axis + around_axis + radius(one),
        PartKind::Cone => height + axis + around_axis + radius(one) - PI.ln(),
        PartKind::Torus => height + around_point + axis + radius(one) + radius(two),
        PartKind::Ellipsoid => {
            let of_shape = half_axes([one, two, three], tuning.half_axes);
            height + around_point + orientation() + of_shape + radius_of(primitive)
        }
    }
}

/// Log density of the axis of a departure that is as large as the body, as far as it has one.
pub(super) fn log_prior_of_axis(base: &Primitive, over: DepartureOver) -> f64 {
    let direction = -(2.0 * PI).ln();
    let across = base.own([0.0; 3]);
    match over {
        DepartureOver::Feet | DepartureOver::Section | DepartureOver::Space => 0.0,
        // the axis passes near the contacts
        DepartureOver::Turned => direction - (2.0 * PI * (1.0 + across[0].hypot(across[1]))).ln(),
        DepartureOver::Extruded => direction,
    }
}

/// Density of a frame, 1 over 8 pi^2, times the 24 frames in which an ellipsoid is the same but for the order of its half axes.
fn orientation() -> f64 {
    (24.0 / (8.0 * PI * PI)).ln()
}

/// Log density of three half axes given their geometric mean r, by the half axes: gaussian in the two differences of the logarithms, each
/// with this standard deviation.
fn half_axes(sizes: [f64; 3], sd: f64) -> f64 {
    let logs = sizes.map(f64::ln);
    let mean = logs.iter().sum::<f64>() / 3.0;
    let square: f64 = logs.iter().map(|l| (l - mean).powi(2)).sum();
    // d(ln r) = d(sum of the logs)/3, which is 1/sqrt 3 of an orthonormal coordinate; r's own density is by r
    let jacobian = mean - 0.5 * 3.0_f64.ln() - logs.iter().sum::<f64>();
    -(2.0 * PI * sd * sd).ln() - 0.5 * square / (sd * sd) + jacobian
}

/// Log density of the geometric mean of an ellipsoid's half axes, as of a radius.
fn radius_of(primitive: &Primitive) -> f64 {
    let r = primitive.sizes.iter().map(|a| a.ln()).sum::<f64>() / 3.0;
    (2.0 / (PI * (1.0 + (2.0 * r).exp()))).ln()
}

/// Standard deviations that bound each unknown where contacts leave it open.
pub(super) fn widths(primitive: &Primitive) -> [f64; MOST_UNKNOWNS] {
    let c = primitive.origin;
    let place = 1.0 + dot(c, c).sqrt();
    let [one, two, three] = primitive.sizes.map(|r| 1.0 + r * r);
    let second = if primitive.kind == PartKind::Cone { 1.0 } else { two };
    [place, place, place, 1.0, 1.0, one, second, three, 1.0]
}
