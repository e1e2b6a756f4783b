//! Why nothing can be planned, with what would help.

use palpate_geometry::contact::counted;
use palpate_world::scene::SceneError;

/// A fit, candidates or a world from which no next touch follows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExploreError {
    /// There is nothing to choose from.
    #[error("there is no candidate inside reach: {why}")]
    NoCandidate {
        /// What was looked at.
        why: String,
    },
    /// A candidate's coordinate is no number.
    #[error("candidate {index} is at ({x}, {y}); both must be finite numbers")]
    NotFinite {
        /// Which one, counted from 0.
        index: usize,
        /// Its x.
        x: f64,
        /// Its y.
        y: f64,
    },
    /// The fit's weights say nothing about noise, so nothing follows for a contact more.
    #[error(
        "the fit has preset weights, which are no noise: fit with normal rows, or with weights found with the fit (auto)"
    )]
    Weights,
    /// The contacts fit without a residual: no noise is known that another contact could lower.
    #[error("the contacts leave no residual, so their noise is unknown: declare the noise sds (sigma)")]
    NoNoise,
    /// Some coefficients have no data.
    #[error(
        "{coefficients} coefficients of the fit have no data, so their uncertainty has no bound: take fewer segments, or smooth"
    )]
    Unsupported {
        /// How many.
        coefficients: usize,
    },
    /// The patch has axes of its own, in which x and y of a candidate mean nothing.
    #[error(
        "the patch has axes of its own, and candidates are places over x and y: fit with the frame that keeps the axes"
    )]
    Turned,
    /// The first sweep is too small to span a patch.
    #[error(
        "the first sweep spans no patch ({}, {along} by {across}): give at least two fingers and two stations, or the reach",
        counted(*contacts, "contact")
    )]
    NoPatch {
        /// Its contacts.
        contacts: usize,
        /// Its extent along the stations, input units.
        along: f64,
        /// Its extent across the fingers, input units.
        across: f64,
    },
    /// The sweep's fingers go round the body.
    #[error(
        "the fingers of this scene go around the body, and next touches are planned from above: give the sweep path = \"down\""
    )]
    Around,
    /// The budget is spent by the first sweep.
    #[error(
        "the first sweep alone makes {}, and the budget is {budget}: allow more, or make a smaller first sweep",
        counted(*first, "contact")
    )]
    Budget {
        /// Contacts of the first sweep.
        first: usize,
        /// Contacts allowed.
        budget: usize,
    },
    /// A number is out of its range.
    #[error("{option} is {value}; {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is taken.
        expected: &'static str,
    },
    /// The world itself is faulty.
    #[error(transparent)]
    Scene(#[from] SceneError),
}
