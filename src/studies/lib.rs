//! What stands on a fit: studies of noise, planned touches, and what accuracy costs in time.
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod explore;
pub mod frontier;
pub mod montecarlo;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub use palpate_fitting::fit::{FitOptions, fit_contacts};
    pub use palpate_geometry::contact::Contacts;
    pub mod explore {
        pub use crate::explore::TouchPlanner;
    }
    pub mod fit {
        pub use palpate_fitting::fit::{NormalSigma, Objective};
    }
    pub mod frontier {
        pub use crate::frontier::{FrontierError, Request};
    }
    pub mod montecarlo {
        pub use crate::montecarlo::FixedSites;
    }
    pub mod plans {
        pub use palpate_fitting::plans::SlopeColumns;
    }
    pub mod scene {
        pub use palpate_world::scene::{Surface, Sweep, World};
    }
    pub mod spline {
        pub use palpate_numeric::bspline::{Knots, linspace};
    }
}
