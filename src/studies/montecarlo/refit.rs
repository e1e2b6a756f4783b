//! Replicates whose sites move: every one is a small fit of its own, all with the same pattern, on all threads.
//!
//! Slope rows with known weights in the patch that stands still. Contacts that noise carries out of its domain are
//! evaluated by the end polynomial.

use super::problem::{Problem, Rows};
use palpate_fitting::fit::FitError;
use palpate_fitting::observation::ScatteredSites;
use palpate_fitting::plans::{PlanError, SlopeColumns, SlopePlan};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Targets};
use palpate_world::scene::ContactBatch;

/// Slopes beyond this have no digits left to fit (as in a plain fit).
const STEEP: f64 = 1e8;

/// Why one replicate cannot be fitted.
#[derive(Clone, Debug, thiserror::Error)]
pub(super) enum RefitError {
    /// What a plain fit would say of its contacts.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// What the plan says of its rows.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// The memory of one thread: plan and columns.
#[derive(Debug)]
pub(super) struct Refit {
    plan: Option<SlopePlan>,
    weights: SiteWeights,
    columns: [Vec<f64>; 5],
}

impl Refit {
    /// Plans for the problem's knots and weights.
    ///
    /// # Errors
    /// No memory.
    pub(super) fn new(problem: &Problem) -> Result<Refit, RefitError> {
        let weights = match problem.rows() {
            Rows::Slopes(weights) => *weights,
            Rows::Normals { .. } => return Err(FitError::Method { method: "refit", why: "needs slope rows" }.into()),
        };
        // plans are made for degrees 1 to 3 without a penalty
        let planned = problem.roughness().is_none() && problem.knots().iter().all(|knots| knots.degree() <= 3);
        let plan = if planned {
            Some(SlopePlan::new(problem.knots().clone(), [weights.z, weights.a, weights.d])?)
        } else {
            None
        };
        Ok(Refit { plan, weights, columns: Default::default() })
    }

    /// Coefficients of the replicate at `replicate` of a simulated batch.
    ///
    /// # Errors
    /// A normal without a slope, contacts that leave coefficients free.
    pub(super) fn coefficients(
        &mut self,
        problem: &Problem,
        batch: &ContactBatch,
        replicate: usize,
        out: &mut [f64],
    ) -> Result<(), RefitError> {
        self.columns.iter_mut().for_each(Vec::clear);
        for contact in (0..batch.contacts()).filter(|contact| !batch.is_lost(*contact, replicate)) {
            let entry = contact * batch.replicates() + replicate;
            let [x, y, z] = problem.local(batch.points[entry]);
            let [nx, ny, nz] = batch.normals[entry];
            let (zx, zy) = (-nx / nz, -ny / nz);
            if nz < 0.0 {
                return Err(FitError::NormalDown { index: contact, nz }.into());
            }
            if !(zx.abs() < STEEP && zy.abs() < STEEP) {
                return Err(FitError::Steep { index: contact, nz }.into());
            }
            self.columns.iter_mut().zip([x, y, z, zx, zy]).for_each(|(column, value)| column.push(value));
        }
        let [x, y, z, zx, zy] = &self.columns;
        let Some(plan) = &mut self.plan else { return self.by_rows(problem, out) };
        out.copy_from_slice(plan.fit(&SlopeColumns { x, y, z, zx, zy })?);
        Ok(())
    }

    fn by_rows(&self, problem: &Problem, out: &mut [f64]) -> Result<(), RefitError> {
        let [x, y, z, zx, zy] = &self.columns;
        let m = self.weights;
        let sites = ScatteredSites::new(problem.knots().clone(), x.iter().zip(y).map(|(x, y)| [*x, *y]).collect());
        let targets: Targets = (0..x.len()).map(|r| [m.z * z[r], m.a * zx[r], m.d * zy[r]]).collect();
        let (_, c) = problem.solved(&sites, &RowWeights::Uniform(m), &targets)?;
        out.copy_from_slice(&c);
        Ok(())
    }
}
