//! Where a function is lowest, by its slopes.
//!
//! ```text
//! along one line   the lowest of its values at the decades, by the trapezoidal rule, then halves of the bracket beside it
//! over a plane     Newton's steps, the matrix of second derivatives by differences of the slopes and made positive
//! ```

use crate::fit::objective::budget::Budget;
use palpate_numeric::linalg::small;

/// The search covers this many decades below and above the ratio of traces, where data and roughness weigh the same.
const DECADES: [i32; 2] = [-14, 6];
/// Halvings of the bracket around the minimum: 20 leave 1e-6 of a decade.
const HALVINGS: usize = 20;
/// Newton's steps at most: of 200 random surfaces most take 4 and the worst 14.
const STEPS: usize = 25;
/// Halvings of a step at most; after 8 it is rounding that the slopes disagree by.
const SHORTENINGS: usize = 8;
/// Difference for second derivatives: its square is their relative error.
const DIFFERENCE: f64 = 0.02;
/// Steps at most as long as this, nearly a decade: farther away second derivatives are others.
const LONGEST: f64 = 2.0;
/// Second derivatives of twice a log likelihood below this tell nothing: one over it would be a standard deviation of ten e-folds.
const LEAST_CURVATURE: f64 = 0.01;
/// Steps shorter than this are below the digits that are kept of what was found.
const SHORT: f64 = 1e-5;

/// A place, and whether the function rises on both sides of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lowest {
    pub at: f64,
    pub is_bracketed: bool,
}

/// Where a function of decades with this slope is lowest. Places without a slope are left out; where the budget is spent, the middle of
/// what is left.
pub(super) fn lowest_along(slope: impl Fn(f64) -> Option<f64>, budget: &Budget) -> Lowest {
    let [first, last] = DECADES;
    let known: Vec<(f64, f64)> = (first..=last).filter_map(|e| Some((f64::from(e), slope(f64::from(e))?))).collect();
    let (mut value, mut best) = (0.0, (f64::INFINITY, 0));
    for (k, (at, now)) in known.iter().enumerate() {
        let before = known[k.saturating_sub(1)];
        value += 0.5 * (now + before.1) * (at - before.0);
        if value < best.0 {
            best = (value, k);
        }
    }
    let at_end = |at: f64| Lowest { at, is_bracketed: false };
    let Some(&(middle, at_middle)) = known.get(best.1) else { return at_end(f64::from(last)) };
    let beside = if at_middle < 0.0 { known.get(best.1 + 1) } else { best.1.checked_sub(1).and_then(|k| known.get(k)) };
    let Some(&(other, at_other)) = beside.filter(|(_, other)| other * at_middle < 0.0) else { return at_end(middle) };
    let bracket = if at_middle < at_other { [middle, other] } else { [other, middle] };
    Lowest { at: halved(bracket, slope, budget), is_bracketed: true }
}

/// Where the slope turns from falling to rising.
fn halved([mut falling, mut rising]: [f64; 2], slope: impl Fn(f64) -> Option<f64>, budget: &Budget) -> f64 {
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

/// Where a function of two variables with these slopes is lowest, from a place nearby; where the budget is spent or there are no slopes,
/// the last place.
pub(super) fn lowest_from(start: [f64; 2], slopes: impl Fn([f64; 2]) -> Option<[f64; 2]>, budget: &Budget) -> [f64; 2] {
    let mut at = start;
    let Some(mut here) = slopes(at) else { return at };
    for _ in 0..STEPS {
        let Some(step) = newton_step(at, here, &slopes) else { return at };
        if length(step) < SHORT {
            break;
        }
        match shortened(at, step, here, &slopes) {
            _ if budget.is_spent() => break,
            Some((next, there)) => (at, here) = (next, there),
            None => break,
        }
    }
    at
}

/// Newton's step with the magnitudes of the second derivatives, so that it leads down.
fn newton_step(at: [f64; 2], here: [f64; 2], slopes: impl Fn([f64; 2]) -> Option<[f64; 2]>) -> Option<[f64; 2]> {
    let beside = [slopes([at[0] + DIFFERENCE, at[1]])?, slopes([at[0], at[1] + DIFFERENCE])?];
    let by = |i: usize, j: usize| (beside[i][j] - here[j]) / DIFFERENCE;
    let mixed = 0.5 * (by(0, 1) + by(1, 0));
    let (values, vectors) = small::eigen(&[[by(0, 0), mixed], [mixed, by(1, 1)]]);
    let mut step = [0.0; 2];
    for (value, vector) in values.iter().zip(&vectors) {
        let share = (vector[0] * here[0] + vector[1] * here[1]) / value.abs().max(LEAST_CURVATURE);
        step = [0, 1].map(|k| step[k] - share * vector[k]);
    }
    let cut = (LONGEST / length(step)).min(1.0);
    Some(step.map(|s| s * cut))
}

/// The place after a step, or after half of it and so on, at which the function does not rise again along it by half of what it fell, and
/// the slopes there.
fn shortened(
    at: [f64; 2],
    mut step: [f64; 2],
    here: [f64; 2],
    slopes: impl Fn([f64; 2]) -> Option<[f64; 2]>,
) -> Option<([f64; 2], [f64; 2])> {
    let along = |slopes: [f64; 2], step: [f64; 2]| slopes[0] * step[0] + slopes[1] * step[1];
    for _ in 0..=SHORTENINGS {
        let next = [at[0] + step[0], at[1] + step[1]];
        match slopes(next) {
            Some(there) if along(there, step) <= 0.5 * along(here, step).abs() => return Some((next, there)),
            _ => step = step.map(|s| 0.5 * s),
        }
    }
    None
}

/// The larger of two moves.
fn length(step: [f64; 2]) -> f64 {
    step[0].abs().max(step[1].abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curved valley of `(y - x^2)^2 + (x - 1)^2 / 2`, from its other end.
    #[test]
    fn a_curved_valley_is_followed_to_its_lowest_place() {
        let slopes = |[x, y]: [f64; 2]| {
            let off = y - x * x;
            Some([-4.0 * x * off + x - 1.0, 2.0 * off])
        };
        let found = lowest_from([-1.5, 2.0], slopes, &Budget::new(1));
        assert!((found[0] - 1.0).abs() < 1e-4 && (found[1] - 1.0).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn without_slopes_the_start_stays() {
        assert_eq!(lowest_from([3.0, 4.0], |_| None, &Budget::new(1)), [3.0, 4.0]);
        let falling = lowest_along(|_| Some(-1.0), &Budget::new(1));
        assert!(falling.at == f64::from(DECADES[1]) && !falling.is_bracketed);
    }
}
