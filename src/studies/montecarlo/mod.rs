//! Repeated fits with simulated noise: intervals of S and R over replicates of a scene.
//!
//! ```text
//! scene -> Engine (fixed sites | refit | whole fits) -> values of every replicate -> Tally -> Summary
//! ```

mod attribution;
mod control;
mod coverage;
mod engine;
mod error;
mod evaluator;
mod exact_sum;
mod fixed_sites;
mod full_refit;
mod histogram;
mod linear_law;
mod linear_rows;
mod noise_free_draws;
mod options;
mod order_statistics;
mod problem;
mod quantity;
mod refit;
mod state;
mod stopping;
mod strategy;
mod study;
mod summary;
mod tally;

#[doc(hidden)]
pub use attribution::attribute;
pub use attribution::{Attribution, EffectShare, Share};
#[doc(hidden)]
pub use control::ControlTally;
#[doc(hidden)]
pub use coverage::{CoverageTally, Coverages, Held, coverage};
#[doc(hidden)]
pub use engine::{Engine, Values};
pub use error::StudyError;
#[doc(hidden)]
pub use exact_sum::ExactSum;
pub use fixed_sites::FixedSites;
#[doc(hidden)]
pub use fixed_sites::ROW_NOISE;
#[doc(hidden)]
pub use histogram::{Bins, Histogram};
pub use linear_law::LinearLaw;
#[doc(hidden)]
pub use linear_law::linear_law;
pub use options::{StudyOptions, Tolerance};
pub use order_statistics::Coverage;
#[doc(hidden)]
pub use order_statistics::{Counted, Ranked, Sorted};
pub use quantity::Quantity;
pub use state::StudyState;
#[doc(hidden)]
pub use stopping::{BatchEstimate, batch_estimate, batch_size, batches_wanted, numerical_tolerance};
pub use strategy::Path;
pub use study::{Progress, Stopped, Study, StudyResult};
pub use summary::Summary;
#[doc(hidden)]
pub use summary::{class_shares, summarise};
#[doc(hidden)]
pub use tally::{OtherBins, Store, Tally};
