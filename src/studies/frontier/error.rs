//! Why there is no frontier, or no choice from one.

use palpate_geometry::contact::counted;
use palpate_world::scene::SceneError;

/// A frontier that cannot be had, or a request that cannot be understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrontierError {
    /// The scene cannot be simulated.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A number of the request is out of its range.
    #[error("{what} is {value}: {expected}")]
    Request {
        /// Which number.
        what: &'static str,
        /// What was given.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// Nothing is asked for.
    #[error("nothing is asked for: an error of S or of R, a budget of time, or several of these are needed")]
    Empty,
    /// The truth of the scene has no such quantity.
    #[error("the true {quantity} of this scene is undefined: {possible}")]
    Truth {
        /// `S` or `R`.
        quantity: &'static str,
        /// What can be asked instead.
        possible: &'static str,
    },
    /// Too few contacts to leave some out.
    #[error(
        "{} cannot judge a fit by contacts that were left out: {needed} are needed, or a scene, whose truth is known",
        counted(*contacts, "contact")
    )]
    TooFew {
        /// How many there are.
        contacts: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Every way of fitting failed.
    #[error("no way of fitting gave an answer; the first said: {why}")]
    Nothing {
        /// What the first one said.
        why: String,
    },
}
