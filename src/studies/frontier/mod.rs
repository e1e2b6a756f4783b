//! What accuracy costs in time: which way of fitting a scene buys how much accuracy for how many microseconds on this machine.
//!
//! ```text
//! discretisation   degree x segments x stations x weights x surface,     errors of S, R, k1, height, slope  against time
//!                  and what is recognised
//! solver           Cholesky, refined, QR, Kronecker, gradients, f32      digits of the coefficients          against time
//! interval         linear, recognised, Monte Carlo                       error of the ends, coverage         against time
//! ```
//!
//! Every point is timed and judged on the same calls, on one thread. [`Request::pick`] answers a request for accuracy or for
//! time with the configuration that keeps it.

mod clock;
mod configuration;
mod contenders;
mod digits;
mod discretisation;
mod error;
mod errors;
mod found_surface;
mod held_out;
mod interval;
mod kept;
mod ledger;
mod measured;
mod memory;
mod order_of_accuracy;
mod pareto;
mod pick;
mod point;
mod preference;
mod recognised;
mod reference;
mod replicates;
mod request;
mod scoring;
mod shortlist;
mod single_precision;
mod solver;
mod solver_ladder;
mod stages;

pub use clock::{Clocked, Watch, counted_region};
#[doc(hidden)]
pub use digits::{DIGITS_OF_A_DOUBLE, digits_absolute, digits_of};
pub use discretisation::{Subject, mark};
pub use error::FrontierError;
pub use errors::{Errors, QUANTITIES, Share};
pub use held_out::HeldOut;
pub use interval::IntervalSubject;
pub use ledger::Ledger;
pub use measured::Measured;
pub use order_of_accuracy::{Order, orders};
pub use pick::{Choice, check_truth, choose};
pub use point::{Frontier, Point};
pub use replicates::REPLICATES;
pub use request::Request;
pub use shortlist::{Shortlist, clock_spread, shortlist};
pub use solver_ladder::{SolverSubject, mark_solvers};
pub use stages::{Stage, of_fit, of_replicate};
