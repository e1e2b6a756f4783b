//! Where a body stands: `P = offset + Rz(rz) Ry(ry) Rx(rx) Rz(axis) p`, angles in degrees.
//!
//! `axis_deg` rotates the body about its own z axis before anything else (a cylinder's generators from +x towards +y).
//! When rx = ry = 0 the body stands upright: its closed-form height is used with an exact plane rotation.

use crate::scene::rotation::{Matrix, product, rotated, rotated_back, rotation};
use crate::vector::Vector;

/// Rotation and offset of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    matrix: Matrix,
    offset: Vector,
    upright: bool,
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
    pub fn upright(&self) -> bool {
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
