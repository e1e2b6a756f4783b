//! The answer: hypotheses weighed, surfaces drawn, S and R with their intervals, in the input's units.
//!
//! ```text
//! mean S = sum w_node (mean of S over supported points)        interval = quantiles over drawn surfaces under the weights v
//! ```
//!
//! `weights.rs` comes first: those of the estimate, and whether a displacement is shape. `doubt.rs` has those of the interval, and
//! `shares.rs` what both are made of. `field.rs` is what one surface shows, `drawn.rs` what
//! many show together, and `posterior.rs` draws them. `misfit.rs` looks for a pattern in the residuals. `findings.rs` holds
//! all of it, `compared.rs` lists the kinds that were compared, and `report.rs` puts all into the result.

mod compared;
mod doubt;
mod drawn;
mod field;
mod findings;
mod misfit;
mod posterior;
mod report;
mod shares;
mod weights;

pub(in crate::recognition) use findings::Findings;
pub(in crate::recognition) use weights::weigh;
