//! From contacts to sparse normal equations, cell by cell, in memory that depends on the cells and not on the contacts.
//!
//! ```text
//! minimise over delta   sum_r wz^2 (r - delta(x_r, y_r))^2 + slope or normal rows + lambda roughness(S + delta)
//! (A + lambda P) delta = g - lambda P c          A = sum_Q E_Q' A_Q E_Q
//! ```
//!
//! Equations are those of a step from a surface S that is at hand, so that noise far smaller than the heights loses no digits.

mod column_kind;
mod local;
mod matrix;
mod polynomials;
mod random_loads;
mod residuals;
mod scrambled;
mod sorted_contacts;
mod sums;
mod surface_cells;
#[cfg(test)]
mod tests;

pub(crate) use column_kind::{ColumnKind, columns_of};
pub use local::BlockWeights;
pub use matrix::{LevelRoughness, MeetingPattern};
pub(crate) use random_loads::LoadLaw;
pub use residuals::ContactResiduals;
pub(crate) use scrambled::scrambled;
pub(crate) use sorted_contacts::codes_of_cell;
pub use sorted_contacts::{SortedContacts, patch_frame};
pub use sums::{CellSums, SumLayout};
pub use surface_cells::SurfaceCells;
