//! The answer: hypotheses weighed, surfaces drawn, S and R with their intervals, in the input's units.
//!
//! ```text
//! mean S = sum w_node (mean of S over supported points)        interval = quantiles over drawn surfaces under the weights v
//! ```
//!
//! `weights.rs` comes first: those of the estimate and those of the interval. `field.rs` is what one surface shows, `drawn.rs` what
//! many show together, and `posterior.rs` draws them. `misfit.rs` looks for a pattern in the residuals, and `report.rs` puts all
//! into the result.

mod drawn;
mod field;
mod misfit;
mod posterior;
mod report;
mod weights;

pub(in crate::recognition) use report::Findings;
pub(in crate::recognition) use weights::weigh;
