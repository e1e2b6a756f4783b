//! What is touched, when nobody names a model: the kind of surface of a patch, and the parts of a scan.
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

mod bodies;
mod dense;
pub mod parts;
mod primitives;
pub mod recognition;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub use palpate_fitting::fit::{FitOptions, fit_contacts};
    pub use palpate_geometry::contact::Contacts;
    pub mod fit {
        pub use palpate_fitting::fit::FitError;
    }
    pub mod parts {
        pub use crate::parts::{PartKind, Parts, PartsError, PartsOptions, PartsTuning, PointShapes};
    }
    pub mod recognition {
        pub use crate::bodies::Tuning;
        pub use crate::recognition::{Hypothesis, Recognition, RecognitionError, RecognitionOptions};
    }
}
