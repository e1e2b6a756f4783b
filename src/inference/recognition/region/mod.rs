//! Which part of which surface the answer is about.
//!
//! ```text
//! Q(u, v) = point of the reported surface        supported: inside the contacts' outline and near enough to one of them
//! map, lattice = even grids over x and y, or over the chart where the surface stands steep
//! ```
//!
//! `surface.rs` comes first, then `support.rs`. `projected_grid.rs` finds the surface over given x and y, and `map.rs` chooses the points.
//! `predictive.rs` says what touches at other places would measure, and `posterior_draws.rs` where the drawn surfaces lie;
//! `coarse_grid.rs` has what lies between the drawn points of a fine map.

mod coarse_grid;
mod map;
mod posterior_draws;
mod predictive;
mod projected_grid;
mod recognised;
mod support;
mod surface;

pub(crate) use coarse_grid::CoarseGrid;
pub(crate) use map::Region;
pub(crate) use posterior_draws::{DrawnLattice, DrawnOffset, DrawnShape, PosteriorDraws, normalise};
pub use predictive::PredictiveDraw;
pub(crate) use predictive::{Place, measured, places, predicted};
pub use recognised::RecognisedSurface;
pub(crate) use surface::PatchSurface;
pub(crate) use surface::chart_point;
