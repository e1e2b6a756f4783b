//! Contacts that do not fit into one memory: tiles of whole base cells, in files or on other machines, with the same bits for any tiling.
//!
//! ```text
//! parts -> bounds -> frame and base grid -> runs in the order of the cells -> tiles      each round asks every tile
//! ```
//!
//! A tile is the contacts of a run of base cells. All that a fit asks is formed cell by cell, or over blocks of 2,000 contacts in the
//! order of all; a tile that knows the 2,000 before and behind its own forms it to the bits of a single tile. What passes between tiles
//! and the fit is as large as the cells are many, whatever the contacts.

mod contact_run;
mod contact_tile;
mod packed;
mod spooled_contacts;
#[cfg(test)]
mod tests;
mod tile_extent;
mod tile_question;
mod tiled_passes;

use std::time::Duration;

use super::answer::AdaptiveFit;
use super::options::AdaptiveOptions;
use super::{answered, refined};
use crate::error::HierarchyError;
pub use contact_run::{ContactRun, TileGround};
pub use contact_tile::{ContactTile, RunsBeside, beside_tile};
pub use spooled_contacts::{ContactSpool, StoredTiles, fit_spooled};
pub use tile_extent::TileExtent;
pub use tile_question::TileQuestion;
pub use tiled_passes::TileSource;
use tiled_passes::TiledPasses;

/// Fits contacts that are tiles in other hands: to the bits what [`fit_adaptive`](super::fit_adaptive) makes of all of them.
///
/// # Errors
/// Those of a fit; tiles that leave base cells out or do not answer.
pub fn fit_tiles(
    ground: &TileGround,
    extents: &[TileExtent],
    source: &mut dyn TileSource,
    options: &AdaptiveOptions,
) -> Result<AdaptiveFit, HierarchyError> {
    let ground_of = &ground.ground;
    let degree = ground_of.mesh.levels().degree();
    let mut passes = TiledPasses::new(extents, ground.roots(), degree, source)?;
    let (refinement, system) = refined(ground_of, &mut passes, options, Duration::ZERO)?;
    answered(refinement, system, ground_of.frame)
}
