//! How strongly roughness counts: lambda of every level by restricted maximum likelihood (H. D. Patterson, R. Thompson, *Biometrika* 58
//! (1971) 545).
//!
//! ```text
//! P = sum_l lambda_l P_l       -2 log L(mu) = (N - m) log D + log det(A + mu P) - (n - m) log mu
//! D = min_c sum w (z - S)^2 + mu c'Pc = r'r + mu c0'P c0 - h'(A + mu P)^-1 h,   h = g - mu P c0
//! sigma^2 = D/(N - m)           (declared: (N - m) log D is D/sigma^2)           N rows, n unknowns, m = dimension of the surfaces without roughness
//! lambda_l <- sigma^2 (r_l - lambda_l tr (A + P)^-1 P_l) / c'P_l c,     r_l = lambda_l tr P^+ P_l = sum_i lambda_l P_l,ii / P_ii about
//! ```
//!
//! mu is found by search, the ratios of the levels by the last line (S. Wood, M. Fasiolo, *Biometrics* 73 (2017) 1071): where a feature
//! stands, cells are small, and the surface may bend there without bending everywhere. The step from the surface c0 at hand keeps D's
//! digits where noise is far smaller than heights.

use super::rules::LevelRule;
use super::system::System;
use crate::equations::MeetingPattern;
use crate::error::HierarchyError;
use crate::factor::{EquationSolver, SparseCholesky};
use palpate_numeric::brent::maximum;
use palpate_numeric::draws::Lcg;
use palpate_numeric::threads;

/// Natural logarithm of lambda is found to this accuracy: 10 % of lambda, which changes no digit that noise leaves.
const ACCURACY: f64 = 0.1;
/// The equations of one step.
#[derive(Debug)]
pub(crate) struct StepEquations<'a> {
    pub pattern: &'a MeetingPattern,
    /// Values of A, and of P with the ratios of the levels.
    pub matrix: &'a [f64],
    pub roughness: &'a [f64],
    /// g, and the coefficients c0 of the surface at hand.
    pub load: &'a [f64],
    pub coefficients: &'a [f64],
    /// Weighted squares of the residuals, and how many rows they are of.
    pub squares: f64,
    pub rows: f64,
    /// Variance of a row of weight 1, where it was declared.
    pub declared: Option<f64>,
    /// Dimension of the surfaces without roughness: 3 of order 2, 6 of order 3.
    pub smooth: f64,
}

/// A step with its lambda.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub factor_of_lambda: f64,
    pub delta: Vec<f64>,
    /// `D/(N - m)`: the variance of a row of weight 1.
    pub variance: f64,
    /// Factorisations that it took.
    pub factorisations: usize,
}

impl StepEquations<'_> {
    /// The factor mu of the largest likelihood and the step that it gives; the factor is left as that of `A + mu P`. `most` likelihoods
    /// are asked for; one or none: mu is 1. Without a `start` nothing is known of mu.
    ///
    /// # Errors
    /// When no lambda makes the matrix positive definite.
    pub(crate) fn solve(&self, factor: &mut EquationSolver, known: bool, most: usize) -> Result<Step, HierarchyError> {
        let mut rough = vec![0.0; self.coefficients.len()];
        self.pattern.multiply(self.roughness, self.coefficients, &mut rough);
        let own: f64 = rough.iter().zip(self.coefficients).map(|(a, b)| a * b).sum();
        let diagonal = |values: &[f64]| self.pattern.starts()[1..].iter().map(|end| values[end - 1]).sum::<f64>();
        let balance = (diagonal(self.matrix) / diagonal(self.roughness)).ln();
        // far below, gaps of the data are left to rounding; far above, the surface has no roughness at all
        let range = [balance - 32.0, balance + 12.0];
        let (around, guess) = if known { ([-5.0, 5.0], 0.0) } else { (range, balance - 10.0) };
        let count = std::cell::Cell::new(0);
        let cell = std::cell::RefCell::new(&mut *factor);
        let value = |log: f64| {
            count.set(count.get() + 1);
            self.at(&mut cell.borrow_mut(), log.exp(), &rough, own).map_or(f64::NAN, |(_, _, value)| value)
        };
        let best = if most <= 1 { guess } else { maximum(around, guess, ACCURACY, most, value).0 };
        let lambda = best.exp();
        let (delta, deviance, _) = self.at(factor, lambda, &rough, own)?;
        let found = deviance.max(0.0) / (self.rows - self.smooth).max(1.0);
        let variance = self.declared.unwrap_or(found);
        Ok(Step { factor_of_lambda: lambda, delta, variance, factorisations: count.get() + 1 })
    }

    /// Step, D and twice the log likelihood.
    fn at(
        &self,
        factor: &mut EquationSolver,
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
        let value = -(self.rows - m) * deviance.max(f64::MIN_POSITIVE).ln()
            - factor.whole().map_or(0.0, SparseCholesky::log_determinant)
            + (n - m) * lambda.ln();
        Ok((delta, deviance, value))
    }
}

