//! Least squares of dense rows: the cheapest factor is tried first, and the solution is refined with residuals in twice
//! the working precision.
//!
//! ```text
//! Cholesky        D E'E D = L L'                         kept while the condition of E D is below 1e4
//! semi-normal     R'R d = D E'(b - E c), R from QR       kept while the corrections shrink
//! QR              c = D R^-1 Q'b, then corrected as above; rank revealed by the pivots
//! correction      c <- c + d,  b - E c and E'(b - E c) in 32 digits (Å. Björck, BIT 7 (1967) and 27 (1987))
//! ```

use super::small::PackedCholesky;
use super::{PivotedQr, SolveError};
use crate::linalg::{DoubleDouble, inverse_norm1_estimate};

/// Cholesky squares the condition; above this condition it would lose more than half of a double's digits.
const CHOLESKY_CONDITION: f64 = 1e4;

/// Each correction is smaller than the last by the accuracy of the factor; ten are enough for a factor good to two digits.
const MOST_CORRECTIONS: usize = 10;

/// How dense rows are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DenseMethod {
    /// Tries the methods below in their order until one succeeds, and records the reason of every step.
    #[default]
    Auto,
    /// Normal equations.
    Cholesky,
    /// Corrected semi-normal equations with QR's R.
    SemiNormal,
    /// Row-sorted, column-pivoted QR.
    Qr,
}

/// The solution, and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseSolution {
    /// c, one per column; unknowns that the rows do not determine are zero.
    pub coefficients: Vec<f64>,
    /// The method that found it.
    pub method: DenseMethod,
    /// Why the methods before it were not used.
    pub reason: String,
    /// Numerical rank.
    pub rank: usize,
    /// Estimated condition of the equilibrated columns.
    pub condition: f64,
    /// Corrections made.
    pub corrections: usize,
    /// Size of the first correction divided by that of the last: the gain of refinement.
    pub gain: f64,
}

/// `min |rhs - E c|` with E given column after column (`values[c * rows + r]`).
///
/// # Errors
/// [`SolveError::NotFinite`]; with [`DenseMethod::Cholesky`] also [`SolveError::NotPositiveDefinite`] where the normal
/// matrix is singular to rounding, and [`SolveError::EmptyColumn`].
pub fn solve_dense(
    rows: usize,
    columns: usize,
    values: &[f64],
    rhs: &[f64],
    method: DenseMethod,
) -> Result<DenseSolution, SolveError> {
    let problem = Problem::new(rows, columns, values, rhs)?;
    match method {
        DenseMethod::Cholesky => problem.by_cholesky(),
        DenseMethod::SemiNormal => Ok(problem.by_semi_normal(&problem.factor()?)),
        DenseMethod::Qr => Ok(problem.by_qr(&problem.factor()?)),
        DenseMethod::Auto => problem.by_the_list(),
    }
}

struct Problem<'a> {
    rows: usize,
    columns: usize,
    values: &'a [f64],
    rhs: &'a [f64],
    /// 1 / column norm.
    scale: Vec<f64>,
}

/// Result of a series of corrections.
struct Refined {
    coefficients: Vec<f64>,
    corrections: usize,
    gain: f64,
    settled: bool,
}

