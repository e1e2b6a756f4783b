//! What step 3 gives: the equations, their solution, and what is known of the noise.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::record::NoiseRecord;
use crate::fit::notes::Note;
use crate::fit::placing::data::Data;

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
    /// The contacts where they were fitted, if errors in x and y moved them.
    pub moved: Option<Moved>,
}

/// Contacts that were moved to where they most likely lie.
#[derive(Clone, Debug)]
pub(crate) struct Moved {
    /// The contacts there, with their readings carried along.
    pub data: Data,
    /// Covariance of every site's rows, upper triangle: an error in place shows in its height and in its slopes at once.
    pub covariances: Vec<[f64; 6]>,
}
