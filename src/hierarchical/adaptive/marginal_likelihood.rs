//! How strongly roughness counts: lambda by restricted maximum likelihood (H. D. Patterson, R. Thompson, *Biometrika* 58 (1971) 545).
//!
//! ```text
//! -2 log L(lambda) = (N - m) log D + log det(A + lambda P) - (n - m) log lambda
//! D = min_c sum w (z - S)^2 + lambda c'Pc = r'r + lambda c0'P c0 - h'(A + lambda P)^-1 h,   h = g - lambda P c0
//! sigma^2 = D/(N - m)           N rows, n unknowns, m = dimension of the surfaces without roughness
//! ```
//!
//! The step from the surface c0 at hand keeps D's digits where noise is far smaller than heights.

use crate::equations::MeetingPattern;
use crate::error::HierarchyError;
use crate::factor::SparseCholesky;
use palpate_numeric::brent::maximum;

/// Natural logarithm of lambda is found to this accuracy: 10 % of lambda, which changes no digit that noise leaves.
const ACCURACY: f64 = 0.1;

/// The equations of one step.
#[derive(Debug)]
pub(crate) struct StepEquations<'a> {
    pub pattern: &'a MeetingPattern,
    /// Values of A and of P.
    pub matrix: &'a [f64],
    pub roughness: &'a [f64],
    /// g, and the coefficients c0 of the surface at hand.
    pub load: &'a [f64],
    pub coefficients: &'a [f64],
    /// Weighted squares of the residuals, and how many rows they are of.
    pub squares: f64,
    pub rows: f64,
    /// Dimension of the surfaces without roughness: 3 of order 2, 6 of order 3.
    pub smooth: f64,
}

/// A step with its lambda.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub lambda: f64,
    pub delta: Vec<f64>,
    /// `D/(N - m)`: the variance of a row of weight 1.
    pub variance: f64,
    /// Factorisations that it took.
    pub factorisations: usize,
}

impl StepEquations<'_> {
    /// Lambda of the largest likelihood and the step that it gives; the factor is left as that of `A + lambda P`.
    ///
    /// # Errors
    /// When no lambda makes the matrix positive definite.
    pub(crate) fn solve(
        &self,
        factor: &mut SparseCholesky,
        start: Option<f64>,
        most: usize,
    ) -> Result<Step, HierarchyError> {
        let mut rough = vec![0.0; self.coefficients.len()];
        self.pattern.multiply(self.roughness, self.coefficients, &mut rough);
        let own: f64 = rough.iter().zip(self.coefficients).map(|(a, b)| a * b).sum();
        let diagonal = |values: &[f64]| self.pattern.starts()[1..].iter().map(|end| values[end - 1]).sum::<f64>();
        let balance = (diagonal(self.matrix) / diagonal(self.roughness)).ln();
        // far below, gaps of the data are left to rounding; far above, the surface has no roughness at all
        let range = [balance - 32.0, balance + 12.0];
        let (around, guess) = match start {
            Some(lambda) => ([(lambda.ln() - 5.0).max(range[0]), (lambda.ln() + 5.0).min(range[1])], lambda.ln()),
            None => (range, balance - 10.0),
        };
        let count = std::cell::Cell::new(0);
        let cell = std::cell::RefCell::new(&mut *factor);
        let value = |log: f64| {
            count.set(count.get() + 1);
            self.at(&mut cell.borrow_mut(), log.exp(), &rough, own).map_or(f64::NAN, |(_, _, value)| value)
        };
        let best = if most == 0 { guess } else { maximum(around, guess, ACCURACY, most, value).0 };
        let lambda = best.exp();
        let (delta, deviance, _) = self.at(factor, lambda, &rough, own)?;
        let variance = deviance.max(0.0) / (self.rows - self.smooth).max(1.0);
        Ok(Step { lambda, delta, variance, factorisations: count.get() + 1 })
    }

    /// Step, D and twice the log likelihood.
    fn at(
        &self,
        factor: &mut SparseCholesky,
        lambda: f64,
        rough: &[f64],
        own: f64,
    ) -> Result<(Vec<f64>, f64, f64), HierarchyError> {
        let values: Vec<f64> = self.matrix.iter().zip(self.roughness).map(|(a, p)| a + lambda * p).collect();
        factor.factor(&values)?;
        let right: Vec<f64> = self.load.iter().zip(rough).map(|(g, p)| g - lambda * p).collect();
        let mut delta = right.clone();
        factor.solve(&mut delta);
        let gain: f64 = right.iter().zip(&delta).map(|(a, b)| a * b).sum();
        let deviance = self.squares + lambda * own - gain;
        let (n, m) = (self.load.len() as f64, self.smooth);
        let value =
            -(self.rows - m) * deviance.max(f64::MIN_POSITIVE).ln() - factor.log_determinant() + (n - m) * lambda.ln();
        Ok((delta, deviance, value))
    }
}
