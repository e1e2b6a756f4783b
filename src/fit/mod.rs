//! The paper's five steps. (Filled in next.)
mod options;
pub use options::{FitOptions, FrameChoice, Method, NormalSigma, Objective, Robust, SlopeWeights, Smooth};
