//! Convex hull of points in the plane: A. M. Andrew's monotone chain, *Inf. Process. Lett.* 9 (1979) 216.
//!
//! ```text
//! lower and upper chain of the points sorted by x; a corner is left out where the next point is not to its left
//! ```

/// Twice the area of a triangle, positive to the left.
pub fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Corners of the convex hull, anticlockwise; none where all points are one.
pub fn convex_hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = near_the_outline(points);
    sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = chain(&mut sorted.iter().copied());
    lower.extend(chain(&mut sorted.iter().rev().copied()));
    lower
}

/// The points without those well inside the octagon of the farthest points in eight directions, which no hull has as
/// corners (S. G. Akl and G. T. Toussaint, *Inf. Process. Lett.* 7 (1978) 219).
fn near_the_outline(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    /// Share of the octagon's area by which a point has to be inside each side.
    const WELL: f64 = 1e-9;
    const DIRECTIONS: [[f64; 2]; 8] =
        [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];
    let Some(&first) = points.first() else { return Vec::new() };
    let mut corners = [first; 8];
    let mut farthest = [f64::NEG_INFINITY; 8];
    for p in points {
        for (k, d) in DIRECTIONS.iter().enumerate() {
            let along = d[0] * p[0] + d[1] * p[1];
            if along > farthest[k] {
                (farthest[k], corners[k]) = (along, *p);
            }
        }
    }
    let size = (farthest[0] + farthest[4]).abs() * (farthest[2] + farthest[6]).abs();
    let is_well_inside = |p: &[f64; 2]| {
        (0..8).all(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 8]);
            a == b || turn(a, b, *p) > WELL * size
        })
    };
    points.iter().filter(|p| !is_well_inside(p)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_keeps_corners() {
        let lattice: Vec<[f64; 2]> = (0..25).map(|i| [(i % 5) as f64, (i / 5) as f64]).collect();
        assert_eq!(convex_hull(&lattice), [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        let twice: Vec<[f64; 2]> = lattice.iter().chain(&lattice).copied().collect();
        assert_eq!(convex_hull(&twice), convex_hull(&lattice));
        assert_eq!((convex_hull(&[]), convex_hull(&[[1.0, 2.0]])), (vec![], vec![]));
        assert_eq!(turn([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]), 1.0);
    }

    /// The rightmost corner stands also where it comes directly after the last one of the lower chain in the order of x, as
    /// at an end where many points share one x.
    #[test]
    fn no_point_lies_outside() {
        let wave = |k: usize, step: f64| 0.5 + 0.5 * (step * k as f64).sin();
        for most in [0.8, 1.0] {
            for first in 0..200 {
                let points: Vec<[f64; 2]> =
                    (first..first + 20).map(|k| [wave(k, 1.7).min(most), wave(k, 2.9)]).collect();
                let hull = convex_hull(&points);
                let side = |i: usize, p: [f64; 2]| turn(hull[i], hull[(i + 1) % hull.len()], p);
                assert!(points.iter().all(|p| (0..hull.len()).all(|i| side(i, *p) > -1e-12)), "{most} {first}");
            }
        }
    }
}
