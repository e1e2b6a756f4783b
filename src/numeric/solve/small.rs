//! Dense Cholesky for few unknowns, with packed rows; a library call would cost more than the arithmetic.

/// Lower triangle of a dense factor, row after row: row i starts at `i (i + 1) / 2`.
#[derive(Clone, Debug, Default)]
pub(super) struct PackedCholesky {
    order: usize,
    lower: Vec<f64>,
}

#[inline]
fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

impl PackedCholesky {
    /// Zero matrix of the given order, keeping the memory.
    pub(super) fn reset(&mut self, order: usize) {
        self.order = order;
        self.lower.clear();
        self.lower.resize(start(order), 0.0);
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        self.lower[start(row) + column] = value;
    }

    /// Factors in place; `Err(column)` where a pivot is not positive.
    pub(super) fn factor(&mut self) -> Result<(), usize> {
        for i in 0..self.order {
            let (above, row) = self.lower.split_at_mut(start(i));
            for j in 0..i {
                let pivot_row = &above[start(j)..=start(j) + j];
                let dot: f64 = row[..j].iter().zip(pivot_row).map(|(a, b)| a * b).sum();
                row[j] = (row[j] - dot) / pivot_row[j];
            }
            let pivot = row[i] - row[..i].iter().map(|a| a * a).sum::<f64>();
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(i);
            }
            row[i] = pivot.sqrt();
        }
        Ok(())
    }

    /// Smallest squared pivot `l_jj^2`. With columns of norm 1 it shows how far the matrix is from losing rank.
    pub(super) fn smallest_pivot(&self) -> f64 {
        (0..self.order).map(|i| self.lower[start(i) + i]).fold(f64::INFINITY, f64::min).powi(2)
    }

    /// `v <- A^-1 v`.
    pub(super) fn solve(&self, v: &mut [f64]) {
        for i in 0..self.order {
            let row = &self.lower[start(i)..=start(i) + i];
            let dot: f64 = row[..i].iter().zip(&v[..i]).map(|(a, b)| a * b).sum();
            v[i] = (v[i] - dot) / row[i];
        }
        for i in (0..self.order).rev() {
            let row = &self.lower[start(i)..=start(i) + i];
            let value = v[i] / row[i];
            v[i] = value;
            for (target, l) in v[..i].iter_mut().zip(row) {
                *target -= value * l;
            }
        }
    }
}
