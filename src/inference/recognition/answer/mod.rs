//! The answer: hypotheses weighed, surfaces drawn, S and R with their intervals, in the input's units.
//!
//! ```text
//! mean S = sum w_node (mean of S over supported points)        interval = quantiles over drawn surfaces under the weights v
//! ```
//!
//! `weights.rs` comes first: those of the estimate, and whether a displacement is shape. `doubt.rs` has those of the interval, and
//! `shares.rs` what both are made of. `field.rs` is what one surface shows, `drawn.rs` what
//! many show together, and `posterior.rs` draws them. `misfit.rs` looks for a pattern in the residuals. `findings.rs` holds
//! all of it, `coarse_grid.rs` what lies between the drawn points of a fine map, `compared.rs` lists the kinds that were compared, and `report.rs` puts all into the result.

mod coarse_grid;
mod inference;
mod interval_weights;
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
