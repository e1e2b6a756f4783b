//! `g'A g` and `|A g|'t` for eight vectors g at once, A symmetric: a bound or a variance for every point of a map.
//!
//! `A` is n x n row by row, `t` n long, and the vectors stand side by side: entry u of all eight, then entry u + 1.

use super::lanes::Lanes;
use super::{Level, dispatch};

/// Vectors taken at once.
pub const FORMS: usize = 8;

#[inline(always)]
fn generic<V: Lanes>(matrix: &[f64], weights: &[f64], vectors: &[[f64; FORMS]]) -> [[f64; FORMS]; 2] {
    let mut out = [[0.0; FORMS]; 2];
    for lanes in (0..FORMS).step_by(V::N) {
        let (mut squares, mut sizes) = (V::splat(0.0), V::splat(0.0));
        for (u, row) in matrix.chunks_exact(weights.len()).enumerate() {
            let mut product = V::splat(0.0);
            for (a, g) in row.iter().zip(vectors) {
                product = V::splat(*a).mul_add(V::load(&g[lanes..]), product);
            }
            squares = product.mul_add(V::load(&vectors[u][lanes..]), squares);
            sizes = product.abs().mul_add(V::splat(weights[u]), sizes);
        }
        squares.store(&mut out[0][lanes..]);
        sizes.store(&mut out[1][lanes..]);
    }
    out
}

/// `[g'A g, |A g|'t]` of the eight vectors.
///
/// # Panics
/// When there are fewer vectors' entries or rows of the matrix than weights.
pub fn quadratic_forms(level: Level, matrix: &[f64], weights: &[f64], vectors: &[[f64; FORMS]]) -> [[f64; FORMS]; 2] {
    assert!(vectors.len() == weights.len() && matrix.len() == weights.len() * weights.len());
    dispatch!(level, generic [](matrix: &[f64], weights: &[f64], vectors: &[[f64; FORMS]]) -> [[f64; FORMS]; 2])
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    /// Twin: the sums as they are written.
    #[test]
    fn every_level_agrees_with_the_written_sums() {
        for n in [1, 9, 16, 23] {
            let value = |a: usize, b: usize| ((a * 7 + b * 5 + 1) as f64 * 0.41).sin();
            let matrix: Vec<f64> = (0..n * n).map(|k| value(k / n, k % n) + value(k % n, k / n)).collect();
            let weights: Vec<f64> = (0..n).map(|u| value(u, 3).abs()).collect();
            let vectors: Vec<[f64; FORMS]> = (0..n).map(|u| std::array::from_fn(|k| value(u, k + 11))).collect();
            for level in Level::available() {
                let [squares, sizes] = quadratic_forms(level, &matrix, &weights, &vectors);
                let mut twins = Twins::new("quadratic_forms", level);
                for k in 0..FORMS {
                    let product = |u: usize| (0..n).map(|v| matrix[u * n + v] * vectors[v][k]).sum::<f64>();
                    let square: f64 = (0..n).map(|u| vectors[u][k] * product(u)).sum();
                    let size: f64 = (0..n).map(|u| product(u).abs() * weights[u]).sum();
                    twins.compare(squares[k], square);
                    twins.compare(sizes[k], size);
                }
                twins.hold(64.0);
            }
        }
    }
}
