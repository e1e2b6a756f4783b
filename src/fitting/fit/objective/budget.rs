//! One budget of steps over all loops of a fit, whose own limits would multiply.
//!
//! ```text
//! places x smoothing x reweighting x noise x Gauss-Newton        60 x 2 x 120 x 300 x 200 solutions at most, without a budget
//! one step = one least squares problem formed and solved by its normal equations, and more by its rows or where data leave gaps
//! every loop ends with what it has once no step is left
//! ```

use std::cell::Cell;

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::notes::Note;
use crate::fit::objective::fitted::Fitted;
use crate::fit::{FitError, MethodUsed};

/// `rows unknowns^2` of a factorisation of rows that counts for one more step: for 800 contacts with normals and 64 unknowns it takes
/// 9 ms, 80 times as long as the normal equations.
const BY_ROWS: usize = 125_000;

/// Turns of coefficients with and without data that count for one more step: of 7,470 contacts with normals a turn takes a tenth of what
/// forming and factoring the normal equations does.
const TURNS_OF_A_STEP: usize = 10;

/// Steps that are left.
#[derive(Debug)]
pub(crate) struct Budget {
    given: usize,
    left: Cell<usize>,
}

impl Budget {
    /// So many steps.
    pub(crate) fn new(given: usize) -> Budget {
        Budget { given, left: Cell::new(given) }
    }

    /// Counts a step that gave this solution of these equations.
    pub(crate) fn take(&self, equations: &Equations, solution: &Solution) {
        let steps = match solution.method {
            MethodUsed::Cholesky | MethodUsed::Kronecker | MethodUsed::Pcg => 1,
            MethodUsed::Qr | MethodUsed::PivotedQr => 1 + equations.count() * equations.unknowns().pow(2) / BY_ROWS,
        };
        let steps = steps + solution.turns / TURNS_OF_A_STEP;
        self.left.set(self.left.get().saturating_sub(steps));
    }

    /// Whether a loop has to end with what it has.
    pub(crate) fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// The answer with a remark where loops were cut short.
    ///
    /// # Errors
    /// [`FitError::StepsSpent`] where the surface itself still moved.
    pub(super) fn judged(&self, mut fitted: Fitted) -> Result<Fitted, FitError> {
        if !self.is_spent() {
            return Ok(fitted);
        }
        let still_moving = fitted.notes.iter().any(|note| matches!(note, Note::NotAtRest { .. }));
        if still_moving {
            return Err(FitError::StepsSpent { steps: self.given });
        }
        fitted.notes.push(Note::StepsSpent { steps: self.given });
        Ok(fitted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Fit, FitOptions, Robust, Smooth, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;

    /// Touches of a bowl whose heights are written in another unit than its places, so that normals and heights contradict each other.
    fn contradicting(unit: f64) -> Contacts {
        let mut errors = vec![0.0; 400];
        let draws = EffectDraws::new(7, "budget");
        errors.chunks_mut(50).enumerate().for_each(|(block, part)| draws.gaussians(0, block as u64, 50, part));
        let (x, y): (Vec<f64>, Vec<f64>) =
            (0..100).map(|r| (f64::from(r % 10) - 4.5 + 0.1 * errors[r as usize], f64::from(r / 10) - 4.5)).unzip();
        let z = (0..100).map(|r| unit * (-0.03 * (x[r] * x[r] + y[r] * y[r]) + 0.02 * errors[100 + r])).collect();
        let normal = |r: usize| [0.06 * x[r] + 0.03 * errors[200 + r], 0.06 * y[r] + 0.03 * errors[300 + r], 1.0];
        let normals: Vec<[f64; 3]> = (0..100).map(normal).collect();
        Contacts::from_positions(x, y, z).with_normal_vectors(&normals)
    }

    fn steps_of(found: &Result<Fit, FitError>) -> Option<usize> {
        match found {
            Ok(fit) => fit.notes().iter().find_map(|note| match note {
                Note::StepsSpent { steps } => Some(*steps),
                _ => None,
            }),
            Err(FitError::StepsSpent { steps }) => Some(*steps),
            Err(_) => None,
        }
    }

    #[test]
    fn heights_in_another_unit_end_within_the_budget() {
        let options = FitOptions::default().with_segments(4, 4).with_degree(4);
        let mut spent = 0;
        for (robust, smooth) in [(Robust::None, Smooth::None), (Robust::Tukey, Smooth::Auto)] {
            let options = options.clone().with_robust(robust).with_smooth(smooth).with_steps(50);
            let found = fit_contacts(&contradicting(1e8), &options);
            assert!(steps_of(&found).is_none_or(|steps| steps == 50), "{found:?}");
            spent += usize::from(steps_of(&found).is_some());
        }
        assert!(spent > 0);
    }

    /// Loops that are cut short give an answer at once, whatever was asked for.
    #[test]
    fn a_budget_of_few_steps_is_one_over_all_loops() {
        let all = FitOptions::default().with_robust(Robust::Tukey).with_smooth(Smooth::Auto).with_sigma_xy(0.05);
        let contacts = contradicting(1.0);
        for steps in [1, 5, 25] {
            assert_eq!(steps_of(&fit_contacts(&contacts, &all.clone().with_steps(steps))), Some(steps));
        }
        assert_eq!(steps_of(&fit_contacts(&contacts, &all)), None);
    }

    /// What does not need the whole budget does not depend on it.
    #[test]
    fn steps_that_are_left_over_change_nothing() {
        let fitted = |steps: usize| {
            let fit = fit_contacts(&contradicting(1.0), &FitOptions::default().with_steps(steps)).unwrap();
            fit.surface().coefficients().clone()
        };
        assert_eq!(fitted(FitOptions::default().steps), fitted(1_000_000));
    }
}
