//! Surfaces on which intervals are judged, and how narrow an interval could be there.
//!
//! ```text
//! random surface -> family -> Fisher information of its contacts -> sd of S and R that an oracle has -> least width beside the family
//! ```

mod cramer_rao;
mod minimax_length;
mod random_surfaces;

pub use cramer_rao::{Family, noise_of, oracle_sd};
pub use minimax_length::{LeastWidth, SHARE};
pub use random_surfaces::RandomSurface;