/// What the lambdas of levels are moved from: the surface and the factor of the lambdas at hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelStep<'a> {
    pub lambdas: &'a [f64],
    pub coefficients: &'a [f64],
    /// Values of A.
    pub matrix: &'a [f64],
    pub variance: f64,
    /// Dimension of the surfaces without roughness.
    pub smooth: f64,
}

impl LevelStep<'_> {
    /// Lambdas of all levels after one step of the last formula.
    ///
    /// The traces are means over vectors of random signs, `E z'(A + P)^-1 P_l z` (M. Hutchinson, *Commun. Stat. Simul.* 19 (1990) 433): of a
    /// level with r functions they are off by the share `1/sqrt(4 r)`, and each vector is one solution for all levels.
    pub(crate) fn next(&self, system: &System, rule: &LevelRule) -> Vec<f64> {
        let LevelStep { lambdas, coefficients, matrix, variance, smooth } = *self;
        let pattern = &system.pattern;
        let unknowns = coefficients.len();
        let diagonal = |values: &[f64]| pattern.starts()[1..].iter().map(|end| values[end - 1]).collect::<Vec<f64>>();
        let whole = diagonal(&system.rough(lambdas));
        let contacts: f64 = diagonal(matrix).iter().sum();
        let probes = threads::map(rule.probes, 1, |probe| signs_and_solution(system, unknowns, probe as u64));
        let free = (unknowns as f64 - smooth).max(1.0) / unknowns as f64;
        let next = |(level, lambda): (usize, &f64)| {
            let roughness = &system.roughness[level];
            let total: f64 = roughness.diagonal().map(|(_, own)| own).sum();
            let shares = roughness.diagonal().filter(|(k, _)| whole[*k] > 0.0).map(|(k, own)| lambda * own / whole[k]);
            let rank = shares.sum::<f64>() * free;
            let rough = roughness.form(coefficients, coefficients);
            let traces = probes.iter().map(|[signs, solution]| roughness.form(signs, solution));
            let trace = traces.sum::<f64>() / probes.len() as f64;
            if total <= 0.0 || rank <= 0.0 {
                return *lambda;
            }
            let most = (rule.stiffest * contacts / total).max(*lambda);
            let left = (rank - lambda * trace).max(rule.least_left * rank);
            let wanted = if rough > 0.0 { variance * left / rough } else { most };
            wanted.clamp(lambda / rule.longest_step, lambda * rule.longest_step).min(most)
        };
        let mut found: Vec<f64> = lambdas.iter().enumerate().map(next).collect();
        // cells are small where the surface is rougher than elsewhere: a few smooth ones among them must not stiffen the others
        (1..found.len()).for_each(|level| found[level] = found[level].min(found[level - 1]));
        found
    }
}

/// Random signs z, and `(A + P)^-1 z`.
fn signs_and_solution(system: &System, unknowns: usize, probe: u64) -> [Vec<f64>; 2] {
    let mut draw = Lcg::new(0x5eed + probe);
    let signs: Vec<f64> = (0..unknowns).map(|_| if draw.uniform() < 0.5 { -1.0 } else { 1.0 }).collect();
    let mut solution = signs.clone();
    system.factor.solve(&mut solution);
    [signs, solution]
}
