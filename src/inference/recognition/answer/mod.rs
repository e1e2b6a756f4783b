//! The answer: hypotheses weighed, surfaces drawn, S and R with their intervals, in the input's units.
//!
//! ```text
//! mean S = sum w_node (mean of S over supported points)        interval = quantiles over drawn surfaces under the weights v
//! ```
//!
//! `weights.rs` comes first: those of the estimate, and whether a displacement is shape. `interval_weights.rs` has those of the interval,
//! and `normalised_weights.rs` what both are made of. `shape_means.rs` is what one surface shows, `posterior_samples.rs` what many show
//! together, and `posterior.rs` draws them, `kept_draws.rs` keeps some of them; `misfit.rs` looks for a
//! pattern in the residuals. `inference.rs` holds all of it, `model_comparison.rs` lists the kinds that were compared, and `report.rs`
//! puts all into the result.

mod inference;
mod interval_weights;
mod kept_draws;
mod misfit;
mod model_comparison;
mod normalised_weights;
mod posterior;
mod posterior_samples;
mod report;
mod shape_means;
mod weights;

pub(crate) use inference::Findings;
pub(crate) use weights::weigh;
