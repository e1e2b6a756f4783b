//! What step 3 gives: the equations, their solution, and what is known of the noise.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::record::NoiseRecord;
use crate::fit::notes::Note;

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
    /// What the Gauss-Newton steps not taken would have moved, relative to the largest coefficient; zero for slope rows.
    pub last_move: f64,
}
