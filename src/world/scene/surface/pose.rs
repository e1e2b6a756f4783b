//! Where a body stands: `P = offset + Rz(rz) Ry(ry) Rx(rx) Rz(axis) p`, angles in degrees.
//!
//! `axis_deg` rotates the body about its own z axis before anything else (a cylinder's generators from +x towards +y).
//! When rx = ry = 0 the body stands upright: its closed-form height is used with an exact plane rotation.

use crate::scene::rotation::{Matrix, product, rotated, rotated_back, rotation};
use palpate_numeric::vector::Vector;
#[cfg(feature = "serde")]
use palpate_numeric::vector::{cross, dot, minus, norm};

/// Rotation and offset of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "StoredPose"))]
pub struct Pose {
    matrix: Matrix,
    offset: Vector,
    upright: bool,
}

/// A pose as `serde` reads it, before its numbers are known to be a rotation.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredPose {
    matrix: Matrix,
    offset: Vector,
    upright: bool,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredPose> for Pose {
    type Error = &'static str;

    fn try_from(StoredPose { matrix, offset, upright }: StoredPose) -> Result<Pose, &'static str> {
        let [x, y, z] = matrix;
        // rounding leaves 1e-15; a text with six digits leaves 1e-6
        let is_unit = |a: Vector| (dot(a, a) - 1.0).abs() < 1e-5;
        let is_rotation = is_unit(x) && is_unit(y) && dot(x, y).abs() < 1e-5 && norm(minus(cross(x, y), z)) < 1e-5;
        if !is_rotation {
            return Err("the matrix of a pose must be a rotation");
        }
        if !offset.iter().all(|v| v.is_finite()) {
            return Err("the offset of a pose must be three finite numbers");
        }
        if upright && (z != [0.0, 0.0, 1.0] || [x[2], y[2]] != [0.0; 2]) {
            return Err("the matrix of an upright pose must leave the z axis alone");
        }
        Ok(Pose { matrix, offset, upright })
    }
}

impl Pose {
    /// `axis_deg` about the body's z axis, then `rotation_deg` about the fixed axes x, y, z in that order, then
    /// `offset` (input units).
    pub fn new(axis_deg: f64, rotation_deg: [f64; 3], offset: [f64; 3]) -> Pose {
        let [rx, ry, rz] = rotation_deg;
        let upright = rx == 0.0 && ry == 0.0;
        let matrix = if upright {
            rotation([0.0, 0.0, axis_deg + rz])
        } else {
            product(&rotation(rotation_deg), &rotation([0.0, 0.0, axis_deg]))
        };
        Pose { matrix, offset, upright }
    }

    /// Whether the body's z axis is the world's.
    pub(crate) fn upright(&self) -> bool {
        self.upright
    }

    /// A world point in body coordinates.
    #[inline]
    pub(crate) fn to_body(self, p: Vector) -> Vector {
        rotated_back(&self.matrix, [p[0] - self.offset[0], p[1] - self.offset[1], p[2] - self.offset[2]])
    }

    /// A point of the body in the world.
    pub(crate) fn to_world(self, p: Vector) -> Vector {
        let rotated = rotated(&self.matrix, p);
        [0, 1, 2].map(|k| rotated[k] + self.offset[k])
    }

    /// A direction of the body in the world.
    #[inline]
    pub(crate) fn direction_to_world(self, v: Vector) -> Vector {
        rotated(&self.matrix, v)
    }

    /// A world direction in body coordinates.
    pub(crate) fn direction_to_body(self, v: Vector) -> Vector {
        rotated_back(&self.matrix, v)
    }

    /// Height of the body's origin above the world's z = 0.
    pub(crate) fn lift(self) -> f64 {
        self.offset[2]
    }
}
