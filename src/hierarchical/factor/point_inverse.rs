//! One of two ways to know variances at points: entries of the inverse along the factor, or blocks and random draws.

use super::equation_solver::EquationSolver;
use super::sampled_inverse::SampledInverse;
use super::selected_inverse::SelectedInverse;

/// The inverse of a matrix among unknowns that meet.
#[derive(Clone, Debug)]
pub enum PointInverse {
    /// From the factor of the whole.
    Selected(Box<SelectedInverse>),
    /// Where there is none.
    Sampled(Box<SampledInverse>),
}

impl PointInverse {
    /// Of the matrix that a solver has taken last; `loads` gives random loads with it as covariance, and is asked where they are needed.
    pub fn of(solver: &EquationSolver, loads: impl FnOnce() -> Vec<Vec<f64>>) -> Option<PointInverse> {
        match (solver.whole(), solver.blocks()) {
            (Some(factor), _) => SelectedInverse::of(factor).map(|inverse| PointInverse::Selected(Box::new(inverse))),
            (None, Some(blocks)) => {
                SampledInverse::of(blocks, loads()).map(|inverse| PointInverse::Sampled(Box::new(inverse)))
            }
            (None, None) => None,
        }
    }

    /// `g'A^-1 g` of a functional whose unknowns all meet each other: `(unknown, derivative)`.
    pub fn quadratic(&self, gradient: &[(u32, f64)]) -> Option<f64> {
        match self {
            PointInverse::Selected(inverse) => inverse.quadratic(gradient.iter().map(|(k, g)| (*k as usize, *g))),
            PointInverse::Sampled(inverse) => inverse.quadratic(gradient),
        }
    }

    /// `tr A^-1 B` for a matrix B within the pattern, by the values of its upper triangle in compressed columns.
    pub fn trace_with(&self, starts: &[usize], rows: &[usize], values: &[f64]) -> f64 {
        match self {
            PointInverse::Selected(inverse) => inverse.trace_with(starts, rows, values),
            PointInverse::Sampled(inverse) => inverse.trace_with(starts, rows, values),
        }
    }

    /// Share by which random draws put a standard deviation off, root mean square; `None` where nothing is drawn.
    pub fn error(&self) -> Option<f64> {
        match self {
            PointInverse::Selected(_) => None,
            PointInverse::Sampled(inverse) => Some(inverse.error()),
        }
    }
}
