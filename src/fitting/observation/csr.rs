//! The observation matrix written out in compressed sparse rows: for other programs, and to test every structured route.
//!
//! ```text
//! stacked_csr   [ N  o M  ]   row r           value at point r         unweighted, in the units of knots and points
//!               [ N' o M  ]   row g + r       slope in x
//!               [ N  o M' ]   row 2 g + r     slope in y
//! to_csr        row 3 r + k is row k of site r: weighted, in the patch frame, as the solvers see it
//! ```

use nalgebra_sparse::{CooMatrix, CsrMatrix};

use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, Sites};

/// The stacked observation matrix `E = [N o M; N' o M; N o M']` of g points: 3 g rows, n m columns.
///
/// ```text
/// E[r,       i m + j] = N_i(x_r)  M_j(y_r)         E c = [S(x_r, y_r); S_x(x_r, y_r); S_y(x_r, y_r)]
/// E[g + r,   i m + j] = N'_i(x_r) M_j(y_r)
/// E[2 g + r, i m + j] = N_i(x_r)  M'_j(y_r)
/// ```
///
/// `knots` are those in x (n basis functions) and in y (m), `points` are `[x, y]`, all in the same units, those of the
/// input for example. Rows carry no weights: multiply the rows of each block by the weights of the fit to get its least
/// squares problem. Every row stores all (p + 1)(q + 1) entries of its cell, also those that happen to be zero.
/// Outside the domain the polynomials of the end segments continue.
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::{spline::Knots, stacked_csr};
///
/// let knots = Knots::uniform(2, 3, 0.0, 1.0)?; // 5 basis functions
/// let rows = stacked_csr([&knots, &knots], &[[0.25, 0.5], [0.75, 0.5]]);
/// assert_eq!((rows.nrows(), rows.ncols(), rows.row(0).nnz()), (3 * 2, 5 * 5, 3 * 3));
/// // basis functions sum to 1, their slopes to 0
/// let sum = |row: usize| rows.row(row).values().iter().sum::<f64>();
/// assert!((sum(0) - 1.0).abs() < 1e-15 && sum(2).abs() < 1e-14);
/// # Ok::<(), palpate::spline::SplineError>(())
/// ```
pub fn stacked_csr(knots: [&Knots; 2], points: &[[f64; 2]]) -> CsrMatrix<f64> {
    let (count, columns) = (points.len(), knots[1].n_basis());
    let mut triplets = CooMatrix::new(3 * count, knots[0].n_basis() * columns);
    for (r, &[x, y]) in points.iter().enumerate() {
        let (x, y) = (knots[0].basis(x), knots[1].basis(y));
        for (block, [dx, dy]) in [[0, 0], [1, 0], [0, 1]].into_iter().enumerate() {
            for (a, along) in x.derivative(dx).iter().enumerate() {
                for (b, across) in y.derivative(dy).iter().enumerate() {
                    let column = (x.first + a) * columns + y.first + b;
                    triplets.push(block * count + r, column, along * across);
                }
            }
        }
    }
    CsrMatrix::from(&triplets)
}

