//! Fits that are planned once and then repeated: scattered contacts, images, and touches one by one.
//!
//! ```text
//! plan (knots, weights)  ->  factor  ->  solve, again and again      A c = E'W^2 b,  A = E'W^2 E
//! ```
//!
//! Nothing is allocated after the plan is made, and data are checked by way of the sums that are formed anyway.

mod complete_plan;
mod contraction;
mod error;
mod image_plan;
mod masked_plan;
mod pixel;
mod slope_plan;
mod stream;
mod touch_memory;

pub use error::PlanError;
pub use error::{check_noise_sds, check_shape_grid};
pub use image_plan::ImagePlan;
#[doc(hidden)]
pub use pixel::Pixel;
pub use slope_plan::{SlopeColumns, SlopePlan};
pub use stream::TouchStream;
