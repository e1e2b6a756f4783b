//! Unknown noise: sds of heights and of slopes (or normals), declared, estimated with the fit, or told by the residuals.
//!
//! ```text
//! sds.rs          noise sds and where they come from            components.rs    both estimated with the fit
//! record.rs       told by the residuals of weighted rows        traces.rs        degrees of freedom of either kind of rows
//! declared.rs     declared sds checked against the residuals    levels.rs        what few contacts leave open about them
//! ratios.rs       the same of the ratio of both                 row_sums.rs      what that needs of the rows
//! fingers.rs      errors that touches of a finger share
//! ```

pub(super) mod components;
pub(super) mod declared;
pub(super) mod fingers;
pub(super) mod hutchinson;
mod ratios;
pub(super) mod record;
mod row_sums;
pub(super) mod sds;
pub(super) mod traces;
pub(super) mod variance_ratio_posterior;
