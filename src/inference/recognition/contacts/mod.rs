//! What was given: contacts in order, a frame of their own, normals on one side, and their averages.
//!
//! ```text
//! c = mean P      e3 = mean unit normal, or the direction of least spread      1 unit = sqrt(w1 + w2), variances along the patch
//! cell = mean of the contacts in one voxel, at most 200 of them
//! ```
//!
//! In the order of the work: `input.rs` checks and sorts, and `frame.rs` finds the frame; places without normals that lie on one conic
//! tell no bend (`conic.rs`), unless they stand over each other (`upright.rs`). About a first surface, `derived_normals_test.rs` tells
//! whether the normals are measurements, and `cells.rs` averages; `scatter_within.rs` keeps what means lose. `excluded.rs` counts what was left out. `rounding.rs` says by how
//! much they err at least.

mod cells;
mod conic;
mod derived_normals_test;
mod excluded;
mod frame;
mod height_polynomial;
mod input;
mod rounding;
mod scatter_within;
mod upright;

pub(crate) use cells::{CellNormals, Cells, cells, is_known};
pub(crate) use conic::{distance_from_conic, on_conic};
pub(crate) use derived_normals_test::derived_from_positions;
pub(crate) use excluded::Dropped;
pub use excluded::NormalsUse;
pub(crate) use frame::{patch_frame, spread_beside_a_line};
pub(crate) use input::{Observations, check_options};
pub(crate) use rounding::Floors;
pub(crate) use scatter_within::ScatterWithin;
pub(crate) use upright::stand_upright;
