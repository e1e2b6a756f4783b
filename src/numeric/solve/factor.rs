//! What a fit asks of every factor, whichever method made it.
//!
//! ```text
//! v <- (E'E)^-1 v          cond(E D)          tr (E'E)^-1 B          (E'E)^-1
//! ```

use crate::linalg::StencilMatrix;

/// A factor of the final problem, kept for covariance, condition and further right-hand sides. A method that knows a short
/// cut to one of the last three overrides it.
pub trait Factor: std::fmt::Debug + Send + Sync {
    /// `v <- (E'E)^-1 v` over the determined unknowns.
    fn solve(&self, v: &mut [f64]);

    /// 1-norm condition estimate of the equilibrated rows.
    fn condition(&self) -> f64;

    /// `tr (E'E)^-1 B` over the unknowns for which `out` is false; `None` where the factor would have to solve for each.
    fn inverse_trace(&self, _b: &StencilMatrix, _out: &dyn Fn(usize) -> bool) -> Option<f64> {
        None
    }

    /// Writes `(E'E)^-1` row by row; `out` holds the square of the order.
    fn write_inverse(&self, out: &mut [f64]) {
        self.write_inverse_by_solving(out);
    }

    /// The same by a solve for each row.
    fn write_inverse_by_solving(&self, out: &mut [f64]) {
        let order = out.len().isqrt();
        out.fill(0.0);
        for (u, row) in out.chunks_exact_mut(order.max(1)).enumerate() {
            row[u] = 1.0;
            self.solve(row);
        }
    }

    /// Inverse norms of the columns of what was factored, where the method has equilibrated by them.
    fn column_scales(&self) -> Option<&[f64]> {
        None
    }
}
