//! Principal curvatures, shape index, curvedness and class at one point of a surface `Q(u, v)`.
//!
//! ```text
//! shape operator in an orthonormal tangent frame:  [a b; b c]        (symmetric)
//! k1, k2 = (a + c)/2 +- hypot((a - c)/2, b),  k1 >= k2               (never sqrt(H^2 - K))
//! S = -(2/pi) atan2(k1 + k2, k1 - k2)      R = sqrt((k1^2 + k2^2)/2)
//! ```
//!
//! The normal points to the free side: convex bodies have negative curvatures, cap +1, ridge +1/2, saddle 0, rut -1/2,
//! cup -1. These are Eq. 9 to 12 of the paper, but without its root, which cancels at every umbilic; J. J. Koenderink, *Solid Shape*, MIT Press 1990.

mod class;
#[cfg(test)]
mod map_kernel;
mod principal;

pub use class::ShapeClass;
pub use principal::{Derivatives, Principal};
pub use principal::{curvatures, curvedness, principal_curvatures, shape_index};
