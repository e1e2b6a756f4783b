//! A way with what was measured of it.

use super::configuration::Configuration;
use super::point::Point;

/// A candidate with its point and with the errors of S and R in every replicate, from which a request is answered.
#[derive(Clone, Debug)]
pub struct Measured {
    /// What was done.
    pub configuration: Configuration,
    /// What came out.
    pub point: Point,
    /// Rms errors of S and R over the grid, replicate by replicate; NaN where there is none.
    pub runs: Vec<[f64; 2]>,
    /// Nothing is random: every replicate would be this one.
    pub fixed: bool,
}
