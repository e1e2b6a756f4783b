//! Repeated fits with simulated noise: intervals of S and R over replicates of a scene.

mod fixed_sites;
mod options;

pub use fixed_sites::FixedSites;
#[doc(hidden)]
pub use fixed_sites::ROW_NOISE;
pub use options::StudyOptions;
