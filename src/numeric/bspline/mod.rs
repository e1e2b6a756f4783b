//! B-splines in one dimension: `S(x) = sum_i c_i N_i(x)`, n basis functions of degree p on a clamped knot vector.
//!
//! ```text
//! N_i,0 = 1 on [t_i, t_i+1)      N_i,p = (x - t_i)/(t_i+p - t_i) N_i,p-1 + (t_i+p+1 - x)/(t_i+p+1 - t_i+1) N_i+1,p-1
//! ```
//!
//! At a knot the values are the limits from the right, at the upper end of the domain those from the left. Outside the
//! domain the polynomial of the nearest end segment continues.
//! Paper section 3.1 (its "order k" is degree + 1); L. Piegl and W. Tiller, *The NURBS Book*, A2.1 to A2.3.

mod basis;
mod gram;
mod knots;

pub use basis::BasisRow;
pub use gram::{gauss_legendre, gram};
pub use knots::MAX_DEGREE;
pub use knots::{Knots, linspace};

/// What is wrong with a degree, a knot vector, or the coefficients of a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// Degrees run from 1 to 9.
    #[error("degree {degree} is out of range: 1 to {MAX_DEGREE}")]
    Degree {
        /// The degree asked for.
        degree: usize,
    },
    /// At least one segment, and not more than memory allows.
    #[error("{segments} segments are out of range: 1 to {max}")]
    Segments {
        /// The number asked for.
        segments: usize,
        /// The largest number taken.
        max: usize,
    },
    /// The domain is empty, reversed or not finite.
    #[error("the domain [{lo}, {hi}] is empty, reversed or not finite")]
    Domain {
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// A closed direction needs more segments.
    #[error("{segments} segments are too few to close on themselves: at least {needed}")]
    ClosedSegments {
        /// Segments asked for.
        segments: usize,
        /// degree + 1.
        needed: usize,
    },
    /// A closed knot vector is uniform.
    #[error("knot {index} is {value}: the knots of a closed direction are equally spaced")]
    NotUniform {
        /// Position in the vector.
        index: usize,
        /// The offending knot.
        value: f64,
    },
    /// Fewer than 2 (degree + 1) knots.
    #[error("{found} knots are too few for degree {degree}: at least {needed}")]
    TooFew {
        /// Knots given.
        found: usize,
        /// Knots needed.
        needed: usize,
        /// Degree.
        degree: usize,
    },
    /// A knot is smaller than the one before it, or not finite.
    #[error("knot {index} is {value}, which is not finite or below the knot before it")]
    Order {
        /// Position in the vector.
        index: usize,
        /// The offending knot.
        value: f64,
    },
    /// The first and last degree + 1 knots must be equal.
    #[error("the knot vector is not clamped: its first and last {needed} knots must be equal")]
    NotClamped {
        /// degree + 1.
        needed: usize,
    },
    /// An interior knot repeated more than degree times would tear the surface.
    #[error("interior knot {value} stands {found} times; at most {max} for a continuous surface")]
    Multiplicity {
        /// The knot.
        value: f64,
        /// Its multiplicity.
        found: usize,
        /// The degree.
        max: usize,
    },
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
}
