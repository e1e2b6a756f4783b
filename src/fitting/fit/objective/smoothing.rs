//! `--smooth auto`: lambda by restricted maximum likelihood over the weighted rows.
//!
//! ```text
//! -2 l(lambda) = (N - M) ln(|b - E c|^2 + lambda c'Pc) + ln |E'E + lambda P| - (n - M) ln lambda
//! its derivative by ln lambda = (N - M) lambda c'Pc / (|b - E c|^2 + lambda c'Pc) - (trace H - M)
//! N rows, n unknowns, M of them free of roughness,   H = E (E'E + lambda P)^-1 E'
//! ```
//!
//! S. Wood, *J. R. Statist. Soc. B* 73 (2011) 3. The surface is a draw of a process whose roughness is what it is told by; with as many
//! unknowns as rows, where cross-validation often takes noise for shape, its minimum stays where it is. Rows are taken for independent;
//! correlated errors (normals from overlapping neighbourhoods) make lambda too small. Third derivatives are penalised where the spline
//! has some, so that curvatures cost nothing: these are what is asked.

use crate::fit::linear;
use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::traces::hat_traces;
use crate::fit::notes::Note;
use crate::fit::objective::PlainFit;
use crate::fit::objective::budget::Budget;
use crate::fit::objective::fitted::Fitted;
use crate::fit::objective::robust::fit_with_loss;
use crate::fit::placing::Patch;
use crate::fit::{FitError, FitOptions, Method, Smooth};
use crate::observation::{Data, Roughness, RoughnessOrder};

/// The search covers this many decades below and above the ratio of traces, where data and roughness weigh the same.
const DECADES: [i32; 2] = [-14, 6];
/// Halvings of the bracket around the minimum: 20 leave 1e-6 of a decade.
const HALVINGS: usize = 20;

/// Chooses lambda and fits with it.
///
/// # Errors
/// Those of a fit with a given lambda.
pub(super) fn fit_smoothed(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    (plain, budget): (PlainFit, &Budget),
) -> Result<Fitted, FitError> {
    let order = RoughnessOrder::of_degrees(options.degree);
    let smooth = |lambda: f64| match order {
        RoughnessOrder::Second => Smooth::Lambda(lambda),
        RoughnessOrder::Third => Smooth::Third(lambda),
    };
    let with = |lambda: f64| FitOptions { smooth: smooth(lambda), ..options.clone() };
    // noise sds and linearisation come from a fit with so little smoothing that it only makes the rank full
    let start = fit_with_loss(patch, data, &with(1e-9), (plain, budget))?;
    let Some(rough) = start.equations.roughness.clone() else { return Ok(start) };
    let bare = start.equations.with_roughness(None);
    let sum = |diagonal: Vec<f64>| diagonal.iter().sum::<f64>();
    let balance = sum(bare.normal_matrix().diagonal()) / sum(rough.penalty.diagonal());
    let slope = |exponent: f64| -> Option<f64> {
        let lambda = balance * 10_f64.powf(exponent);
        let equations = bare.with_roughness(Some(rough.weighing(lambda)));
        let solution = linear::solve(&equations, Method::Cholesky).ok()?;
        budget.take(&equations, &solution);
        Some(slope_of(&equations, &solution)).filter(|slope| slope.is_finite())
    };
    let lambda = balance * 10_f64.powf(lowest(DECADES, slope, budget));
    let mut fitted = fit_with_loss(patch, data, &with(lambda), (plain, budget))?;
    fitted.notes.push(Note::Smoothed { lambda, third: order == RoughnessOrder::Third });
    Ok(fitted)
}

/// Derivative of -2 l by ln lambda at a solution.
fn slope_of(equations: &Equations, solution: &Solution) -> f64 {
    let Some(Roughness { lambda, penalty, order }) = &equations.roughness else { return 0.0 };
    let c = &solution.coefficients;
    let mut bent = vec![0.0; c.len()];
    penalty.multiply(c, &mut bent);
    let rough = lambda * c.iter().zip(&bent).map(|(c, b)| c * b).sum::<f64>();
    let squares: f64 = equations.residual_squares(c).iter().sum();
    let null = order.null_dimension() as f64;
    let used = hat_traces(equations, solution).iter().sum::<f64>() - null;
    let share = if squares + rough > 0.0 { rough / (squares + rough) } else { 0.0 };
    (equations.count() as f64 - null).max(1.0) * share - used
}

