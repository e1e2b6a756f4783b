//! One of two ways to solve the equations of a space: the factor of the whole, or conjugate gradients where that would be too large.

use super::schwarz::SchwarzSolver;
use super::sparse_cholesky::{EliminationOrder, SparseCholesky};
use crate::error::HierarchyError;

/// Equations of one pattern, solved one way or the other.
#[derive(Clone, Debug)]
pub struct EquationSolver {
    way: SolutionWay,
}

#[derive(Clone, Debug)]
enum SolutionWay {
    Factor(Box<SparseCholesky>),
    Gradients(Box<SchwarzSolver>),
}

impl EquationSolver {
    /// By a factor of at most so many numbers, by conjugate gradients where it would have more.
    ///
    /// # Errors
    /// [`HierarchyError::Memory`].
    ///
    /// # Panics
    /// When the pattern is no upper triangle in compressed columns, or there are not as many places as columns.
    pub fn plan(
        starts: &[usize],
        rows: &[usize],
        places: &[[f64; 2]],
        most_entries: usize,
    ) -> Result<EquationSolver, HierarchyError> {
        let factor = SparseCholesky::plan(starts, rows, EliminationOrder::NestedDissection(places))?;
        let way = if factor.factor_entries() <= most_entries {
            SolutionWay::Factor(Box::new(factor))
        } else {
            SolutionWay::Gradients(Box::new(SchwarzSolver::plan(starts, rows, places)?))
        };
        Ok(EquationSolver { way })
    }

    /// Takes a matrix by the values of its upper triangle.
    ///
    /// # Errors
    /// As [`SparseCholesky::factor`].
    pub fn factor(&mut self, values: &[f64]) -> Result<(), HierarchyError> {
        match &mut self.way {
            SolutionWay::Factor(factor) => factor.factor(values),
            SolutionWay::Gradients(gradients) => gradients.factor(values),
        }
    }

    /// `v <- A^-1 v`.
    pub fn solve(&self, v: &mut [f64]) {
        match &self.way {
            SolutionWay::Factor(factor) => factor.solve(v),
            SolutionWay::Gradients(gradients) => {
                gradients.solve(v);
            }
        }
    }

    /// The factor of the whole, where there is one: it alone knows determinant, condition and entries of the inverse.
    pub fn whole(&self) -> Option<&SparseCholesky> {
        match &self.way {
            SolutionWay::Factor(factor) => Some(factor),
            SolutionWay::Gradients(_) => None,
        }
    }

    /// The blocks of conjugate gradients, where they solve.
    pub(super) fn blocks(&self) -> Option<&SchwarzSolver> {
        match &self.way {
            SolutionWay::Factor(_) => None,
            SolutionWay::Gradients(gradients) => Some(gradients),
        }
    }

    /// Numbers in the factors that there are.
    pub fn factor_entries(&self) -> usize {
        match &self.way {
            SolutionWay::Factor(factor) => factor.factor_entries(),
            SolutionWay::Gradients(gradients) => gradients.entries(),
        }
    }
}
