//! From data to a fitted surface: `[N o M; N' o M; N o M'] c = b` and its certificate.
//!
//! ```text
//! observation   the stacked matrix, scattered or gridded        parametric   surfaces Q(u, v) that no height field holds
//! fit           the paper's five steps                          plans        fits that are repeated without allocation
//! ```
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod fit;
pub mod observation;
pub mod parametric;
pub mod plans;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub use crate::fit;
    pub use crate::observation::stacked_csr;
    pub use palpate_geometry::contact::Contacts;
    pub mod parametric {
        pub use crate::parametric::{FittedSurface, ParametricFit};
    }
    pub mod plans {
        pub use crate::plans::{ImagePlan, SlopeColumns, SlopePlan, TouchStream};
    }
    pub mod spline {
        pub use palpate_geometry::surface::{CurvatureGrid, HeightField};
        pub use palpate_numeric::bspline::{Knots, SplineError, linspace};
    }
}
