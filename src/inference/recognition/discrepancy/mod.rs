//! How a surface departs from two constant curvatures: by a displacement along its normal.
//!
//! ```text
//! Q(u, v) = point at arc lengths (u, v), moved by f(u, v) along the normal        f(u, v) = sum_ij c_ij N_i(u) N_j(v)
//! ```
//!
//! `displacement.rs` comes first, with the splines (`basis.rs`, as fine as `resolution.rs` has them) and the prior of third derivatives that cost. `cell_charts.rs` says what cells of
//! many contacts show of them. `polynomial_prior.rs` has the prior of natural size, and `smooth.rs`, with `rotational_process.rs` for bodies
//! that were turned and `bodies.rs` for others, those of processes that are smooth in all their derivatives. `state.rs` is one such surface
//! with all its parameters fixed: where it lies and how it bends, and `displaced_batch.rs` eight of them at once.

mod basis;
mod bodies;
mod cell_charts;
mod displaced_batch;
mod displacement;
mod polynomial_prior;
mod resolution;
mod rotational_process;
mod smooth;
mod state;

pub(crate) use bodies::{Body, Forms};
pub(crate) use displaced_batch::Together;
pub(crate) use displacement::{Displacement, POLE, Quadratic};
pub(crate) use polynomial_prior::{TERMS as NATURAL_TERMS, size as natural_size};
pub(crate) use resolution::DepartureResolution;
pub(crate) use smooth::is_free;
pub(crate) use state::{ChartPoint, State};
