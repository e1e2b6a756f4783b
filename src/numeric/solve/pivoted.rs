//! `R0 E D P = Q [R S; 0 ~0]`: Householder QR with rows sorted by size and columns pivoted; its diagonal shows
//! the rank.
//!
//! Row sorting with column pivoting is what keeps Householder QR backward stable row by row when weights differ by many
//! orders (A. Cox and N. Higham, *Stability of Householder QR factorization for weighted least squares problems*,
//! 1998). The factor is dense: for problems whose rows fit into memory, and the last resort of
//! `auto`.

use super::SolveError;
use super::factor::Factor;
use super::householder::reflector;
use super::triangular::equilibration;
use crate::linalg::inverse_norm1_estimate;
use crate::work;

/// A dense rank-revealing factor of weighted rows with their right-hand side.
#[derive(Clone, Debug)]
pub struct PivotedQr {
    columns: usize,
    scale: Vec<f64>,
    /// Column k of the factor is unknown `order[k]`.
    order: Vec<usize>,
    /// Upper triangle, column-major, `columns` rows (fewer data rows leave zeros).
    r: Vec<f64>,
    rhs: Vec<f64>,
    rank: usize,
}

impl PivotedQr {
    /// Factors `rows` rows given column after column (`values[c * rows + r]`), with their right-hand side.
    /// Columns of zeros are allowed and come out as not determined.
    ///
    /// # Errors
    /// [`SolveError::NotFinite`].
    pub fn of_dense(rows: usize, columns: usize, values: &[f64], rhs: &[f64]) -> Result<PivotedQr, SolveError> {
        let norms: Vec<f64> = values.chunks_exact(rows.max(1)).map(norm_squared).collect();
        let filled: Vec<f64> = norms.iter().map(|n| if *n == 0.0 { 1.0 } else { *n }).collect();
        let scale = equilibration(&filled)?;
        let mut work = sorted_rows(rows, columns, values, rhs, &scale);
        let mut order: Vec<usize> = (0..columns).collect();
        let steps = rows.min(columns);
        work::add(rows * columns * steps);
        for k in 0..steps {
            let pivot = (k..columns)
                .map(|c| (c, norm_squared(&work[c * rows + k..(c + 1) * rows])))
                .fold((k, -1.0), |best, now| if now.1 > best.1 { now } else { best })
                .0;
            if pivot != k {
                order.swap(k, pivot);
                (0..rows).for_each(|r| work.swap(k * rows + r, pivot * rows + r));
            }
            eliminate(&mut work, rows, k);
        }
        let mut r = vec![0.0; columns * columns];
        for c in 0..columns {
            for k in 0..=c.min(steps.saturating_sub(1)).min(rows.saturating_sub(1)) {
                r[c * columns + k] = work[c * rows + k];
            }
        }
        let mut rotated = vec![0.0; columns];
        rotated[..steps].copy_from_slice(&work[columns * rows..columns * rows + steps]);
        let largest = if columns > 0 { r[0].abs() } else { 0.0 };
        let tolerance = 20.0 * (rows.max(columns) as f64).sqrt() * f64::EPSILON * largest;
        let rank = (0..steps).take_while(|&k| r[k * columns + k].abs() > tolerance).count();
        Ok(PivotedQr { columns, scale, order, r, rhs: rotated, rank })
    }

    /// Numerical rank.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The basic solution: dependent unknowns zero.
    pub fn coefficients(&self) -> Vec<f64> {
        let mut v = self.rhs.clone();
        v[self.rank..].fill(0.0);
        self.solve_upper(&mut v);
        self.unpivot(&v)
    }

    /// Directions that the data do not determine, one per dependent unknown: `E z = 0` to rounding, `z = 1` at that unknown.
    pub fn null_space(&self) -> Vec<Vec<f64>> {
        (self.rank..self.columns)
            .map(|c| {
                let mut v = vec![0.0; self.columns];
                (0..self.rank).for_each(|k| v[k] = -self.r[c * self.columns + k]);
                self.solve_upper(&mut v);
                v[c] = 1.0;
                self.unpivot(&v)
            })
            .collect()
    }

    /// `v <- (E'E)^+ v` over the determined unknowns.
    pub(crate) fn solve(&self, v: &mut [f64]) {
        let mut w: Vec<f64> = self.order.iter().map(|&u| v[u] * self.scale[u]).collect();
        self.solve_upper_transposed(&mut w);
        self.solve_upper(&mut w);
        v.copy_from_slice(&self.unpivot(&w));
    }