/// Where a function with this slope is lowest: the lowest of its values at the decades, by the trapezoidal rule, and from there where the
/// slope turns from falling to rising. Places without a slope are left out; where the budget is spent, the middle of what is left.
fn lowest([first, last]: [i32; 2], slope: impl Fn(f64) -> Option<f64>, budget: &Budget) -> f64 {
    let known: Vec<(f64, f64)> = (first..=last).filter_map(|e| Some((f64::from(e), slope(f64::from(e))?))).collect();
    let (mut value, mut best) = (0.0, (f64::INFINITY, 0));
    for (k, (at, now)) in known.iter().enumerate() {
        let before = known[k.saturating_sub(1)];
        value += 0.5 * (now + before.1) * (at - before.0);
        if value < best.0 {
            best = (value, k);
        }
    }
    let Some(&(middle, at_middle)) = known.get(best.1) else { return f64::from(last) };
    let beside = if at_middle < 0.0 { known.get(best.1 + 1) } else { best.1.checked_sub(1).and_then(|k| known.get(k)) };
    let Some(&(other, at_other)) = beside.filter(|(_, other)| other * at_middle < 0.0) else { return middle };
    let (mut falling, mut rising) = if at_middle < at_other { (middle, other) } else { (other, middle) };
    for _ in 0..HALVINGS {
        let half = 0.5 * (falling + rising);
        match slope(half) {
            _ if budget.is_spent() => break,
            Some(slope) if slope < 0.0 => falling = half,
            Some(_) => rising = half,
            None => break,
        }
    }
    0.5 * (falling + rising)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fit_contacts;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    fn touched(count: usize, noise: f64, at: impl Fn(f64, f64) -> f64) -> Contacts {
        let mut generator = Lcg::new(7);
        let mut one = || {
            let [x, y] = [0, 1].map(|_| 2.0 * generator.uniform() - 1.0);
            [x, y, at(x, y) + noise * generator.normal()]
        };
        Contacts::from_points(&(0..count).map(|_| one()).collect::<Vec<[f64; 3]>>())
    }

    /// ln |A| by elimination without exchanges: A is positive definite.
    fn log_det(equations: &Equations) -> f64 {
        let matrix = equations.normal_matrix();
        let n = matrix.order();
        let column = |u: usize| {
            let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
            unit[u] = 1.0;
            matrix.multiply(&unit, &mut column);
            column
        };
        let mut a: Vec<Vec<f64>> = (0..n).map(column).collect();
        let mut sum = 0.0;
        for k in 0..n {
            sum += a[k][k].ln();
            for i in k + 1..n {
                let factor = a[i][k] / a[k][k];
                (k..n).for_each(|j| a[i][j] -= factor * a[k][j]);
            }
        }
        sum
    }

    #[test]
    fn the_slope_is_that_of_the_likelihood() {
        let contacts = touched(80, 0.05, |x, y| (2.0 * x).sin() * y);
        for (degree, order) in [(3, RoughnessOrder::Third), (2, RoughnessOrder::Second)] {
            let options = FitOptions::default().with_degree(degree).with_segments(3, 3);
            let bare = fit_contacts(&contacts, &options).unwrap().equations().clone();
            let rough = Roughness::new(1.0, &bare.sites.knots(), order);
            let solved = |lambda: f64| {
                let equations = bare.with_roughness(Some(rough.weighing(lambda)));
                let solution = linear::solve(&equations, Method::Cholesky).unwrap();
                (equations, solution)
            };
            let minus_twice = |ln: f64| {
                let (equations, solution) = solved(ln.exp());
                let c = &solution.coefficients;
                let mut bent = vec![0.0; c.len()];
                rough.penalty.multiply(c, &mut bent);
                let rough = ln.exp() * c.iter().zip(&bent).map(|(c, b)| c * b).sum::<f64>();
                let squares: f64 = equations.residual_squares(c).iter().sum();
                let null = order.null_dimension() as f64;
                (equations.count() as f64 - null) * (squares + rough).ln() + log_det(&equations)
                    - (c.len() as f64 - null) * ln
            };
            for ln in [-9.0, -4.0, 0.0] {
                let (equations, solution) = solved(f64::exp(ln));
                let expected = (minus_twice(ln + 1e-3) - minus_twice(ln - 1e-3)) / 2e-3;
                let found = slope_of(&equations, &solution);
                assert!(
                    (found - expected).abs() < 1e-4 * expected.abs().max(1.0),
                    "{order:?} {ln}: {found} {expected}"
                );
            }
        }
    }

    /// With as many unknowns as rows: the curvatures of a cap are kept, and its noise is none of its shape.
    #[test]
    fn curvatures_cost_nothing_and_noise_is_no_shape() {
        let contacts = touched(64, 0.02, |x, y| -0.5 * (x * x + y * y));
        let options = FitOptions::default().with_degree(3).with_segments(5, 5).with_smooth(Smooth::Auto);
        let fit = fit_contacts(&contacts, &options).unwrap();
        let surface = fit.input_surface().unwrap();
        for (x, y) in [(0.0, 0.0), (0.5, -0.4), (-0.6, 0.3)] {
            let here = surface.at(x, y);
            assert!((here.zxx + 1.0).abs() < 0.2 && (here.zyy + 1.0).abs() < 0.2, "{here:?}");
        }
    }

    #[test]
    fn what_is_chosen_is_fitted_again_by_its_name() {
        let contacts = touched(150, 0.05, |x, y| (3.0 * x).sin() * y);
        let options = FitOptions::default().with_degree(3).with_segments(6, 6);
        let chosen = fit_contacts(&contacts, &options.clone().with_smooth(Smooth::Auto)).unwrap();
        let named: Smooth = format!("third={}", chosen.smoothing()).parse().unwrap();
        let again = fit_contacts(&contacts, &options.with_smooth(named)).unwrap();
        assert_eq!(chosen.solution().coefficients, again.solution().coefficients);
    }
}
