//! Where the contacts of every cell lie in the chart: a cell holds means over its contacts, and a displacement bends within a cell.
//!
//! ```text
//! mean f      = f + (uu f_uu + 2 uv f_uv + vv f_vv)/2              at the mean place; uu, uv, vv: mean squares about it
//! mean f_u    = f_u + (uu f_uuu + 2 uv f_uuv + vv f_uvv)/2         f_v alike
//! mean slope  = du mean f_u + dv mean f_v                          du, dv: steps of the chart along a tangent
//! ```
//!
//! Slopes at the mean place are too steep where a body is wavy: of 2,000 precise contacts on a wave, 0.07 degrees, which is half of what the
//! mean normal of a cell scatters by, and alike in all of them.

use faer::Mat;

use crate::recognition::contacts::Cells;
use crate::recognition::kinds::ConstantCurvature;
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg;
use palpate_numeric::vector::along;

use super::basis::{WIDTH, ends};

/// Values of a basis function and its first three derivatives.
const ORDERS: usize = 4;

/// Step along a tangent that shows the steps of the chart.
const STEP_OF_CHART: f64 = 1e-4;

/// Mean places and spreads of the cells' contacts.
pub(super) struct CellCharts {
    /// Mean places.
    pub(super) places: Vec<[f64; 2]>,
    /// Mean squares and products about them: uu, uv, vv.
    pub(super) spreads: Vec<[f64; 3]>,
    /// Steps of both chart coordinates along both tangents of every cell, one tangent after the other.
    steps: Vec<[f64; 2]>,
}

impl CellCharts {
    /// Of the chart positions of all contacts.
    pub(super) fn new(surface: &ConstantCurvature, charts: &[[f64; 2]], cells: &Cells) -> CellCharts {
        let count = cells.points.len();
        let (mut counts, mut places, mut spreads) = (vec![0.0; count], vec![[0.0; 2]; count], vec![[0.0; 3]; count]);
        for (&cell, chart) in cells.of.iter().zip(charts) {
            counts[cell] += 1.0;
            (0..2).for_each(|k| places[cell][k] += chart[k]);
        }
        places.iter_mut().zip(&counts).for_each(|(place, n)| place.iter_mut().for_each(|v| *v /= n));
        for (&cell, chart) in cells.of.iter().zip(charts) {
            let [u, v] = [0, 1].map(|k| chart[k] - places[cell][k]);
            spreads[cell].iter_mut().zip([u * u, u * v, v * v]).for_each(|(sum, product)| *sum += product);
        }
        spreads.iter_mut().zip(&counts).for_each(|(spread, n)| spread.iter_mut().for_each(|v| *v /= n));
        let steps = if cells.normals.is_some() { steps(surface, cells) } else { Vec::new() };
        CellCharts { places, spreads, steps }
    }

    /// Mean slopes along both tangents of every cell, one tangent after the other, for every column of spline coefficients.
    pub(super) fn slopes(&self, knots: &[Knots; 2], columns: &Mat<f64>) -> Mat<f64> {
        let [by_u, by_v] = [[1, 0], [0, 1]].map(|orders| self.derivatives(knots, columns, orders));
        let n = self.places.len();
        Mat::from_fn(self.steps.len(), columns.ncols(), |row, j| {
            let [du, dv] = self.steps[row];
            du * by_u[(row % n, j)] + dv * by_v[(row % n, j)]
        })
    }

    /// Means over the contacts of every cell of one derivative, of these orders in u and v, for every column.
    fn derivatives(&self, knots: &[Knots; 2], columns: &Mat<f64>, [by_u, by_v]: [usize; 2]) -> Mat<f64> {
        let across = knots[1].n_basis();
        let mut basis = Mat::<f64>::zeros(self.places.len(), columns.nrows());
        for (i, (place, [uu, uv, vv])) in self.places.iter().zip(&self.spreads).enumerate() {
            let mut first = [0; 2];
            let values: [[f64; ORDERS * WIDTH]; 2] = std::array::from_fn(|side| {
                let [lo, hi] = ends(&knots[side]);
                let mut flat = [0.0; ORDERS * WIDTH];
                first[side] = knots[side].derivatives(place[side].clamp(lo, hi), ORDERS - 1, &mut flat);
                flat
            });
            for (a, b) in (0..WIDTH).flat_map(|a| (0..WIDTH).map(move |b| (a, b))) {
                let of = |u: usize, v: usize| values[0][(by_u + u) * WIDTH + a] * values[1][(by_v + v) * WIDTH + b];
                let mean = of(0, 0) + 0.5 * (uu * of(2, 0) + vv * of(0, 2)) + uv * of(1, 1);
                basis[(i, (first[0] + a) * across + first[1] + b)] = mean;
            }
        }
        linalg::product(basis.as_ref(), columns.as_ref())
    }

