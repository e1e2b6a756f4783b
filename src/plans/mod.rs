//! What is planned once and then repeated: fits of contacts, of images and of touches one by one, without allocation.
//!
//! ```text
//! plan (knots, weights)  ->  factor  ->  solve, again and again      A c = E'W^2 b,  A = E'W^2 E
//! ```

mod plan;
mod stream;

pub use plan::{ImagePlan, SlopeColumns, SlopePlan};
pub use stream::{StreamShape, Touch, TouchStream};
