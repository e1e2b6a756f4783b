//! The largest value of a function of one number.
//!
//! ```text
//! parabola through the three best places; the golden section where its vertex is no better guess
//! ```
//!
//! R. Brent, *Algorithms for Minimization without Derivatives*, 1973, chapter 5.

/// Golden section of an interval's longer part.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// Where a function with one peak in `[lo, hi]` is largest, to within `tolerance`, and its value there; `start` is a guess. At most
/// `most` values are asked for; one that is not a number counts as the least.
///
/// ```
/// use palpate_numeric::brent::maximum;
///
/// let (at, value) = maximum([-4.0, 4.0], 0.0, 1e-6, 50, |x| 2.0 - (x - 1.3).powi(2));
/// assert!((at - 1.3).abs() < 1e-5 && (value - 2.0).abs() < 1e-9);
/// ```
pub fn maximum(
    [mut lo, mut hi]: [f64; 2],
    start: f64,
    tolerance: f64,
    most: usize,
    value: impl Fn(f64) -> f64,
) -> (f64, f64) {
    let at = |x: f64| Some(value(x)).filter(|v| !v.is_nan()).unwrap_or(f64::NEG_INFINITY);
    let first = start.clamp(lo, hi);
    // best, second and third place with their values
    let mut best = (first, at(first));
    let (mut second, mut third) = (best, best);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 1..most {
        let middle = 0.5 * (lo + hi);
        if (best.0 - middle).abs() <= 2.0 * tolerance - 0.5 * (hi - lo) {
            break;
        }
        let vertex = vertex(best, second, third).filter(|to| {
            *to - lo > tolerance
                && hi - *to > tolerance
                && (to - best.0).abs() < 0.5 * before.abs()
                && before.abs() > tolerance
        });
        let longer = if best.0 < middle { hi - best.0 } else { lo - best.0 };
        (before, step) = match vertex {
            Some(to) => (step, to - best.0),
            None => (longer, GOLDEN * longer),
        };
        let place = best.0 + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let here = (place, at(place));
        if here.1 >= best.1 {
            if place < best.0 {
                hi = best.0
            } else {
                lo = best.0
            }
            (third, second, best) = (second, best, here);
            continue;
        }
        if place < best.0 {
            lo = place
        } else {
            hi = place
        }
        if here.1 >= second.1 || second.0 == best.0 {
            (third, second) = (second, here);
        } else if here.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
            third = here;
        }
    }
    best
}

/// Vertex of the parabola through three places, where it has one.
fn vertex(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let (of_b, of_c) = ((a.0 - b.0) * (a.1 - c.1), (a.0 - c.0) * (a.1 - b.1));
    let below = 2.0 * (of_b - of_c);
    let to = a.0 - ((a.0 - b.0) * of_b - (a.0 - c.0) * of_c) / below;
    (below != 0.0 && to.is_finite()).then_some(to)
}

#[cfg(test)]
mod tests {
    use super::maximum;
    use std::cell::Cell;

    #[test]
    fn peaks_are_found_in_few_values() {
        for (peak, start) in [(0.3, 0.0), (-3.9, 3.0), (2.0, 2.0), (3.999, -1.0)] {
            let count = Cell::new(0);
            let value = |x: f64| {
                count.set(count.get() + 1);
                -(x - peak).cosh()
            };
            let (at, _) = maximum([-4.0, 4.0], start, 1e-3, 60, value);
            assert!((at - peak).abs() < 3e-3, "{peak} from {start}: {at}");
            assert!(count.get() <= 20, "{peak} from {start}: {}", count.get());
        }
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        let value = |x: f64| if x < 0.0 { f64::NAN } else { -(x - 0.5).powi(2) };
        let (at, _) = maximum([-4.0, 4.0], -1.0, 1e-3, 60, value);
        assert!((at - 0.5).abs() < 5e-3, "{at}");
    }
}
