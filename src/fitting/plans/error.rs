//! Why a plan cannot be made, or cannot take what it was given.

use palpate_numeric::solve::SolveError;

/// A plan or a stream that cannot be made, or data that it refuses. Every variant names the fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The plan is not made for this degree.
    #[error("degrees {} x {} are not possible here: {allowed}", degree[0], degree[1])]
    Degree {
        /// Degrees in x and y.
        degree: [usize; 2],
        /// Degrees that are possible.
        allowed: &'static str,
    },
    /// A block weight is negative or not finite.
    #[error("the weight of the {block} is {value}; weights are finite and not negative")]
    Weight {
        /// Heights, x slopes or y slopes.
        block: &'static str,
        /// The offending value.
        value: f64,
    },
    /// A noise sd is out of range.
    #[error("the sd of the {block} is {value}: {expected}")]
    NoiseSd {
        /// Heights, x slopes or y slopes.
        block: &'static str,
        /// The offending value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// The shape grid has no point along an axis.
    #[error("the shape grid has no point along {axis}")]
    EmptyGrid {
        /// `x` or `y`.
        axis: &'static str,
    },
    /// An axis or a grid point is NaN or infinite, or a pixel axis does not increase.
    #[error("entry {index} of axis {axis} is {value}: {expected}")]
    Axis {
        /// `x` or `y`.
        axis: &'static str,
        /// Entry, counted from 0.
        index: usize,
        /// The offending value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A column or an image has too few or too many entries.
    #[error("{column} has {found} entries, but {expected} are called for")]
    Length {
        /// Name of the column or image.
        column: &'static str,
        /// Entries found.
        found: usize,
        /// Entries called for.
        expected: usize,
    },
    /// An image's shape is not (x pixels, y pixels).
    #[error("image {image} is {found:?}, but the axes x and y make {expected:?}; images are indexed [x, y]")]
    Shape {
        /// Name of the image.
        image: &'static str,
        /// Its shape.
        found: [usize; 2],
        /// Shape that the axes call for.
        expected: [usize; 2],
    },
    /// A number of a contact is NaN or infinite.
    #[error("{column} of contact {index} is {value}, not a finite number")]
    NotFinite {
        /// Name of the column.
        column: &'static str,
        /// Contact, counted from 0.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// A pixel is NaN or infinite; plans take finite pixels alone, where they have a weight.
    #[error("pixel ({}, {}) of {image} is {value}, not a finite number; images with missing pixels go to ImagePlan::masked or to fit_grid", index[0], index[1])]
    Pixel {
        /// Name of the image.
        image: &'static str,
        /// Pixel in x and in y, counted from 0.
        index: [usize; 2],
        /// The offending value.
        value: f64,
    },
    /// A touch lies outside the knots' domain.
    #[error("{axis} of touch {index} is {value}, outside the domain [{}, {}]", domain[0], domain[1])]
    Outside {
        /// `x` or `y`.
        axis: &'static str,
        /// Touch, counted from 0.
        index: usize,
        /// The offending value.
        value: f64,
        /// Ends of the domain.
        domain: [f64; 2],
    },
    /// A stream cannot forget in this way.
    #[error("{what} of {value} is not possible: {expected}")]
    Memory {
        /// `a window` or `a decay`.
        what: &'static str,
        /// The offending value.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// Every number is finite, but their sums are not.
    #[error("the sums over the data exceed the largest number; give the data in another unit")]
    Overflow,
    /// The normal equations have no solution.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The three blocks of rows, in the order of every `[f64; 3]` of weights and sds.
const BLOCKS: [&str; 3] = ["heights", "x slopes", "y slopes"];

/// Checks block weights.
///
/// # Errors
/// [`PlanError::Weight`] for a weight that is negative, NaN or infinite.
pub(super) fn check_weights(weights: [f64; 3]) -> Result<(), PlanError> {
    match (0..3).find(|&k| !(weights[k].is_finite() && weights[k] >= 0.0)) {
        Some(k) => Err(PlanError::Weight { block: BLOCKS[k], value: weights[k] }),
        None => Ok(()),
    }
}

/// Checks noise sds, which may be zero where `zero_allowed`.
///
/// # Errors
/// [`PlanError::NoiseSd`] for an sd that is negative, NaN or infinite, or zero where that is not allowed.
pub fn check_noise_sds(sds: [f64; 3], zero_allowed: bool) -> Result<(), PlanError> {
    let fits = |sd: f64| sd.is_finite() && (sd > 0.0 || zero_allowed && sd == 0.0);
    match (0..3).find(|&k| !fits(sds[k])) {
        Some(k) => Err(PlanError::NoiseSd {
            block: BLOCKS[k],
            value: sds[k],
            expected: if zero_allowed { "a finite number, not negative" } else { "a positive number" },
        }),
        None => Ok(()),
    }
}

/// Checks the axes of a shape grid.
///
/// # Errors
/// [`PlanError::EmptyGrid`]; [`PlanError::Axis`] for a point that is NaN or infinite.
pub fn check_shape_grid(grid: [&[f64]; 2]) -> Result<(), PlanError> {
    for (axis, points) in ["x", "y"].into_iter().zip(grid) {
        if points.is_empty() {
            return Err(PlanError::EmptyGrid { axis });
        }
        if let Some(index) = points.iter().position(|v| !v.is_finite()) {
            return Err(PlanError::Axis { axis, index, value: points[index], expected: "a finite number" });
        }
    }
    Ok(())
}

/// Whether every number is finite. No early exit, so that it runs at the speed of a sum.
pub(super) fn all_finite(values: &[f64]) -> bool {
    values.iter().fold(true, |finite, v| finite & v.is_finite())
}