    /// Condition in the 1-norm of the determined columns, equilibrated.
    pub(crate) fn condition(&self) -> f64 {
        let norm = (0..self.rank)
            .map(|c| (0..=c).map(|k| self.r[c * self.columns + k].abs()).sum::<f64>())
            .fold(0.0, f64::max);
        norm * inverse_norm1_estimate(self.rank, |v| self.solve_upper(v), |v| self.solve_upper_transposed(v))
    }

    fn unpivot(&self, v: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.columns];
        v.iter().zip(&self.order).for_each(|(value, &unknown)| out[unknown] = value * self.scale[unknown]);
        out
    }

    fn solve_upper(&self, v: &mut [f64]) {
        for k in (0..self.rank).rev() {
            let dot: f64 = (k + 1..self.rank).map(|c| self.r[c * self.columns + k] * v[c]).sum();
            v[k] = (v[k] - dot) / self.r[k * self.columns + k];
        }
        v.iter_mut().skip(self.rank).for_each(|w| *w = 0.0);
    }

    fn solve_upper_transposed(&self, v: &mut [f64]) {
        for k in 0..self.rank {
            let column = &self.r[k * self.columns..k * self.columns + k];
            let dot: f64 = column.iter().zip(v.iter()).map(|(a, b)| a * b).sum();
            v[k] = (v[k] - dot) / self.r[k * self.columns + k];
        }
        v.iter_mut().skip(self.rank).for_each(|w| *w = 0.0);
    }
}

impl Factor for PivotedQr {
    fn solve(&self, v: &mut [f64]) {
        PivotedQr::solve(self, v);
    }

    fn condition(&self) -> f64 {
        PivotedQr::condition(self)
    }
}

fn norm_squared(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

/// Scaled columns and the right-hand side, rows in descending order of their largest entry.
fn sorted_rows(rows: usize, columns: usize, values: &[f64], rhs: &[f64], scale: &[f64]) -> Vec<f64> {
    let size = |r: usize| (0..columns).fold(0.0_f64, |m, c| m.max((values[c * rows + r] * scale[c]).abs()));
    let mut by_size: Vec<(usize, f64)> = (0..rows).map(|r| (r, size(r))).collect();
    by_size.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut work = Vec::with_capacity((columns + 1) * rows);
    for c in 0..columns {
        work.extend(by_size.iter().map(|&(r, _)| values[c * rows + r] * scale[c]));
    }
    work.extend(by_size.iter().map(|&(r, _)| rhs[r]));
    work
}

fn eliminate(work: &mut [f64], rows: usize, k: usize) {
    let (left, right) = work.split_at_mut((k + 1) * rows);
    let pivot_column = &mut left[k * rows + k..];
    let Some((beta, tau)) = reflector(pivot_column) else { return };
    for column in right.chunks_exact_mut(rows) {
        let (head, tail) = column[k..].split_at_mut(1);
        let dot = head[0] + pivot_column[1..].iter().zip(tail.iter()).map(|(a, b)| a * b).sum::<f64>();
        head[0] -= tau * dot;
        tail.iter_mut().zip(&pivot_column[1..]).for_each(|(t, v)| *t -= tau * dot * v);
    }
    pivot_column[0] = beta;
    pivot_column[1..].fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rank_and_null_space_of_a_dependent_column() {
        // column 2 = column 0 + column 1
        let rows = 6;
        let (a, b): (Vec<f64>, Vec<f64>) = (0..rows).map(|r| ((r as f64).sin() + 2.0, (r as f64 * 1.7).cos())).unzip();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x + y).collect();
        let rhs: Vec<f64> = a.iter().zip(&b).map(|(x, y)| 3.0 * x - y).collect();
        let qr = PivotedQr::of_dense(rows, 3, &[a.clone(), b.clone(), sum.clone()].concat(), &rhs).unwrap();
        assert_eq!(qr.rank(), 2);
        let c = qr.coefficients();
        for r in 0..rows {
            assert!((c[0] * a[r] + c[1] * b[r] + c[2] * sum[r] - rhs[r]).abs() < 1e-13);
        }
        let z = &qr.null_space()[0];
        assert!((0..rows).all(|r| (z[0] * a[r] + z[1] * b[r] + z[2] * sum[r]).abs() < 1e-13));
    }
}
