//! Why coefficients and knots do not make a surface.

use crate::bspline::KnotError;

/// Why coefficients and knots do not make a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The coefficient array does not fit the knots.
    #[error("coefficients are {found:?}, but the knots call for {expected:?}")]
    Shape {
        /// Shape of the array.
        found: [usize; 2],
        /// Basis functions in x and y.
        expected: [usize; 2],
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient ({i}, {j}) is not finite")]
    NotFinite {
        /// Index in x.
        i: usize,
        /// Index in y.
        j: usize,
    },
    /// In a closed direction the last coefficients must repeat the first.
    #[error("coefficient ({i}, {j}) does not repeat the one it closes on")]
    Seam {
        /// Index in u.
        i: usize,
        /// Index in v.
        j: usize,
    },
    /// The knots are not usable.
    #[error(transparent)]
    Knots(#[from] KnotError),
}