impl<'a> Problem<'a> {
    fn new(rows: usize, columns: usize, values: &'a [f64], rhs: &'a [f64]) -> Result<Problem<'a>, SolveError> {
        let norms = values.chunks_exact(rows.max(1)).map(|column| column.iter().fold(0.0_f64, |n, v| n.hypot(*v)));
        let scale: Vec<f64> = norms.map(|norm| if norm == 0.0 { 1.0 } else { 1.0 / norm }).collect();
        match scale.iter().position(|s| !s.is_normal()) {
            Some(unknown) => Err(SolveError::NotFinite { unknown }),
            None => Ok(Problem { rows, columns, values, rhs, scale }),
        }
    }

    fn column(&self, c: usize) -> &[f64] {
        &self.values[c * self.rows..(c + 1) * self.rows]
    }

    fn factor(&self) -> Result<PivotedQr, SolveError> {
        PivotedQr::of_dense(self.rows, self.columns, self.values, self.rhs)
    }

    fn by_the_list(&self) -> Result<DenseSolution, SolveError> {
        let mut reasons = Vec::new();
        match self.by_cholesky() {
            Ok(solution) if solution.condition <= CHOLESKY_CONDITION => return Ok(solution),
            Ok(solution) => reasons
                .push(format!("Cholesky would lose more than half the digits at condition {:.1e}", solution.condition)),
            Err(error @ SolveError::NotFinite { .. }) => return Err(error),
            Err(error) => reasons.push(format!("Cholesky breaks down: {error}")),
        }
        let factor = self.factor()?;
        let mut solution = self.by_semi_normal(&factor);
        if factor.rank() < self.columns {
            reasons.push(format!("rank {} of {} by column-pivoted QR", factor.rank(), self.columns));
            solution = self.by_qr(&factor);
        } else if solution.gain < 2.0 {
            reasons.push("corrections to the semi-normal equations do not shrink".to_string());
            solution = self.by_qr(&factor);
        }
        solution.reason = reasons.join("; ");
        Ok(solution)
    }

    fn by_cholesky(&self) -> Result<DenseSolution, SolveError> {
        let (factor, norm) = self.normal_factor()?;
        let mut condition = 0.0;
        if self.columns > 0 {
            condition = (norm * inverse_norm1_estimate(self.columns, |v| factor.solve(v), |v| factor.solve(v))).sqrt();
        }
        // the computed normal matrix has a relative error of columns * eps; at such a condition its factor is mostly that
        // of rounding errors
        if condition.is_nan() || self.columns as f64 * f64::EPSILON * condition * condition > 0.1 {
            return Err(SolveError::NotPositiveDefinite { unknown: self.columns - 1 });
        }
        let solve = |v: &mut [f64]| {
            v.iter_mut().zip(&self.scale).for_each(|(w, s)| *w *= s);
            factor.solve(v);
            v.iter_mut().zip(&self.scale).for_each(|(w, s)| *w *= s);
        };
        let refined = self.refine(vec![0.0; self.columns], solve);
        let reason = "the cheapest factor holds".to_string();
        Ok(self.solution(refined, DenseMethod::Cholesky, reason, self.columns, condition))
    }

    /// Cholesky factor of the equilibrated normal matrix, and that matrix's 1-norm.
    fn normal_factor(&self) -> Result<(PackedCholesky, f64), SolveError> {
        let mut factor = PackedCholesky::default();
        factor.reset(self.columns);
        let mut sums = vec![0.0; self.columns];
        for i in 0..self.columns {
            for j in 0..=i {
                let products = self.column(i).iter().zip(self.column(j));
                let value: f64 = products.map(|(a, b)| (a * self.scale[i]) * (b * self.scale[j])).sum();
                if !value.is_finite() {
                    return Err(SolveError::NotFinite { unknown: i });
                }
                if i == j && value == 0.0 {
                    return Err(SolveError::EmptyColumn { unknown: i });
                }
                factor.set(i, j, value);
                sums[i] += value.abs();
                if i != j {
                    sums[j] += value.abs();
                }
            }
        }
        factor.factor().map_err(|unknown| SolveError::NotPositiveDefinite { unknown })?;
        Ok((factor, sums.into_iter().fold(0.0, f64::max)))
    }

    fn by_semi_normal(&self, factor: &PivotedQr) -> DenseSolution {
        let refined = self.refine(vec![0.0; self.columns], |v| factor.solve(v));
        let reason = "asked for".to_string();
        self.solution(refined, DenseMethod::SemiNormal, reason, factor.rank(), factor.condition())
    }

    fn by_qr(&self, factor: &PivotedQr) -> DenseSolution {
        let begun = factor.coefficients();
        let mut refined = self.refine(begun.clone(), |v| factor.solve(v));
        if !refined.settled && refined.gain < 2.0 {
            refined = Refined { coefficients: begun, corrections: 0, gain: 1.0, settled: false };
        }
        let reason = "asked for".to_string();
        self.solution(refined, DenseMethod::Qr, reason, factor.rank(), factor.condition())
    }

    fn solution(
        &self,
        refined: Refined,
        method: DenseMethod,
        reason: String,
        rank: usize,
        condition: f64,
    ) -> DenseSolution {
        let Refined { coefficients, corrections, gain, .. } = refined;
        DenseSolution { coefficients, method, reason, rank, condition, corrections, gain }
    }

    /// Corrections with `solve` (`v <- (E'E)^-1 v`, roughly) until they vanish or stop shrinking.
    fn refine(&self, mut c: Vec<f64>, solve: impl Fn(&mut [f64])) -> Refined {
        let (mut first, mut last) = (0.0, f64::INFINITY);
        for step in 0..MOST_CORRECTIONS {
            let mut d = self.gradient(&c);
            solve(&mut d);
            let (size, whole) = (self.size(&d), self.size(&c));
            first = if step == 0 { size } else { first };
            let settled = size <= f64::EPSILON / 2.0 * whole;
            if !settled && (size.is_nan() || size > 0.5 * last) {
                return Refined { coefficients: c, corrections: step, gain: first / last, settled: false };
            }
            c.iter_mut().zip(&d).for_each(|(c, d)| *c += d);
            last = size;
            if settled {
                let gain = if size > 0.0 { first / size } else { f64::INFINITY };
                return Refined { coefficients: c, corrections: step + 1, gain, settled };
            }
        }
        Refined { coefficients: c, corrections: MOST_CORRECTIONS, gain: first / last, settled: false }
    }

    /// `E'(b - E c)` in 32 digits, rounded once.
    fn gradient(&self, c: &[f64]) -> Vec<f64> {
        let mut residual: Vec<DoubleDouble> = self.rhs.iter().map(|&b| DoubleDouble::new(b)).collect();
        for (j, &value) in c.iter().enumerate() {
            let value = DoubleDouble::new(-value);
            residual.iter_mut().zip(self.column(j)).for_each(|(r, &e)| *r = *r + DoubleDouble::new(e) * value);
        }
        let dot = |column: &[f64]| {
            let products = column.iter().zip(&residual).map(|(&e, &r)| DoubleDouble::new(e) * r);
            products.fold(DoubleDouble::ZERO, |sum, p| sum + p).to_f64()
        };
        (0..self.columns).map(|j| dot(self.column(j))).collect()
    }

    /// Largest entry of `D^-1 c`.
    fn size(&self, c: &[f64]) -> f64 {
        c.iter().zip(&self.scale).fold(0.0, |m, (v, s)| if v.is_nan() { f64::NAN } else { f64::max(m, (v / s).abs()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vandermonde columns of degree 7 on 12 points of [5, 6]: condition far beyond Cholesky's reach.
    fn vandermonde() -> (Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = (0..12).map(|i| 5.0 + i as f64 / 11.0).collect();
        let values = (0..8).flat_map(|k| x.iter().map(move |v| v.powi(k))).collect();
        (values, x.iter().map(|v| 3.0 - v).collect())
    }

    #[test]
    fn auto_moves_on_where_cholesky_breaks_down() {
        let (values, rhs) = vandermonde();
        let found = solve_dense(12, 8, &values, &rhs, DenseMethod::Auto).unwrap();
        assert_ne!(found.method, DenseMethod::Cholesky);
        assert!(found.reason.contains("Cholesky"), "{}", found.reason);
        let direct = solve_dense(12, 8, &values, &rhs, DenseMethod::Cholesky);
        assert!(matches!(direct, Err(SolveError::NotPositiveDefinite { .. })), "{direct:?}");
    }

    #[test]
    fn all_methods_agree_on_an_easy_problem() {
        let values: Vec<f64> = (0..3).flat_map(|k| (0..9).map(move |i| (i as f64 / 4.0 - 1.0).powi(k))).collect();
        let rhs: Vec<f64> = (0..9).map(|i| ((i * i) % 7) as f64).collect();
        let answers = [DenseMethod::Auto, DenseMethod::Cholesky, DenseMethod::SemiNormal, DenseMethod::Qr]
            .map(|m| solve_dense(9, 3, &values, &rhs, m).unwrap().coefficients);
        for c in &answers {
            assert!(c.iter().zip(&answers[0]).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }

    #[test]
    fn a_repeated_column_lowers_the_rank() {
        let values = [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0];
        let found = solve_dense(4, 2, &values, &[2.0, 4.0, 6.0, 8.0], DenseMethod::Auto).unwrap();
        assert_eq!(found.rank, 1);
        assert!((found.coefficients.iter().sum::<f64>() - 2.0).abs() < 1e-14);
    }
}
