//! What accuracy costs in time: which way of fitting a scene buys how much accuracy for how many microseconds on this machine.
//!
//! ```text
//! discretisation   degree x segments x stations x weights x surface      errors of S, R, k1, height, slope  against time
//! ```
//!
//! Every point is timed and judged on the same calls, on one thread. [`pick`] answers a [`Request`] for accuracy or for
//! time with the configuration that keeps it.

mod clock;
mod configuration;
mod discretisation;
mod error;
mod errors;
mod judge;
mod memory;
mod pareto;
mod pick;
mod point;
mod touches;

#[cfg(feature = "cli")]
pub(crate) use clock::{Clocked, counted_region};
#[cfg(feature = "cli")]
pub(crate) use discretisation::{Measured, Subject, mark};
pub use error::FrontierError;
#[cfg(feature = "cli")]
pub(crate) use errors::{Errors, QUANTITIES, Share};
pub use pick::{Choice, Request, pick};
#[cfg(feature = "cli")]
pub(crate) use pick::{check_truth, choose};
#[cfg(feature = "cli")]
pub(crate) use point::{Frontier, Point};
#[cfg(feature = "cli")]
pub(crate) use touches::REPLICATES;
