//! Contacts, and the differential geometry of the surfaces through them.
//!
//! ```text
//! contact    places and normals, scattered or on a grid          surface   z = S(x, y) and Q(u, v) with their derivatives
//! neighbours which contacts lie near each other, and their normals
//! convex_hull of points in the plane
//! curvature  k1 >= k2, S = -(2/pi) atan2(k1 + k2, k1 - k2), R    shape     S and R over a grid, their means and uncertainty
//! primitives plane, sphere, cylinder, cone and torus by their sizes
//! ```
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod contact;
pub mod convex_hull;
pub mod curvature;
pub mod neighbours;
pub mod primitives;
pub mod shape;
pub mod surface;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub use crate::contact::{ContactError, Contacts, Grid, Orientation};
    pub mod geometry {
        pub use crate::curvature::Derivatives;
        pub use crate::shape::ShapeGrid;
    }
    pub mod spline {
        pub use crate::surface::{CurvatureGrid, HeightField, Parametric};
        pub use palpate_numeric::bspline::{Knots, linspace};
    }
}
