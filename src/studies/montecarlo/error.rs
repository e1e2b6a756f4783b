//! Why a study cannot be had, or parts of one cannot be joined.

use palpate_world::scene::SceneError;

/// A study that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The scene itself is faulty.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The contacts without noise give no fit.
    #[error("the contacts without noise cannot be fitted: {reason}")]
    Nominal {
        /// What the fit said.
        reason: String,
    },
    /// An option is out of range.
    #[error("{option} is {value}: {expected}")]
    Option {
        /// Its name on the command line, without dashes.
        option: &'static str,
        /// What was given.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// The path asked for cannot be had.
    #[error("--path {asked} cannot be had for this scene: {why}")]
    Path {
        /// The path asked for.
        asked: &'static str,
        /// Why the scene calls for another.
        why: String,
    },
    /// The tolerance needs more replicates than are allowed.
    #[error(
        "--tolerance {digits} needs about {needed} replicates of this scene, and {allowed} are allowed: raise {raise}, or ask for fewer digits"
    )]
    Tolerance {
        /// Significant digits asked for.
        digits: u32,
        /// Replicates needed.
        needed: u64,
        /// Replicates allowed.
        allowed: u64,
        /// Which option to raise.
        raise: &'static str,
    },
    /// A part or checkpoint is of another study.
    #[error("{what} differs: {own} here, {other} there")]
    Stranger {
        /// What differs.
        what: &'static str,
        /// Ours.
        own: String,
        /// Theirs.
        other: String,
    },
    /// Two parts hold the same replicates.
    #[error("replicates {from} to {to} stand in two parts")]
    Overlap {
        /// First of them.
        from: u64,
        /// One past the last of them.
        to: u64,
    },
    /// Replicates are missing.
    #[error("replicates {from} to {to} of {total} stand in no part")]
    Gap {
        /// First of them.
        from: u64,
        /// One past the last of them.
        to: u64,
        /// Replicates of the whole run.
        total: u64,
    },
}
