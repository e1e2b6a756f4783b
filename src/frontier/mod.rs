//! What accuracy costs in time: which way of fitting a scene buys how much accuracy for how many microseconds on this machine.
//!
//! ```text
//! discretisation   degree x segments x stations x weights x surface      errors of S, R, k1, height, slope  against time
//! solver           Cholesky, refined, QR, Kronecker, gradients, f32      digits of the coefficients          against time
//! interval         linear, recognised, Monte Carlo                       error of the ends, coverage         against time
//! ```
//!
//! Every point is timed and judged on the same calls, on one thread. [`Request::pick`] answers a request for accuracy or for
//! time with the configuration that keeps it.

mod clock;
mod configuration;
mod discretisation;
mod error;
mod errors;
#[cfg(feature = "cli")]
mod hard;
#[cfg(feature = "cli")]
mod held_out;
#[cfg(feature = "cli")]
mod interval;
mod judge;
mod memory;
#[cfg(feature = "cli")]
mod orders;
mod pareto;
mod pick;
mod point;
#[cfg(feature = "cli")]
mod reference;
#[cfg(feature = "cli")]
mod single;
#[cfg(feature = "cli")]
mod solver;
#[cfg(feature = "cli")]
mod stages;
mod touches;

#[cfg(feature = "cli")]
pub(crate) use clock::{Clocked, Watch, counted_region};
#[cfg(feature = "cli")]
pub(crate) use discretisation::{Measured, Subject, mark};
pub use error::FrontierError;
#[cfg(feature = "cli")]
pub(crate) use errors::{Errors, QUANTITIES, Share};
#[cfg(feature = "cli")]
pub(crate) use hard::{SolverSubject, cholesky_ends, mark_solvers};
#[cfg(feature = "cli")]
pub(crate) use held_out::held_out;
#[cfg(feature = "cli")]
pub(crate) use interval::IntervalSubject;
#[cfg(feature = "cli")]
pub(crate) use orders::{Order, orders};
pub use pick::{Choice, Request};
#[cfg(feature = "cli")]
pub(crate) use pick::{check_truth, choose};
#[cfg(feature = "cli")]
pub(crate) use point::{Frontier, Point};
#[cfg(feature = "cli")]
pub(crate) use stages::{Stage, of_fit, of_replicate};
#[cfg(feature = "cli")]
pub(crate) use touches::REPLICATES;
