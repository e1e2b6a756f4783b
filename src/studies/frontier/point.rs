//! One point of a frontier: what was done, how wrong the answer is, and what it cost.

use super::clock::Clocked;
use super::errors::{Errors, Share};

/// Which of the three frontiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frontier {
    /// Degree, segments, stations, weights, kind of surface.
    Discretisation,
    /// How the least squares problem is solved.
    Solver,
    /// Where the interval comes from.
    Interval,
}

impl Frontier {
    /// The word in every output.
    pub fn name(self) -> &'static str {
        match self {
            Frontier::Discretisation => "discretisation",
            Frontier::Solver => "solver",
            Frontier::Interval => "interval",
        }
    }
}

/// One point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// The line that tells it from others.
    pub label: String,
    /// What was solved, where it is not the scene itself.
    pub case: Option<String>,
    /// How it was solved, or where the interval came from.
    pub method: String,
    /// `height`, `parametric` or `recognised`.
    pub surface: &'static str,
    /// Words for weights or noise.
    pub weights: String,
    /// Degrees in x and y.
    pub degree: [usize; 2],
    /// Segments in x and y.
    pub segments: [usize; 2],
    /// Stations of each finger, where the number was changed.
    pub stations: Option<usize>,
    /// Contacts of the first replicate.
    pub contacts: usize,
    /// Errors of S, R, k1, height, slope, normal.
    pub errors: [Option<Errors>; 6],
    /// Root mean square of S and R together: `sqrt(error_S^2 + (error_R/R)^2)`; of a solver 10^-digits, of an interval the
    /// error of its ends. The axis of the pictures.
    pub error: Option<f64>,
    /// Its interval.
    pub error_interval: Option<[f64; 2]>,
    /// Condition of the problem (solvers).
    pub condition: Option<f64>,
    /// Right digits of the coefficients (solvers).
    pub digits: Option<f64>,
    /// Standard uncertainties of S and of R in the posterior of what was recognised in all contacts (files).
    pub uncertainty: [Option<f64>; 2],
    /// Share of the intervals of S and of R that hold the truth.
    pub coverage: [Option<Share>; 2],
    /// Time of the call without intervals.
    pub seconds: Option<Clocked>,
    /// Time of the call with intervals.
    pub seconds_interval: Option<Clocked>,
    /// Multiply-adds of the first call without intervals: [`palpate_numeric::work`].
    pub multiply_adds: Option<u64>,
    /// Instructions of the call without intervals.
    pub instructions: Option<u64>,
    /// Instructions of the call with intervals.
    pub instructions_interval: Option<u64>,
    /// Bytes that the fit's own arrays hold.
    pub memory: Option<u64>,
    /// Replicates that were judged.
    pub replicates: u64,
    /// Points of the shape grid that the data support, as a share.
    pub support: Option<f64>,
    /// Why there is no answer.
    pub failed: Option<String>,
    /// No other point is certainly better in error and time.
    pub on_frontier: bool,
    /// No other point is better in error and instructions.
    pub on_instructions_frontier: bool,
}
