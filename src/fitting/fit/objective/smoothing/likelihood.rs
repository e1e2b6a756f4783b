//! The restricted likelihood of a smoothing, by its slopes.
//!
//! ```text
//! -2 l = (N - M) ln q + ln |A| - ln |P|+ + (ln a / ln 2)^2       q = |b - E c|^2 + lambda c'Pc,  A = E'E + lambda P,  c = A^-1 E'b
//! by ln lambda   (N - M) lambda c'Pc / q  - (trace H - M)                                H = E A^-1 E'
//! by ln a        (N - M) lambda c'P'c / q + lambda trace A^-1 P' - trace P^+ P' + 2 ln a / (ln 2)^2        P' = dP / d ln a
//! N rows, n unknowns, M of them free of roughness,   |P|+ the product of the other eigenvalues, times lambda^(n - M)
//! ```
//!
//! S. Wood, *J. R. Statist. Soc. B* 73 (2011) 3. The surface is a draw of a process whose roughness is what it is told by; with as many
//! unknowns as rows, where cross-validation often takes noise for shape, its minimum stays where it is. Rows are taken for independent;
//! correlated errors (normals from overlapping neighbourhoods) make lambda too small.
//!
//! `trace P^+ P'` comes from a factor: where six coefficients, by which surfaces without roughness are told apart, have a weight K on
//! their diagonal, `ln |P + K|` is `ln |P|+` and a constant, since every smaller determinant of its expansion vanishes.

use crate::fit::Method;
use crate::fit::linear;
use crate::fit::linear::equations::{Equations, quadratic_form};
use crate::fit::linear::solution::Solution;
use crate::fit::noise::traces::{hat_traces, inverse_trace, trace};
use crate::fit::objective::budget::Budget;
use crate::observation::{Roughness, RoughnessOrder, roughness_matrix};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::StencilMatrix;
use palpate_numeric::solve::Cholesky;

/// Prior sd of the logarithm of the aspect: bends twice as long one way as the other are common. Few contacts tell no aspect, and without a
/// prior one of a million can be the most likely; twice or half as much changes few surfaces.
const SPREAD: f64 = std::f64::consts::LN_2;

/// Weighted rows whose roughness is to be chosen.
pub(super) struct RestrictedLikelihood<'a> {
    bare: Equations,
    knots: [Knots; 2],
    /// Where bends are alike along x and y, of weight 1.
    even: Roughness,
    budget: &'a Budget,
}

impl RestrictedLikelihood<'_> {
    /// Of the rows of these equations, with derivatives of this order.
    pub(super) fn new<'a>(
        equations: &Equations,
        order: RoughnessOrder,
        budget: &'a Budget,
    ) -> RestrictedLikelihood<'a> {
        let bare = equations.with_roughness(None).assembled_once();
        let knots = bare.sites.knots();
        let even = match order {
            RoughnessOrder::Second => Roughness::new(1.0, &knots, order),
            RoughnessOrder::Third => Roughness::stretched(1.0, &knots, order, 1.0),
        };
        RestrictedLikelihood { bare, knots, even, budget }
    }

    /// The lambda for which data and roughness weigh the same, by their traces.
    pub(super) fn balance(&self) -> f64 {
        let sum = |diagonal: Vec<f64>| diagonal.iter().sum::<f64>();
        sum(self.bare.normal_matrix().diagonal()) / sum(self.even.penalty.diagonal())
    }

    /// Derivative by ln lambda where bends are alike along x and y; `None` without a solution.
    pub(super) fn slope(&self, lambda: f64) -> Option<f64> {
        let (equations, solution) = self.solved(self.even.weighing(lambda))?;
        Some(by_lambda(&equations, &solution)).filter(|slope| self.is_slope(*slope))
    }

    /// Derivatives by ln lambda and by the logarithm of the aspect; `None` without a solution.
    pub(super) fn slopes(&self, lambda: f64, aspect: f64) -> Option<[f64; 2]> {
        let order = self.even.order;
        let rough = Roughness::stretched(lambda, &self.knots, order, aspect);
        let by_aspect = roughness_matrix(&self.knots, &order.slopes_by_aspect(aspect));
        let of_roughness = log_det_slope(&rough.penalty, &by_aspect)?;
        let (equations, solution) = self.solved(rough)?;
        let bent = lambda * quadratic_form(&by_aspect, &solution.coefficients);
        let of_data =
            rows_left(&equations) * share(bent, cost(&equations, &solution)) + lambda * trace(&solution, &by_aspect);
        let of_prior = 2.0 * aspect.ln() / (SPREAD * SPREAD);
        let slopes = [by_lambda(&equations, &solution), of_data - of_roughness + of_prior];
        (self.is_slope(slopes[0]) && slopes[1].is_finite()).then_some(slopes)
    }

    /// Whether a number may be the derivative by ln lambda: both of its terms lie between 0 and the rows, or the unknowns. Where lambda is lost
    /// beside the rows' own rounding, and these are no more than the unknowns, the numbers are a thousand times as large, and one of them
    /// would send the search there, where all noise is shape.
    fn is_slope(&self, by_lambda: f64) -> bool {
        by_lambda.abs() <= self.bare.count().max(self.bare.unknowns()) as f64
    }

    fn solved(&self, rough: Roughness) -> Option<(Equations, Solution)> {
        let equations = self.bare.with_roughness(Some(rough));
        let solution = linear::solve(&equations, Method::Cholesky).ok()?;
        self.budget.take(&equations, &solution);
        Some((equations, solution))
    }
}

