//! A grid's normal matrix solved through fast diagonalisation: directly, or by conjugate gradients preconditioned with it.
//!
//! ```text
//! exact      one weight per block, every pixel measured, no roughness:  c = A^-1 E'b by `FastDiagonalisation`
//! otherwise  conjugate gradients on A, preconditioned with the same factors at the mean weights
//! ```
//!
//! Missing pixels, weight maps and roughness change A little, so that few iterations are needed.

use std::sync::{Mutex, PoisonError};

use super::FastDiagonalisation;
use super::factor::Factor;
use crate::linalg::{GradientLimits, StencilMatrix, conjugate_gradients, inverse_norm1_estimate};

/// Conjugate gradients stop when the preconditioned residual is this fraction of the first; further steps only change
/// roundings.
const CG_TOLERANCE: f64 = 1e-15;
/// Tens of steps are usual with a preconditioner of the right structure; a thousand would mean that it is the wrong one.
const CG_STEPS: usize = 1000;

/// A normal matrix solved through fast diagonalisation: directly if it is exactly what the diagonalisation inverts, by
/// conjugate gradients if it is only close to it.
#[derive(Debug)]
pub struct GridSolver {
    matrix: StencilMatrix,
    /// The lock protects the buffers that it works in.
    diagonalisation: Mutex<FastDiagonalisation>,
    iterative: bool,
}

impl GridSolver {
    /// `matrix` is exactly what `diagonalisation` inverts.
    pub fn direct(matrix: StencilMatrix, diagonalisation: FastDiagonalisation) -> GridSolver {
        GridSolver { matrix, diagonalisation: Mutex::new(diagonalisation), iterative: false }
    }

    /// `matrix` is close to what `diagonalisation` inverts.
    pub fn iterative(matrix: StencilMatrix, diagonalisation: FastDiagonalisation) -> GridSolver {
        GridSolver { matrix, diagonalisation: Mutex::new(diagonalisation), iterative: true }
    }

    /// `v <- A^-1 v`; the number of iterations (0: direct).
    pub fn solve(&self, v: &mut [f64]) -> usize {
        if !self.iterative {
            self.precondition(v);
            return 0;
        }
        let limits = GradientLimits { tolerance: CG_TOLERANCE, steps: CG_STEPS };
        let multiply = |v: &[f64], out: &mut [f64]| self.matrix.multiply(v, out);
        let (solution, iterations) = conjugate_gradients(multiply, |v| self.precondition(v), v, limits);
        v.copy_from_slice(&solution);
        iterations
    }

    /// Condition of the equilibrated rows: root of the 1-norm estimate of `D A D`.
    pub(crate) fn condition(&self) -> f64 {
        let scale: Vec<f64> = self.matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
        let solve = |v: &mut [f64]| {
            v.iter_mut().zip(&scale).for_each(|(w, d)| *w /= d);
            self.solve(v);
            v.iter_mut().zip(&scale).for_each(|(w, d)| *w /= d);
        };
        (self.matrix.norm1_scaled(&scale) * inverse_norm1_estimate(scale.len(), solve, solve)).sqrt()
    }

    fn precondition(&self, v: &mut [f64]) {
        // the buffers hold nothing between calls, so a poisoned lock does no harm
        self.diagonalisation.lock().unwrap_or_else(PoisonError::into_inner).solve(v);
    }
}

impl Factor for GridSolver {
    fn solve(&self, v: &mut [f64]) {
        GridSolver::solve(self, v);
    }

    fn condition(&self) -> f64 {
        GridSolver::condition(self)
    }
}
