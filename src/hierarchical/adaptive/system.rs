//! What depends on the knots alone: the functions, which of them meet, their roughness, and the plan of the factor.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::equations::{LevelRoughness, MeetingPattern};
use crate::error::HierarchyError;
use crate::factor::EquationSolver;
use crate::space::HierarchicalSpace;
use palpate_fitting::observation::RoughnessOrder;

/// Where the time of a fit went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FitWork {
    /// Sorting the contacts.
    pub sorting: Duration,
    /// Passes over the contacts: residuals, scales, tests and sums.
    pub passes: Duration,
    /// Numbering functions, patterns, and adding cells into the sparse matrix.
    pub assembly: Duration,
    /// Symbolic and numeric factorisations with their solutions.
    pub factorisation: Duration,
    /// Entries of the inverse.
    pub inverse: Duration,
    /// Numeric factorisations.
    pub factorisations: usize,
}

/// The clock of one kind of work.
pub(super) fn timed<T>(clock: &mut Duration, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let made = work();
    *clock += begun.elapsed();
    made
}

/// Everything of a space that a step needs, kept while the knots stay.
#[derive(Debug)]
pub(super) struct System {
    pub space: Arc<HierarchicalSpace>,
    pub pattern: MeetingPattern,
    /// Over the cells of every level.
    pub roughness: Vec<LevelRoughness>,
    pub factor: EquationSolver,
}

impl System {
    pub(super) fn plan(
        space: Arc<HierarchicalSpace>,
        order: RoughnessOrder,
        most_entries: usize,
        work: &mut FitWork,
    ) -> Result<System, HierarchyError> {
        let (pattern, roughness) = timed(&mut work.assembly, || {
            let pattern = MeetingPattern::of(&space);
            let roughness = pattern.roughness(&space, order);
            (pattern, roughness)
        });
        let factor = timed(&mut work.factorisation, || {
            EquationSolver::plan(pattern.starts(), pattern.rows(), &space.places(), most_entries)
        })?;
        Ok(System { space, pattern, roughness, factor })
    }

    /// The roughness of all levels, each by its lambda.
    pub(super) fn rough(&self, lambdas: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.rows().len()];
        self.roughness.iter().zip(lambdas).for_each(|(level, lambda)| level.add_to(*lambda, &mut values));
        values
    }
}
