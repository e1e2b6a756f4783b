//! Equations to coefficients: plan -> factor -> solve.
//!
//! ```text
//! Cholesky   D E'E D = L L',  D = diag(1 / |column of E|)            [`Cholesky`]
//! QR         E D = Q R, front by front; Q is applied and not stored  [`TriangularFactor`]
//! grid       (U (x) V) diag (U (x) V)'                                [`GridSolver`], direct or as preconditioner
//! blocks     D (A + mu diag A) D = L L', 3 x 3 blocks                 [`BlockCholesky`], parametric surfaces
//! dense QR   rows sorted by size, columns pivoted: reveals the rank   [`PivotedQr`]
//! ```
//!
//! Every factor works on the column-equilibrated matrix, solves with `E'E` and estimates the condition of `E D`.

mod band;
mod blocks;
mod cholesky;
mod dense;
mod factor;
mod fast_diagonalisation;
mod householder;
mod kronecker;
mod numbering;
mod ordering;
mod patch;
mod pivoted;
mod selected;
mod small;
mod triangular;

pub use blocks::BlockCholesky;
pub use cholesky::Cholesky;
pub use dense::{DenseMethod, DenseSolution, solve_dense};
pub use factor::Factor;
pub use fast_diagonalisation::{FastDiagonalisation, Simultaneous, simultaneous};
pub use kronecker::GridSolver;
pub use pivoted::PivotedQr;
pub use triangular::TriangularFactor;

/// Why a factorisation has no answer. A rank below the number of unknowns is a result, not an error.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A pivot of Cholesky's factorisation is not positive: the normal matrix is singular to rounding.
    #[error("the normal matrix is not positive definite to rounding at unknown {unknown}")]
    NotPositiveDefinite {
        /// Unknown in the user's numbering.
        unknown: usize,
    },
    /// A column of the equations is empty.
    #[error("unknown {unknown} has no data")]
    EmptyColumn {
        /// Unknown in the user's numbering.
        unknown: usize,
    },
    /// The equations hold a number that is not finite.
    #[error("the equations overflow at unknown {unknown}")]
    NotFinite {
        /// Unknown in the user's numbering.
        unknown: usize,
    },
    /// faer could not get the memory for the factor.
    #[error("no memory for a factor of {unknowns} unknowns")]
    Memory {
        /// Number of unknowns.
        unknowns: usize,
    },
}
