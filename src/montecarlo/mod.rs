//! Repeats a fit for noise: intervals of S and R over replicates of a scene.
//!
//! ```text
//! scene -> Engine (fixed sites | refit | whole fits) -> values of every replicate -> Tally -> Summary
//! ```

mod attribution;
mod coverage;
mod engine;
mod error;
mod evaluator;
mod exact_sum;
mod fixed_sites;
mod histogram;
mod linear_law;
mod linear_rows;
mod options;
mod order;
mod problem;
mod quantity;
mod refit;
mod rest;
mod state;
mod stopping;
mod study;
mod summary;
mod tally;
mod whole;

pub use attribution::{Attribution, EffectShare, Share, attribute};
pub use coverage::{Coverages, Held, coverage};
pub use engine::{Engine, Path, Values};
pub use error::StudyError;
pub use exact_sum::ExactSum;
pub use fixed_sites::{FixedSites, ROW_NOISE};
pub use histogram::{Bins, Histogram};
pub use linear_law::{LinearLaw, LinearPart, linear_law};
pub use options::{StoppingRule, StudyOptions, Tolerance};
pub use order::{Counted, Coverage, Ranked, Sorted};
pub use quantity::{PointQuantity, Quantity};
pub use state::{BatchEstimate, StudyState};
pub use stopping::{batch_estimate, batch_size, batches_wanted, numerical_tolerance};
pub use study::{Progress, Stopped, Study, StudyResult};
pub use summary::{ClassShares, Summary, class_shares, summarise};
pub use tally::{OtherBins, Store, Tally};