/// Derivative of -2 l by ln lambda at a solution.
fn by_lambda(equations: &Equations, solution: &Solution) -> f64 {
    let Some(Roughness { lambda, penalty, order, .. }) = &equations.roughness else { return 0.0 };
    let used = hat_traces(equations, solution).iter().sum::<f64>() - order.null_dimension() as f64;
    rows_left(equations) * share(lambda * quadratic_form(penalty, &solution.coefficients), cost(equations, solution))
        - used
}

/// `q` at a solution.
fn cost(equations: &Equations, solution: &Solution) -> f64 {
    let c = &solution.coefficients;
    let rough = equations.roughness.as_ref().map_or(0.0, |rough| rough.lambda * quadratic_form(&rough.penalty, c));
    equations.residual_squares(c).iter().sum::<f64>() + rough
}

/// `part / whole`, and 0 where both vanish.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// `N - M`, one at least.
fn rows_left(equations: &Equations) -> f64 {
    let null = equations.roughness.as_ref().map_or(0, |rough| rough.order.null_dimension());
    (equations.count() as f64 - null as f64).max(1.0)
}

/// `trace P^+ P'`; `None` where more surfaces than those of second degree have no roughness.
fn log_det_slope(penalty: &StencilMatrix, by_aspect: &StencilMatrix) -> Option<f64> {
    let shape = penalty.shape();
    let mut held = penalty.clone();
    // the first, the middle and the last of each direction: an upper triangle of these nine tells quadrics apart
    let [first, second] = shape.basis.map(|n| [0, n / 2, n - 1]);
    for [i, j] in [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [2, 0]] {
        let row = first[i] * shape.basis[1] + second[j];
        let diagonal = held.position(row, 0, shape.degree[1]);
        held.values_mut()[diagonal] *= 2.0;
    }
    let mut factor = Cholesky::plan(shape).ok()?;
    factor.factor(&held).ok()?;
    Some(inverse_trace(&factor, by_aspect, &|_| false))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{FitOptions, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    /// ln |A| over the unknowns that are left, by elimination without exchanges: A is positive definite there.
    fn log_det(matrix: &StencilMatrix, left: &[usize]) -> f64 {
        let column = |u: usize| {
            let (mut unit, mut column) = (vec![0.0; matrix.order()], vec![0.0; matrix.order()]);
            unit[u] = 1.0;
            matrix.multiply(&unit, &mut column);
            left.iter().map(|&v| column[v]).collect()
        };
        let mut a: Vec<Vec<f64>> = left.iter().map(|&u| column(u)).collect();
        let mut sum = 0.0;
        for k in 0..a.len() {
            sum += a[k][k].ln();
            for i in k + 1..a.len() {
                let factor = a[i][k] / a[k][k];
                (k..a.len()).for_each(|j| a[i][j] -= factor * a[k][j]);
            }
        }
        sum
    }

    /// -2 l itself. The eigenvalues of P are those without the first coefficients of a triangle, up to a constant.
    fn minus_twice(likelihood: &RestrictedLikelihood, lambda: f64, aspect: f64, basis: usize) -> f64 {
        let order = likelihood.even.order;
        let rough = match order {
            RoughnessOrder::Second => likelihood.even.weighing(lambda),
            RoughnessOrder::Third => Roughness::stretched(lambda, &likelihood.knots, order, aspect),
        };
        let null = order.null_dimension();
        let in_triangle = |u: &usize| u / basis + u % basis < if null == 3 { 2 } else { 3 };
        let left: Vec<usize> = (0..basis * basis).filter(|u| !in_triangle(u)).collect();
        let of_roughness = log_det(&rough.penalty, &left) + left.len() as f64 * lambda.ln();
        let (equations, solution) = likelihood.solved(rough).unwrap();
        let all: Vec<usize> = (0..basis * basis).collect();
        rows_left(&equations) * cost(&equations, &solution).ln() + log_det(&equations.normal_matrix(), &all)
            - of_roughness
            + (aspect.ln() / SPREAD).powi(2)
    }

    #[test]
    fn the_slopes_are_those_of_the_likelihood() {
        let mut generator = Lcg::new(7);
        let mut one = || {
            let [x, y] = [0, 1].map(|_| 2.0 * generator.uniform() - 1.0);
            [x, y, (2.0 * x).sin() * y + 0.05 * generator.normal()]
        };
        let contacts = Contacts::from_points(&(0..80).map(|_| one()).collect::<Vec<[f64; 3]>>());
        for (degree, order) in [(2, RoughnessOrder::Second), (3, RoughnessOrder::Third), (4, RoughnessOrder::Third)] {
            let options = FitOptions::default().with_degree(degree).with_segments(3, 3);
            let fit = fit_contacts(&contacts, &options).unwrap();
            let budget = Budget::new(1000);
            let likelihood = RestrictedLikelihood::new(fit.equations(), order, &budget);
            let at = |ln: [f64; 2]| minus_twice(&likelihood, ln[0].exp(), ln[1].exp(), degree + 3);
            let close = |found: f64, above: f64, below: f64| {
                let expected = (above - below) / 2e-3;
                assert!((found - expected).abs() < 1e-4 * expected.abs().max(1.0), "{order:?}: {found} {expected}");
            };
            for ln in [-9.0, -4.0, 0.0] {
                let slope = likelihood.slope(f64::exp(ln)).unwrap();
                close(slope, at([ln + 1e-3, 0.0]), at([ln - 1e-3, 0.0]));
                if order == RoughnessOrder::Third {
                    for stretch in [-0.8, 0.0, 0.5] {
                        let [by_lambda, by_aspect] = likelihood.slopes(f64::exp(ln), f64::exp(stretch)).unwrap();
                        close(by_lambda, at([ln + 1e-3, stretch]), at([ln - 1e-3, stretch]));
                        close(by_aspect, at([ln, stretch + 1e-3]), at([ln, stretch - 1e-3]));
                    }
                }
            }
        }
    }
}
