//! The start: a robust surface of two constant curvatures, and the contacts that belong to it.
//!
//! ```text
//! minimise sum_i w_i d(theta; P_i)^2        w_i = min(1, 1.345 s/|d_i|)        s = mad(d - median d)
//! ```
//!
//! `descent.rs` makes one such fit and `robust.rs` chooses among several; `directions.rs` adds normals where positions alone do not
//! determine a surface. `outlier_reinstatement.rs` keeps contacts that lie off it only because
//! the surface departs from constant curvatures. `patch.rs` puts these steps together, and `relief.rs` says how far the patch is
//! from a plane.

mod descent;
mod directions;
mod outlier_reinstatement;
mod patch;
mod relief;
mod robust;

pub(crate) use patch::Patch;
pub(crate) use relief::{relief, weighted_rms};
pub(crate) use robust::thinned;
