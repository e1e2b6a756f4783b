//! Householder triangularisation of small dense fronts, `H_k .. H_1 F = [R; 0]`, stored by columns.
//!
//! Fronts of one knot cell have a few tens of columns and are reduced here; larger ones by faer's blocked QR.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::{MatMut, Par};

use crate::linalg::partial_dots;
use crate::work;

/// From this many columns on faer's blocked code is faster.
const BLOCKED_FROM: usize = 48;

/// Largest entries of a column whose squares neither overflow nor vanish beside each other.
const SQUARES_HOLD: std::ops::Range<f64> = 1e-120..1e120;

/// A column-major matrix with room for `capacity` rows, of which `rows` are in use.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub(super) columns: usize,
    pub(super) rows: usize,
    capacity: usize,
    values: Vec<f64>,
}

impl Front {
    pub(super) fn new(columns: usize, capacity: usize) -> Front {
        Front { columns, rows: 0, capacity, values: vec![0.0; columns * capacity] }
    }

    pub(super) fn is_full(&self) -> bool {
        self.rows == self.capacity
    }

    pub(super) fn get(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.capacity + row]
    }

    /// Adds a row of zeros and returns its number; the front grows when it is full.
    pub(super) fn add_row(&mut self) -> usize {
        if self.is_full() {
            self.grow();
        }
        for column in 0..self.columns {
            self.values[column * self.capacity + self.rows] = 0.0;
        }
        self.rows += 1;
        self.rows - 1
    }

    fn grow(&mut self) {
        let mut larger = Front::new(self.columns, 2 * self.capacity.max(8));
        for column in 0..self.columns {
            let from = &self.values[column * self.capacity..column * self.capacity + self.rows];
            larger.values[column * larger.capacity..column * larger.capacity + self.rows].copy_from_slice(from);
        }
        larger.rows = self.rows;
        *self = larger;
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        self.values[column * self.capacity + row] = value;
    }

    pub(super) fn clear(&mut self) {
        self.rows = 0;
    }

    /// Replaces the rows by the upper triangle of their QR factor; at most `columns` rows remain.
    pub(super) fn triangularise(&mut self) {
        work::add(self.rows * self.columns.pow(2));
        if self.columns >= BLOCKED_FROM && self.rows >= BLOCKED_FROM {
            self.triangularise_blocked();
        } else {
            self.triangularise_by_hand();
        }
        let kept = self.rows.min(self.columns);
        for column in 0..kept {
            let below = column * self.capacity;
            self.values[below + column + 1..below + self.rows].fill(0.0);
        }
        self.rows = kept;
    }

    /// Zeroes column `column` below row `used` and updates the other columns. If the column's part there is already below
    /// `threshold`, sets it to zero and returns `false`.
    pub(super) fn eliminate_column(&mut self, used: usize, column: usize, threshold: f64) -> bool {
        let rows = self.rows;
        if used >= rows {
            return false;
        }
        let (left, right) = self.values.split_at_mut((column + 1) * self.capacity);
        let pivot_column = &mut left[column * self.capacity + used..column * self.capacity + rows];
        if pivot_column.iter().map(|v| v * v).sum::<f64>().sqrt() <= threshold {
            pivot_column.fill(0.0);
            return false;
        }
        work::add(2 * (rows - used) * (self.columns - column));
        let Some((beta, tau)) = reflector(pivot_column) else { return true };
        reflect(right, pivot_column, tau, self.capacity, used..rows, self.columns - column - 1);
        pivot_column[0] = beta;
        pivot_column[1..].fill(0.0);
        true
    }

    fn triangularise_blocked(&mut self) {
        use faer::linalg::qr::no_pivoting::factor as qr;
        let (rows, columns) = (self.rows, self.columns);
        let block = qr::recommended_block_size::<f64>(rows, columns);
        let scratch = qr::qr_in_place_scratch::<f64>(rows, columns, block, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let mut coefficients = faer::Mat::<f64>::zeros(block, rows.min(columns));
        let matrix = MatMut::from_column_major_slice_with_stride_mut(&mut self.values, rows, columns, self.capacity);
        qr::qr_in_place(matrix, coefficients.as_mut(), Par::Seq, MemStack::new(&mut memory), Default::default());
    }

    fn triangularise_by_hand(&mut self) {
        let rows = self.rows;
        for k in 0..self.columns.min(rows) {
            let (left, right) = self.values.split_at_mut((k + 1) * self.capacity);
            let pivot_column = &mut left[k * self.capacity + k..k * self.capacity + rows];
            let Some((beta, tau)) = reflector(pivot_column) else { continue };
            reflect(right, pivot_column, tau, self.capacity, k..rows, self.columns - k - 1);
            pivot_column[0] = beta;
        }
    }
}

