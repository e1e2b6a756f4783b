//! Which points no other point beats.
//!
//! ```text
//! a beats b   when a's cost and error are both certainly no worse, and one of them certainly better:
//!             cost_hi(a) <= cost_lo(b)  and  error_hi(a) <= error_lo(b)       (one of them strictly)
//! ```
//!
//! Points whose intervals overlap are not ranked, so that a second run does not turn the order round. Instructions are the
//! same in every run; their intervals are points.

use super::point::Point;

/// Ends of an interval.
type Ends = [f64; 2];

fn beats(a: [Ends; 2], b: [Ends; 2]) -> bool {
    let no_worse = a.iter().zip(&b).all(|(a, b)| a[1] <= b[0]);
    no_worse && a.iter().zip(&b).any(|(a, b)| a[1] < b[0])
}

/// Which of the points, each an interval of cost and one of error, no other beats; `None` has no place.
fn unbeaten(points: &[Option<[Ends; 2]>]) -> Vec<bool> {
    let stands =
        |point: &Option<[Ends; 2]>| point.is_some_and(|own| !points.iter().flatten().any(|other| beats(*other, own)));
    points.iter().map(stands).collect()
}

/// Marks the points of one frontier that no other point beats, by time and by instructions.
pub(super) fn mark(points: &mut [&mut Point]) {
    let error = |point: &Point| point.error_interval.filter(|_| point.failed.is_none());
    let by_time: Vec<Option<[Ends; 2]>> =
        points.iter().map(|point| Some([[point.seconds?.lo, point.seconds?.hi], error(point)?])).collect();
    let by_count: Vec<Option<[Ends; 2]>> =
        points.iter().map(|point| Some([[point.instructions? as f64; 2], error(point)?])).collect();
    for (point, (time, count)) in points.iter_mut().zip(unbeaten(&by_time).into_iter().zip(unbeaten(&by_count))) {
        (point.on_frontier, point.on_instructions_frontier) = (time, count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_points_are_not_ranked() {
        let at = |cost: Ends, error: Ends| Some([cost, error]);
        let points = [
            at([1.0, 2.0], [1.0, 1.0]),
            // slower and worse
            at([3.0, 4.0], [2.0, 2.0]),
            // its time overlaps the first's
            at([1.5, 2.5], [2.0, 2.0]),
            // as exact and slower
            at([5.0, 6.0], [1.0, 1.0]),
            None,
        ];
        assert_eq!(unbeaten(&points), [true, false, true, false, false]);
        // the same point twice stays twice
        assert_eq!(unbeaten(&[points[0], points[0]]), [true, true]);
    }
}
