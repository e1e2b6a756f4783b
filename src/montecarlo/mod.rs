//! Repeats a fit for noise: intervals of S and R over replicates of a scene.

mod options;

pub use options::StudyOptions;
