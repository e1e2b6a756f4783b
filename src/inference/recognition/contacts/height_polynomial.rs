//! What a polynomial in x and y leaves of heights: a plane has three terms, a height quadric six.

use palpate_numeric::linalg::small::solve_leading;
use palpate_numeric::vector::Vector;

/// Share of the diagonal that keeps the equations solvable; a second round takes out what it leaves.
const RIDGE: f64 = 1e-9;

/// Residuals of the heights, of places within about 1 of the origin, fitted so many times one after the other. `None` where the places do
/// not tell the terms.
pub(super) fn left_by_polynomial(points: &[Vector], terms: usize, rounds: usize) -> Option<Vec<f64>> {
    let row = |[x, y, _]: Vector| [1.0, x, y, x * x, x * y, y * y];
    let mut normal = [[0.0; 6]; 6];
    for row in points.iter().map(|p| row(*p)) {
        (0..terms).for_each(|i| (0..=i).for_each(|j| normal[i][j] += row[i] * row[j]));
    }
    (0..terms).for_each(|i| normal[i][i] *= 1.0 + RIDGE);
    let mut left: Vec<f64> = points.iter().map(|p| p[2]).collect();
    for _ in 0..rounds {
        let mut right = [0.0; 6];
        points.iter().zip(&left).for_each(|(p, d)| (0..terms).for_each(|i| right[i] += row(*p)[i] * d));
        let by = solve_leading(normal, right, terms)?;
        let at = |p: &Vector| (0..terms).map(|i| by[i] * row(*p)[i]).sum::<f64>();
        points.iter().zip(&mut left).for_each(|(p, d)| *d -= at(p));
    }
    Some(left)
}
