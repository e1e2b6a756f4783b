//! Why a hierarchy, its equations or a fit cannot be had. Every variant says what would be right.

use palpate_geometry::contact::ContactError;
use palpate_numeric::bspline::SplineError;

/// A hierarchy or a fit that cannot be had from this input with these options.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HierarchyError {
    /// The data themselves are faulty.
    #[error(transparent)]
    Contacts(#[from] ContactError),
    /// Degree, segments or knots are out of range.
    #[error("{axis}: {source}")]
    Knots {
        /// `x` or `y`.
        axis: &'static str,
        /// What is wrong.
        source: SplineError,
    },
    /// The degrees of a hierarchy are those that have second derivatives and whose equations are summed exactly.
    #[error("degree {degree} along {axis} is out of range: {least} to {most}")]
    Degree {
        /// `x` or `y`.
        axis: &'static str,
        /// The degree asked for.
        degree: usize,
        /// The smallest taken.
        least: usize,
        /// The largest taken.
        most: usize,
    },
    /// A hierarchy is open in both directions.
    #[error("the knots along {axis} close on themselves: a hierarchy is open in both directions")]
    Closed {
        /// `x` or `y`.
        axis: &'static str,
    },
    /// A cell was halved as often as its number can say.
    #[error("a cell of level {level} would be split: the deepest level is {most}")]
    Depth {
        /// Level of the cell.
        level: usize,
        /// The deepest level.
        most: usize,
    },
    /// A cell that lies in no cell of the base grid.
    #[error("cell {place:?} of level {level} lies in no cell of the base grid")]
    Place {
        /// Level of the cell.
        level: usize,
        /// Its place in the grid of its level.
        place: [u32; 2],
    },
    /// Coefficients that do not fit the space.
    #[error("{found} coefficients for {expected} functions")]
    Coefficients {
        /// Numbers given.
        found: usize,
        /// Functions of the space.
        expected: usize,
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient {index} is not finite")]
    NotFinite {
        /// Number of its function.
        index: usize,
    },
    /// An option is out of range.
    #[error("{option} is {value}: {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What was given.
        value: String,
        /// What would be right.
        expected: &'static str,
    },
    /// The contacts span no rectangle.
    #[error("the contacts span no rectangle: x from {x0} to {x1}, y from {y0} to {y1}")]
    Flat {
        /// Least x.
        x0: f64,
        /// Largest x.
        x1: f64,
        /// Least y.
        y0: f64,
        /// Largest y.
        y1: f64,
    },
    /// A contact lies outside the knots.
    #[error("contact {index} at ({x}, {y}) lies outside the domain")]
    Outside {
        /// Its number.
        index: usize,
        /// Its place.
        x: f64,
        /// Its place.
        y: f64,
    },
    /// The equations do not determine a function.
    #[error("function {unknown} of {unknowns} is determined neither by contacts nor by roughness")]
    NotPositiveDefinite {
        /// Number of the function.
        unknown: usize,
        /// Functions of the space.
        unknowns: usize,
    },
    /// A number of the equations is not finite.
    #[error("the equations overflow at function {unknown}")]
    Overflow {
        /// Number of the function.
        unknown: usize,
    },
    /// The factor does not fit into memory.
    #[error("no memory for the factor of {unknowns} unknowns")]
    Memory {
        /// Functions of the space.
        unknowns: usize,
    },
    /// A part of the contacts cannot be read, written or put together with the others.
    #[error("contacts in parts: {what}")]
    Parts {
        /// What is wrong.
        what: String,
    },
}
