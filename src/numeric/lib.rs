//! The ground floor of `palpate`: numbers without contacts.
//!
//! ```text
//! simd       kernels with their safe twins         draws     random streams addressed by (seed, replicate, effect, contact)
//! threads    work in pieces, the same bits         bspline   N_i(x), its derivatives and their Gram matrices
//! linalg     E'WE in its structures                solve     Cholesky, QR, fast diagonalisation of those structures
//! levenberg_marquardt  damped steps over any residual model          brent     the peak of a function of one number
//! work       a counter of multiply-adds
//! statistics medians, quantiles, robust scales and losses
//! ```
//!
//! It is a part of `palpate`, which people add and install; its names may change with every release.

pub mod brent;
pub mod bspline;
pub mod draws;
pub mod levenberg_marquardt;
pub mod linalg;
pub mod simd;
pub mod solve;
pub mod statistics;
pub mod threads;
pub mod vector;
pub mod work;

/// This floor by the names that users of `palpate` know, for the examples in its documentation.
#[doc(hidden)]
pub mod facade {
    pub mod spline {
        pub use crate::bspline::{Knots, SplineError};
    }
}
