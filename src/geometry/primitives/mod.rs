//! Surfaces that a few sizes say, each in its own axes: how far a place is from it, and how it bends.
//!
//! ```text
//! q = (q1, q2, q3), q3 along the axis      rho = hypot(q1, q2), h = q3
//! plane     d = h                          cylinder  d = rho - r
//! sphere    d = |q| - r                    cone      d = (rho - r) cos(alpha) - h sin(alpha)
//! torus     d = hypot(rho - R, h) - r      two curvatures: the same torus from its surface, plane, cylinder and sphere included
//! ```
//!
//! Each `d` is the distance itself, so |grad d| = 1 and the gradient is the normal.
//! G. Lukacs, R. Martin, D. Marshall, *Faithful least-squares fitting of spheres, cylinders, cones and tori*, ECCV 1998, 671.

mod cone;
mod cylinder;
mod ellipsoid;
mod plane;
mod sphere;
mod torus;
mod two_curvatures;

pub use cone::Cone;
pub use cylinder::Cylinder;
pub use ellipsoid::TriaxialEllipsoid;
pub use plane::Plane;
pub use sphere::Sphere;
pub use torus::Torus;
pub use two_curvatures::{NormalJet, TwoCurvatures, over_circle};

use palpate_numeric::vector::Vector;

/// The signed distance at one point, with all its derivatives that rows of positions and normals need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceJet {
    /// The distance, positive outwards.
    pub distance: f64,
    /// Its gradient, the unit normal.
    pub gradient: Vector,
    /// Its Hessian.
    pub hessian: [Vector; 3],
    /// Derivatives of the distance by the sizes; 0 for a size that the primitive does not have.
    pub by_size: [f64; 3],
    /// Derivatives of the gradient by the sizes.
    pub gradient_by_size: [Vector; 3],
}

impl DistanceJet {
    /// Of a distance whose other derivatives vanish.
    #[inline]
    fn flat((distance, gradient): (f64, Vector)) -> DistanceJet {
        let (hessian, gradient_by_size) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        DistanceJet { distance, gradient, hessian, by_size: [0.0; 3], gradient_by_size }
    }
}

/// What a primitive answers about a place of its own axes.
pub trait Primitive {
    /// Signed distance, positive outwards, and its gradient.
    fn distance(&self, q: Vector) -> (f64, Vector);

    /// The same with the further derivatives.
    fn jet(&self, q: Vector) -> DistanceJet;

    /// Normal curvatures of the surface itself at the foot of a place, towards the outward normal, in no order.
    fn curvatures(&self, q: Vector) -> [f64; 2];
}

/// Length by two legs. The plain formula: sizes are those of things, whose squares neither overflow nor vanish, and it is a fourth of the time.
#[inline]
fn length(across: f64, up: f64) -> f64 {
    (across * across + up * up).sqrt()
}

/// Distance from the axis, which is never 0.
#[inline]
fn from_axis(q: Vector) -> f64 {
    length(q[0], q[1]).max(f64::MIN_POSITIVE)
}

/// Unit vector away from the axis; along the first axis where there is none.
#[inline]
fn radial(q: Vector, rho: f64) -> Vector {
    if rho > 0.0 && (q[0] != 0.0 || q[1] != 0.0) { [q[0] / rho, q[1] / rho, 0.0] } else { [1.0, 0.0, 0.0] }
}

/// Entry of the projector on the direction round the axis.
#[inline]
fn around(radial: Vector, i: usize, j: usize) -> f64 {
    let tangent = [-radial[1], radial[0], 0.0];
    tangent[i] * tangent[j]
}

#[inline]
fn square(entry: impl Fn(usize, usize) -> f64) -> [Vector; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}
