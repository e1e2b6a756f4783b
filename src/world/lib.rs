//! The simulated world: bodies, fingers that sweep over them, the ways in which measuring goes wrong, and the truth.
//!
//! It never sees a spline. It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod scene;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub mod scene {
        pub use crate::scene::{
            ContactBatch, Effect, EffectDraws, ImportedSurface, SceneError, Solid, Stage, Surface, Sweep, World,
        };
    }
    pub mod spline {
        pub use palpate_numeric::bspline::linspace;
    }
}