    /// Rows of u^2/2, v^2/2 and u v at the cells, which enter the distances with a minus.
    pub(super) fn quadratic(&self) -> Mat<f64> {
        Mat::from_fn(self.places.len(), 3, |i, j| {
            let ([u, v], [uu, uv, vv]) = (self.places[i], self.spreads[i]);
            -[0.5 * (u * u + uu), 0.5 * (v * v + vv), u * v + uv][j]
        })
    }

    /// Mean slopes of u^2/2, v^2/2 and u v along both tangents of every cell: slopes of second degree are those at the mean place.
    pub(super) fn quadratic_slopes(&self) -> Mat<f64> {
        let n = self.places.len();
        Mat::from_fn(self.steps.len(), 3, |row, j| {
            let ([du, dv], [u, v]) = (self.steps[row], self.places[row % n]);
            [u * du, v * dv, u * dv + v * du][j]
        })
    }
}

fn steps(surface: &ConstantCurvature, cells: &Cells) -> Vec<[f64; 2]> {
    let along_chart = |(side, i): (usize, usize)| {
        let (p, tangent) = (cells.points[i], cells.tangents[side][i]);
        let ahead = surface.chart(along(p, STEP_OF_CHART, tangent));
        let behind = surface.chart(along(p, -STEP_OF_CHART, tangent));
        [0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * STEP_OF_CHART))
    };
    let n = cells.points.len();
    (0..2).flat_map(|side| (0..n).map(move |i| (side, i))).map(along_chart).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::discrepancy::polynomial_prior;

    const KNOTS: f64 = 1.5;

    fn surface() -> ConstantCurvature {
        ConstantCurvature::new([0.0, 0.1, -0.2, 0.4, -0.3, 0.3])
    }

    /// Three cells of four contacts each.
    fn charts() -> Vec<[f64; 2]> {
        (0..12).map(|i| [(1.7 * i as f64).sin(), (0.9 * i as f64).cos()]).collect()
    }

    fn means() -> CellCharts {
        let of: Vec<usize> = (0..12).map(|i| i / 4).collect();
        let charts = charts();
        let (mut places, mut spreads) = (vec![[0.0; 2]; 3], vec![[0.0; 3]; 3]);
        for (&cell, chart) in of.iter().zip(&charts) {
            (0..2).for_each(|k| places[cell][k] += chart[k] / 4.0);
        }
        for (&cell, chart) in of.iter().zip(&charts) {
            let [u, v] = [0, 1].map(|k| chart[k] - places[cell][k]);
            spreads[cell].iter_mut().zip([u * u, u * v, v * v]).for_each(|(sum, p)| *sum += p / 4.0);
        }
        let steps = (0..6).map(|i| [0.3 + i as f64, 1.0 - 0.2 * i as f64]).collect();
        CellCharts { places, spreads, steps }
    }

    /// Of a displacement of third degree the mean slopes over the contacts are exact.
    #[test]
    fn slopes_of_cells_are_means_over_their_contacts() {
        let knots = [0, 1].map(|_| Knots::uniform(WIDTH - 1, 5, -KNOTS, KNOTS).unwrap());
        let columns = polynomial_prior::columns(&knots, &surface(), 2.0);
        let (means, charts) = (means(), charts());
        let found = means.slopes(&knots, &columns);
        let size = |j: usize| 2.0 * polynomial_prior::size(&surface(), polynomial_prior::TERMS[j]);
        for (row, [du, dv]) in means.steps.iter().enumerate() {
            for j in 0..4 {
                let [a, b] = polynomial_prior::TERMS[j].map(|n| n as i32);
                let power = |t: f64, n: i32| if n == 0 { 0.0 } else { n as f64 * t.powi(n - 1) };
                let slope = |[u, v]: [f64; 2]| du * power(u, a) * v.powi(b) + dv * u.powi(a) * power(v, b);
                let cell = row % 3;
                let expected: f64 = charts[4 * cell..4 * cell + 4].iter().map(|c| size(j) * slope(*c) / 4.0).sum();
                assert!((found[(row, j)] - expected).abs() < 1e-12, "{row} {j}: {} {expected}", found[(row, j)]);
            }
        }
    }

    #[test]
    fn quadratic_displacements_have_their_means_and_slopes() {
        let (means, charts) = (means(), charts());
        let (rows, slopes) = (means.quadratic(), means.quadratic_slopes());
        let of = |[u, v]: [f64; 2]| [0.5 * u * u, 0.5 * v * v, u * v];
        for (row, [du, dv]) in means.steps.iter().enumerate() {
            let own = &charts[4 * (row % 3)..4 * (row % 3) + 4];
            let mean = |of: &dyn Fn(&[f64; 2]) -> f64| own.iter().map(of).sum::<f64>() / 4.0;
            for j in 0..3 {
                assert!((rows[(row % 3, j)] + mean(&|c| of(*c)[j])).abs() < 1e-15);
                let slope = mean(&|[u, v]| [u * du, v * dv, u * dv + v * du][j]);
                assert!((slopes[(row, j)] - slope).abs() < 1e-14);
            }
        }
    }
}