/// The weighted matrix E of the solvers: row `3 r + k` is row k (value, first slope, second slope) of site r.
///
/// All (p + 1)(q + 1) entries of a site's rows are stored, also those that happen to be zero; a row whose weight is zero
/// is empty.
pub fn to_csr(sites: &impl Sites, row_weights: &RowWeights) -> CsrMatrix<f64> {
    let shape = sites.shape();
    let mut triplets = CooMatrix::new(3 * sites.len(), shape.unknowns());
    sites.visit(|site| {
        let w = row_weights.at(site.index);
        for a in 0..site.x.len() {
            for b in 0..site.y.len() {
                let column = (site.first[0] + a) * shape.basis[1] + site.first[1] + b;
                let entries = [
                    w.z * site.x[a] * site.y[b],
                    w.a * site.dx[a] * site.y[b] + w.b * site.x[a] * site.dy[b],
                    w.d * site.x[a] * site.dy[b],
                ];
                let live = [w.z != 0.0, w.a != 0.0 || w.b != 0.0, w.d != 0.0];
                for k in 0..3 {
                    if live[k] {
                        triplets.push(3 * site.index + k, column, entries[k]);
                    }
                }
            }
        }
    });
    CsrMatrix::from(&triplets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::ScatteredSites;
    use palpate_numeric::linalg::SiteWeights;

    fn product(matrix: &CsrMatrix<f64>, c: &[f64]) -> Vec<f64> {
        matrix.row_iter().map(|row| row.col_indices().iter().zip(row.values()).map(|(j, v)| v * c[*j]).sum()).collect()
    }

    fn inputs() -> ([Knots; 2], Vec<[f64; 2]>) {
        let knots = [Knots::uniform(3, 4, -20.0, 30.0).unwrap(), Knots::uniform(2, 3, 5.0, 6.5).unwrap()];
        let points =
            (0..17).map(|k| [-20.0 + 3.1 * f64::from(k), 5.0 + 1.5 * (f64::from(k) * 0.618).fract()]).collect();
        (knots, points)
    }

    /// Every row against a sum over all basis functions, one derivative at a time; one coefficient at a time.
    #[test]
    fn stacked_rows_are_values_and_slopes_of_the_spline() {
        let (knots, points) = inputs();
        let matrix = stacked_csr([&knots[0], &knots[1]], &points);
        let (n, m, g) = (knots[0].n_basis(), knots[1].n_basis(), points.len());
        assert_eq!((matrix.nrows(), matrix.ncols(), matrix.nnz()), (3 * g, n * m, 3 * g * 12));
        let entry = |knots: &Knots, at: f64, derivative: usize, i: usize| {
            let row = knots.basis(at);
            i.checked_sub(row.first).and_then(|a| row.derivative(derivative).get(a)).copied().unwrap_or(0.0)
        };
        for column in 0..n * m {
            let mut c = vec![0.0; n * m];
            c[column] = 1.0;
            let found = product(&matrix, &c);
            for (r, &[x, y]) in points.iter().enumerate() {
                for (block, [dx, dy]) in [[0, 0], [1, 0], [0, 1]].into_iter().enumerate() {
                    let expected = entry(&knots[0], x, dx, column / m) * entry(&knots[1], y, dy, column % m);
                    assert_eq!(found[block * g + r], expected, "column {column} point {r} block {block}");
                }
            }
        }
    }

    /// The slopes' rows are the derivatives of the values' row, in the units of the input.
    #[test]
    fn slope_rows_agree_with_differences_of_value_rows() {
        let (knots, points) = inputs();
        let c: Vec<f64> = (0..knots[0].n_basis() * knots[1].n_basis()).map(|k| (k as f64 * 0.7).sin()).collect();
        let at = |shift: [f64; 2]| {
            let moved: Vec<[f64; 2]> = points.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect();
            product(&stacked_csr([&knots[0], &knots[1]], &moved), &c)
        };
        let (here, g, h) = (at([0.0, 0.0]), points.len(), 1e-6);
        for (block, shift) in [(1, [h, 0.0]), (2, [0.0, h])] {
            let (after, before) = (at(shift), at(shift.map(|s| -s)));
            for r in 1..g - 1 {
                let slope = (after[r] - before[r]) / (2.0 * h);
                assert!((slope - here[block * g + r]).abs() < 1e-6, "block {block} point {r}");
            }
        }
    }

    /// With unit weights the interleaved form has the same rows in another order.
    #[test]
    fn both_forms_have_the_same_rows() {
        let (knots, points) = inputs();
        let stacked = stacked_csr([&knots[0], &knots[1]], &points);
        let sites = ScatteredSites::new(knots, points.clone());
        let weights = RowWeights::Uniform(SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 });
        let interleaved = to_csr(&sites, &weights);
        for (r, k) in (0..points.len()).flat_map(|r| (0..3).map(move |k| (r, k))) {
            let (one, other) = (stacked.row(k * points.len() + r), interleaved.row(3 * r + k));
            assert_eq!((one.col_indices(), one.values()), (other.col_indices(), other.values()));
        }
    }
}
