//! Contacts: `P_r = (x_r, y_r, z_r)` with a normal `n_r` or slopes `(zx, zy) = (-nx/nz, -ny/nz)`.
//!
//! Two kinds of data stay different types all the way to the solver: [`Contacts`] at any places, and [`Grid`], heights on
//! the product of two axes. Lengths are in the unit of the input, slopes have none. [`Frame`] is the patch frame that a
//! fit works in: one origin, three axes and a single length.

mod counted;
mod frame;
mod grid;
mod scattered;
mod written_step;

pub use counted::counted;
pub use frame::Frame;
pub use grid::Grid;
pub use scattered::{ContactWeights, Contacts, Orientation};
pub use written_step::Rounding;

/// What is wrong with data before any equation is formed from it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// There is nothing to fit.
    #[error("there are no contacts")]
    Empty,
    /// A column's length differs from that of `x`.
    #[error("column {column} has {found} entries where x has {expected}")]
    Length {
        /// Name of the column.
        column: &'static str,
        /// Entries found.
        found: usize,
        /// Entries in `x`.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("{column} of contact {index} is {value}, not a finite number")]
    NotFinite {
        /// Name of the column.
        column: &'static str,
        /// Contact, counted from 0.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// A normal has length zero.
    #[error("the normal of contact {index} has length zero; give any other length, it is normalised here")]
    ZeroNormal {
        /// Contact, counted from 0.
        index: usize,
    },
    /// A weight is negative or not finite.
    #[error("weight {column} of contact {index} is {value}; weights are finite and not negative")]
    Weight {
        /// Name of the column.
        column: &'static str,
        /// Contact, counted from 0.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// A grid axis does not increase.
    #[error("grid axis {axis} does not increase at entry {index}: {before} then {after}")]
    AxisOrder {
        /// `x` or `y`.
        axis: &'static str,
        /// Entry, counted from 0.
        index: usize,
        /// Entry before it.
        before: f64,
        /// The offending entry.
        after: f64,
    },
    /// A grid array's shape is not (x entries, y entries).
    #[error("{array} is {found:?}, but the axes x and y make {expected:?}; arrays are indexed [x, y]")]
    Shape {
        /// Name of the array.
        array: &'static str,
        /// Its shape.
        found: [usize; 2],
        /// Shape the axes call for.
        expected: [usize; 2],
    },
    /// A grid has one slope array without the other.
    #[error("the grid has {present} but not {missing}; give both or neither")]
    HalfSlopes {
        /// The array that is there.
        present: &'static str,
        /// The array that is not.
        missing: &'static str,
    },
}
