//! One solid about the origin: its faces, each with its distance, normal, curvatures, area and even points.
//!
//! ```text
//! block  6 rectangles        bar  mantle, 2 discs        frustum  cone, 1 or 2 discs        ball, ring  one face
//! at(a, b): (a, b) in the unit square -> the face, equal areas to equal areas
//! ```

use super::SceneError;
use super::local::Local;
use crate::scene::error::positive;
use palpate_numeric::vector::{Vector, along, dot, norm, scaled, unit};

/// A solid about the origin, its axis along z. Lengths in input units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum SolidShape {
    /// A box with these sides.
    Block {
        /// Along x, y, z.
        size: [f64; 3],
    },
    /// A ball.
    Ball {
        /// Its radius.
        radius: f64,
    },
    /// A round bar with flat ends.
    Bar {
        /// Its radius.
        radius: f64,
        /// From end to end.
        length: f64,
    },
    /// A cone without its tip, or with it where `top` is 0.
    Frustum {
        /// Radius of the lower end.
        radius: f64,
        /// Radius of the upper end, less than the other.
        top: f64,
        /// From end to end.
        length: f64,
    },
    /// A ring lying flat.
    Ring {
        /// Radius of its centre line.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
}

/// One face of a solid, in the solid's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Face {
    /// A rectangle about `offset * normal` with half sides along u and v.
    Rectangle {
        normal: Vector,
        offset: f64,
        u: Vector,
        v: Vector,
    },
    /// A disc across z at this height, facing up or down.
    Disc {
        height: f64,
        radius: f64,
        up: f64,
    },
    Sphere {
        radius: f64,
    },
    Mantle {
        radius: f64,
        half: f64,
    },
    Cone {
        radius: f64,
        top: f64,
        half: f64,
    },
    Tube {
        major: f64,
        minor: f64,
    },
}

impl SolidShape {
    /// The words of scene files.
    pub const KINDS: [&'static str; 5] = ["block", "ball", "bar", "frustum", "ring"];

    pub(super) fn faces(&self) -> Vec<Face> {
        match *self {
            SolidShape::Block { size } => (0..6)
                .map(|k| {
                    let axis = |i: usize, length: f64| {
                        let mut v = [0.0; 3];
                        v[i % 3] = length;
                        v
                    };
                    let (i, sign) = (k / 2, if k % 2 == 0 { 1.0 } else { -1.0 });
                    let half = |i: usize| 0.5 * size[i % 3];
                    let (u, v) = (axis(i + 1, half(i + 1)), axis(i + 2, half(i + 2)));
                    Face::Rectangle { normal: axis(i, sign), offset: half(i), u, v }
                })
                .collect(),
            SolidShape::Ball { radius } => vec![Face::Sphere { radius }],
            SolidShape::Bar { radius, length } => {
                let half = 0.5 * length;
                vec![
                    Face::Mantle { radius, half },
                    Face::Disc { height: half, radius, up: 1.0 },
                    Face::Disc { height: -half, radius, up: -1.0 },
                ]
            }
            SolidShape::Frustum { radius, top, length } => {
                let half = 0.5 * length;
                let mut faces = vec![Face::Cone { radius, top, half }, Face::Disc { height: -half, radius, up: -1.0 }];
                if top > 0.0 {
                    faces.push(Face::Disc { height: half, radius: top, up: 1.0 });
                }
                faces
            }
            SolidShape::Ring { major, minor } => vec![Face::Tube { major, minor }],
        }
    }

    pub(super) fn check(&self) -> Result<(), SceneError> {
        match *self {
            SolidShape::Block { size } => size.iter().try_for_each(|s| positive("surface.parts.size", *s)),
            SolidShape::Ball { radius } => positive("surface.parts.radius", radius),
            SolidShape::Bar { radius, length } => {
                positive("surface.parts.radius", radius)?;
                positive("surface.parts.length", length)
            }
            SolidShape::Frustum { radius, top, length } => {
                positive("surface.parts.radius", radius)?;
                positive("surface.parts.length", length)?;
                if (0.0..radius).contains(&top) {
                    return Ok(());
                }
                Err(SceneError::range("surface.parts.top", top, "zero or more and less than the radius is needed"))
            }
            SolidShape::Ring { major, minor } => {
                positive("surface.parts.minor", minor)?;
                if minor < major && major.is_finite() {
                    return Ok(());
                }
                Err(SceneError::range("surface.parts.major", major, "more than the minor radius is needed"))
            }
        }
    }

    /// Radius of a ball about the origin that holds it.
    pub(super) fn reach(&self) -> f64 {
        match *self {
            SolidShape::Block { size } => 0.5 * norm(size),
            SolidShape::Ball { radius } => radius,
            SolidShape::Bar { radius, length } | SolidShape::Frustum { radius, length, .. } => {
                radius.hypot(0.5 * length)
            }
            SolidShape::Ring { major, minor } => major + minor,
        }
    }
}

impl Face {
    pub(super) fn word(&self) -> &'static str {
        match self {
            Face::Rectangle { .. } | Face::Disc { .. } => "plane",
            Face::Sphere { .. } => "sphere",
            Face::Mantle { .. } => "cylinder",
            Face::Cone { .. } => "cone",
            Face::Tube { .. } => "torus",
        }
    }