/// Applies `I - tau v v'` (v in `pivot_column[1..]`) to rows `rows` of the next `count` columns.
fn reflect(
    columns: &mut [f64],
    pivot_column: &[f64],
    tau: f64,
    capacity: usize,
    rows: std::ops::Range<usize>,
    count: usize,
) {
    let v = &pivot_column[1..];
    for column in columns.chunks_exact_mut(capacity).take(count) {
        let (head, tail) = column[rows.clone()].split_at_mut(1);
        let factor = tau * (head[0] + dot(v, tail));
        head[0] -= factor;
        tail.iter_mut().zip(v).for_each(|(t, a)| *t -= factor * a);
    }
}

/// The reflector `I - tau v v'`, `v_0 = 1`, that maps `x` to `beta e_1`. Returns `(beta, tau)` and leaves the rest of v in
/// `x[1..]`; `None` if `x[1..]` is zero already.
pub(super) fn reflector(x: &mut [f64]) -> Option<(f64, f64)> {
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest == 0.0 || x[1..].iter().all(|v| *v == 0.0) {
        return None;
    }
    // scaled by the largest entry where squares would overflow or vanish, so that rows of size 1e-170 or 1e170 work too
    let unit = if SQUARES_HOLD.contains(&largest) { 1.0 } else { largest };
    let tail = if unit == 1.0 { dot(&x[1..], &x[1..]) } else { x[1..].iter().map(|v| (v / unit) * (v / unit)).sum() };
    let head = x[0] / unit;
    let norm = (head * head + tail).sqrt();
    let beta = -norm.copysign(head);
    let tau = (beta - head) / beta;
    let factor = 1.0 / ((head - beta) * unit);
    x[1..].iter_mut().for_each(|v| *v *= factor);
    Some((beta * unit, tau))
}

/// `a . b` in eight sums side by side: one long sum has to wait for each addition, because reordering it changes its rounding.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (sums, rest) = partial_dots::<8>(a, b);
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(rows: usize, columns: usize) {
        let mut front = Front::new(columns, 4);
        let mut gram = vec![0.0; columns * columns];
        for r in 0..rows {
            let row = front.add_row();
            let values: Vec<f64> = (0..columns).map(|c| ((r * 31 + c * 17 + r * c) as f64).sin()).collect();
            for c in 0..columns {
                front.set(row, c, values[c]);
                for k in 0..columns {
                    gram[c * columns + k] += values[c] * values[k];
                }
            }
        }
        front.triangularise();
        for c in 0..columns {
            for k in 0..columns {
                let product: f64 = (0..front.rows).map(|r| front.get(r, c) * front.get(r, k)).sum();
                assert!((product - gram[c * columns + k]).abs() < 1e-12 * rows as f64);
            }
            assert!((c + 1..front.rows).all(|r| front.get(r, c) == 0.0));
        }
    }

    #[test]
    fn r_keeps_the_gram_matrix() {
        check(40, 7);
        check(5, 7);
        check(150, 60);
    }
}
