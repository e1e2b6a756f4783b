//! What step 3 gives: the equations, their solution, and what is known of the noise.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::record::NoiseRecord;
use crate::fit::notes::Note;
use crate::observation::Data;

/// Rows formed and solved.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    /// The linear problem; with normal rows that of the last Gauss-Newton step.
    pub equations: Equations,
    /// Its solution.
    pub solution: Solution,
    /// Noise sds, or the weights that they follow from.
    pub noise: NoiseRecord,
    /// Remarks.
    pub notes: Vec<Note>,
    /// What Gauss-Newton makes of the rounding of one step and of its last one.
    pub iteration: Iteration,
    /// Roots of the weights that a robust loss gave every site, `[heights, slopes]`.
    pub loss_weights: Option<[Vec<f64>; 2]>,
    /// The contacts where they were fitted, if errors in x and y moved them.
    pub moved: Option<Moved>,
}

/// How far a repeated linear problem may be from its fixed point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Iteration {
    /// By how much an error of one linear problem is enlarged at most in `|E .|`; infinity where no bound is known.
    pub enlarged: f64,
    /// How far the enlarged error is from the error itself at most, as a multiple of that.
    pub turned: f64,
    /// What all steps not taken would move the rows by at most, `|E (c* - c)|_2`.
    pub left: f64,
}

impl Iteration {
    /// Of a problem that is linear.
    pub(crate) const NONE: Iteration = Iteration { enlarged: 1.0, turned: 0.0, left: 0.0 };
}

/// Contacts that were moved to where they most likely lie.
#[derive(Clone, Debug)]
pub(crate) struct Moved {
    /// The contacts there, with their readings carried along.
    pub data: Data,
    /// Covariance of every site's rows, upper triangle: an error in place shows in its height and in its slopes at once.
    pub covariances: Vec<[f64; 6]>,
}
