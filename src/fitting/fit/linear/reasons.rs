//! Why a method gave the answer, decision by decision, in the words of every output.
//!
//! ```text
//! condition, pivots, rank, weights, gaps -> Reason -> one clause of the sentence that the user reads
//! ```

/// Why that method, one decision after another.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// The user asked for it.
    Requested,
    /// All pivots well away from zero.
    PivotsSound,
    /// The condition estimate allows Cholesky.
    ConditionSound {
        /// Condition of the equilibrated rows.
        condition: f64,
    },
    /// Cholesky would lose more than half the digits.
    ConditionPoor {
        /// Condition of the equilibrated rows.
        condition: f64,
    },
    /// Cholesky broke down.
    CholeskyBroke {
        /// At this unknown.
        unknown: usize,
    },
    /// QR found columns that depend on others.
    RankDeficient {
        /// Rank found.
        rank: usize,
    },
    /// Row weights differ by so much that rows are sorted and columns pivoted.
    WeightsDiffer {
        /// Largest over smallest row weight.
        ratio: f64,
    },
    /// Fast diagonalisation is exact here.
    CompleteGrid,
    /// Conjugate gradients with fast diagonalisation as preconditioner.
    Iterated {
        /// Iterations of the first solve.
        iterations: usize,
    },
    /// Coefficients without data, or with too little, take least-roughness values.
    Gap {
        /// How many.
        coefficients: usize,
    },
    /// Least roughness does not determine the coefficients without data.
    GapUnfilled {
        /// How many.
        coefficients: usize,
    },
    /// No height rows: the mean height is set to zero.
    NoHeights,
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Reason::Requested => write!(f, "requested"),
            Reason::PivotsSound => write!(f, "all pivots sound"),
            Reason::ConditionSound { condition } => {
                write!(f, "condition {condition:.1e} leaves more than half the digits")
            }
            Reason::ConditionPoor { condition } => {
                write!(f, "condition {condition:.1e} would cost Cholesky more than half the digits")
            }
            Reason::CholeskyBroke { unknown } => write!(f, "Cholesky broke down at unknown {unknown}"),
            Reason::RankDeficient { rank } => write!(f, "rank {rank}: the rest takes least roughness"),
            Reason::WeightsDiffer { ratio } => {
                write!(f, "row weights differ by {ratio:.1e}: rows sorted, columns pivoted")
            }
            Reason::CompleteGrid => write!(f, "complete grid with one weight per block"),
            Reason::Iterated { iterations } => write!(f, "{iterations} iterations"),
            Reason::Gap { coefficients } => {
                write!(f, "{coefficients} coefficients without enough data take least roughness")
            }
            Reason::GapUnfilled { coefficients } => {
                write!(f, "least roughness does not determine the {coefficients} coefficients without enough data")
            }
            Reason::NoHeights => write!(f, "no heights: their mean is set to zero"),
        }
    }
}