    pub(super) fn distance(&self, p: Vector) -> f64 {
        let rho = p[0].hypot(p[1]);
        match *self {
            Face::Rectangle { normal, offset, .. } => dot(normal, p) - offset,
            Face::Disc { height, up, .. } => up * (p[2] - height),
            Face::Sphere { radius } => norm(p) - radius,
            Face::Mantle { radius, .. } => rho - radius,
            Face::Cone { radius, top, half } => {
                let [sin, cos] = cone_angle(radius, top, half);
                (rho - radius) * cos + (p[2] + half) * sin
            }
            Face::Tube { major, minor } => (rho - major).hypot(p[2]) - minor,
        }
    }

    /// Normal and curvatures at a point of the face.
    pub(super) fn local(&self, p: Vector) -> Option<Local> {
        let rho = p[0].hypot(p[1]);
        let radial = if rho > 0.0 { [p[0] / rho, p[1] / rho, 0.0] } else { [1.0, 0.0, 0.0] };
        Some(match *self {
            Face::Rectangle { normal, .. } => Local::known(normal, 0.0, 0.0),
            Face::Disc { up, .. } => Local::known([0.0, 0.0, up], 0.0, 0.0),
            Face::Sphere { radius } => Local::known(unit(p), -1.0 / radius, -1.0 / radius),
            Face::Mantle { radius, .. } => Local::known(radial, 0.0, -1.0 / radius),
            Face::Cone { radius, top, half } => {
                let [sin, cos] = cone_angle(radius, top, half);
                // the tip has no normal
                let curvature = (rho > 0.0).then(|| -cos / rho)?;
                Local::known([cos * radial[0], cos * radial[1], sin], 0.0, curvature)
            }
            Face::Tube { major, minor } => {
                let [c, s] = [(rho - major) / minor, p[2] / minor];
                Local::known(unit([c * radial[0], c * radial[1], s]), -1.0 / minor, -c / rho)
            }
        })
    }

    pub(super) fn area(&self) -> f64 {
        use std::f64::consts::PI;
        match *self {
            Face::Rectangle { u, v, .. } => 4.0 * norm(u) * norm(v),
            Face::Disc { radius, .. } => PI * radius * radius,
            Face::Sphere { radius } => 4.0 * PI * radius * radius,
            Face::Mantle { radius, half } => 4.0 * PI * radius * half,
            Face::Cone { radius, top, half } => PI * (radius + top) * (radius - top).hypot(2.0 * half),
            Face::Tube { major, minor } => 4.0 * PI * PI * major * minor,
        }
    }

    /// The point at (a, b) in the unit square, equal areas of which are equal areas of the face.
    pub(super) fn at(&self, a: f64, b: f64) -> Vector {
        let turn = 2.0 * std::f64::consts::PI * a;
        let (sin, cos) = turn.sin_cos();
        let round = |rho: f64, z: f64| [rho * cos, rho * sin, z];
        match *self {
            Face::Rectangle { normal, offset, u, v } => {
                along(along(scaled(offset, normal), 2.0 * a - 1.0, u), 2.0 * b - 1.0, v)
            }
            Face::Disc { height, radius, .. } => round(radius * b.sqrt(), height),
            Face::Sphere { radius } => {
                let z = 2.0 * b - 1.0;
                round(radius * (1.0 - z * z).sqrt(), radius * z)
            }
            Face::Mantle { radius, half } => round(radius, half * (2.0 * b - 1.0)),
            Face::Cone { radius, top, half } => {
                let rho = (top * top + b * (radius * radius - top * top)).sqrt();
                round(rho, half - 2.0 * half * (rho - top) / (radius - top))
            }
            Face::Tube { major, minor } => {
                // the area grows as (major + minor cos v): v + (minor / major) sin v = 2 pi b
                let (ratio, mean) = (minor / major, 2.0 * std::f64::consts::PI * b);
                let mut v = mean;
                for _ in 0..60 {
                    let step = (v + ratio * v.sin() - mean) / (1.0 + ratio * v.cos());
                    v -= step.clamp(-0.5, 0.5);
                }
                round(major + minor * v.cos(), minor * v.sin())
            }
        }
    }
}

/// Sine and cosine of the angle between a cone's mantle and its axis.
fn cone_angle(radius: f64, top: f64, half: f64) -> [f64; 2] {
    let slant = (radius - top).hypot(2.0 * half);
    [(radius - top) / slant, 2.0 * half / slant]
}
