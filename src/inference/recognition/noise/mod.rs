//! How measurements err: independently, as their neighbours do, in their places, and by one factor.
//!
//! ```text
//! cov e = s^2 (D + rho exp(-r/l))        var d = s_z^2 n_z^2 + s_xy^2 (1 - n_z^2)        slopes measured = (1 + g) slopes true
//! ```
//!
//! Errors of places come first: `position_covariance.rs` asks how large they are, `slope_dependent_variance.rs` weighs contacts on slopes
//! by them, and `regression_calibration.rs` sets back those that crossed the edges. Then come the covariances, `covariance.rs` of distances and `normals.rs` of normals,
//! `gain.rs` for a sensor whose slopes are all too steep, and `tilt.rs` for one whose normals are all turned.

mod covariance;
mod gain;
mod normals;
mod position_covariance;
mod regression_calibration;
mod shared_error;
mod slope_dependent_variance;
mod tilt;

pub(crate) use covariance::{Factors, Kernel, Limit, distances_between};
pub(crate) use gain::Gain;
pub(crate) use normals::NormalNoise;
pub(crate) use position_covariance::PlaceErrors;
pub(crate) use regression_calibration::set_back;
pub(crate) use slope_dependent_variance::weighed;
pub(crate) use tilt::Tilt;
