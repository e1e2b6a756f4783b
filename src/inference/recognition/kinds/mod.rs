//! The kinds of surface that are compared: where each lies, and how far a place is from it.
//!
//! ```text
//! theta = (h, a, b, k1, k2, phi)      d(theta; P)        signed distance of a place P from the surface, positive on the free side
//! plane k1 = k2 = 0      sphere k1 = k2      cylinder k2 = 0      general: a patch of a torus      paraboloid: q(x, y)
//! ```
//!
//! Nothing here knows contacts. `model.rs` comes first: which parameters of a kind are free. `constant_curvature.rs` places
//! all kinds but the paraboloid, and `paraboloid.rs` has that one.

mod constant_curvature;
mod model;
mod paraboloid;

pub(crate) use constant_curvature::ConstantCurvature;
pub(crate) use model::{Kind, Model};
