//! The solver methods: those that a user may ask for, and those that an answer may have come from.
//!
//! ```text
//! cholesky -> qr -> pivoted qr          kronecker, pcg on grids          (the order of crate::fit::linear)
//! ```

use super::words::listed;

/// How the least squares problem is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Method {
    /// The cheapest that applies; where its own error estimate is too large, the next one. The fit reports every change.
    #[default]
    Auto,
    /// Cholesky of the normal matrix.
    Cholesky,
    /// QR of the rows.
    Qr,
    /// Fast diagonalisation of a complete grid.
    Kronecker,
    /// Conjugate gradients preconditioned by fast diagonalisation.
    Pcg,
}

words! {
    Method { "auto" => Auto, "cholesky" => Cholesky, "qr" => Qr, "kronecker" => Kronecker, "pcg" => Pcg }
}

/// Method that gave the coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodUsed {
    /// Cholesky of the normal matrix.
    Cholesky,
    /// QR of the rows.
    Qr,
    /// Rank-revealing QR with rows sorted and columns pivoted.
    PivotedQr,
    /// Fast diagonalisation of a complete grid.
    Kronecker,
    /// Preconditioned conjugate gradients.
    Pcg,
}

impl MethodUsed {
    /// The word used in every output.
    pub fn name(self) -> &'static str {
        match self {
            MethodUsed::Cholesky => "cholesky",
            MethodUsed::Qr => "qr",
            MethodUsed::PivotedQr => "pivoted qr",
            MethodUsed::Kronecker => "kronecker",
            MethodUsed::Pcg => "pcg",
        }
    }
}
