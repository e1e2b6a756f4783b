//! The normal matrix of a tensor spline: `A[(i,j),(k,l)] = 0` unless `|i - k| <= p` and `|j - l| <= q`.
//!
//! Unknown `(i, j)` has number `i m + j`. Only the lower half is stored, as a stencil: for row `(i, j)` the entries
//! `(i - di, j + dj)` with `di = 0..=p`, `dj = -q..=q` (for `di = 0` those with `dj > 0` are unused).

/// Numbers and degrees of the basis functions in x and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TensorShape {
    /// Basis functions n (x) and m (y).
    pub basis: [usize; 2],
    /// Degrees p and q.
    pub degree: [usize; 2],
}

impl TensorShape {
    /// Number of unknowns n m.
    pub fn unknowns(&self) -> usize {
        self.basis[0] * self.basis[1]
    }

    /// Number of basis functions that are not zero at one point, (p + 1)(q + 1).
    pub fn local(&self) -> usize {
        (self.degree[0] + 1) * (self.degree[1] + 1)
    }

    /// Stored entries per row of a [`StencilMatrix`].
    pub fn stencil_width(&self) -> usize {
        (self.degree[0] + 1) * (2 * self.degree[1] + 1)
    }
}

/// A symmetric matrix with the sparsity of a tensor spline's normal equations.
#[derive(Clone, Debug, PartialEq)]
pub struct StencilMatrix {
    shape: TensorShape,
    values: Vec<f64>,
}

impl StencilMatrix {
    /// The zero matrix.
    pub fn zeros(shape: TensorShape) -> StencilMatrix {
        StencilMatrix { shape, values: vec![0.0; shape.unknowns() * shape.stencil_width()] }
    }

    /// Shape of the spline.
    pub fn shape(&self) -> TensorShape {
        self.shape
    }

    /// Number of rows and columns.
    pub fn order(&self) -> usize {
        self.shape.unknowns()
    }

    /// All stored entries, row after row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All stored entries, row after row.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Position in [`StencilMatrix::values`] of entry `((i, j), (i - di, j + dj - q))`: `dj` counts from 0.
    #[inline]
    pub fn position(&self, row: usize, di: usize, dj: usize) -> usize {
        row * self.shape.stencil_width() + di * (2 * self.shape.degree[1] + 1) + dj
    }

    /// Back to zero, keeping the memory.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Calls `visit(row, column, position)` for every entry of the lower half, diagonal included, columns ascending.
    pub fn for_each_lower(&self, mut visit: impl FnMut(usize, usize, usize)) {
        let [n, m] = self.shape.basis;
        let [p, q] = self.shape.degree;
        for i in 0..n {
            for j in 0..m {
                let row = i * m + j;
                for di in (0..=p.min(i)).rev() {
                    let (from, to) = (q.saturating_sub(j), if di == 0 { q } else { (2 * q).min(m - 1 - j + q) });
                    for dj in from..=to {
                        visit(row, (i - di) * m + j + dj - q, self.position(row, di, dj));
                    }
                }
            }
        }
    }

    /// Diagonal entries.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order()).map(|row| self.values[self.position(row, 0, self.shape.degree[1])]).collect()
    }

    /// `out = A v`.
    pub fn multiply(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.for_each_lower(|row, column, position| {
            let a = self.values[position];
            out[row] += a * v[column];
            if row != column {
                out[column] += a * v[row];
            }
        });
    }

    /// Largest column sum of magnitudes of `D A D`.
    pub fn norm1_scaled(&self, d: &[f64]) -> f64 {
        self.norm1_scaled_with(d, &mut vec![0.0; self.order()])
    }

    /// The same, using a buffer of the caller with one number per row.
    pub fn norm1_scaled_with(&self, d: &[f64], sums: &mut [f64]) -> f64 {
        sums.fill(0.0);
        self.for_each_lower(|row, column, position| {
            let a = (self.values[position] * d[row] * d[column]).abs();
            sums[row] += a;
            if row != column {
                sums[column] += a;
            }
        });
        sums.iter().copied().fold(0.0, f64::max)
    }

    /// Adds `factor * (X (x) Y)` for symmetric banded X, Y given by lower bands (`bands[i][d] = X(i, i - d)`).
    pub fn add_kronecker(&mut self, factor: f64, x: &[Vec<f64>], y: &[Vec<f64>]) {
        let q = self.shape.degree[1];
        let m = self.shape.basis[1];
        for (i, x_row) in x.iter().enumerate() {
            for (di, x_value) in x_row.iter().enumerate().take(i + 1) {
                for j in 0..m {
                    let row = i * m + j;
                    for (dj, y_value) in y[j].iter().enumerate().take(j + 1) {
                        let below = self.position(row, di, q - dj);
                        self.values[below] += factor * x_value * y_value;
                        if di > 0 && dj > 0 {
                            // Y(j - dj, j) equals Y(j, j - dj), which is the one stored
                            let above = self.position(row - dj, di, q + dj);
                            self.values[above] += factor * x_value * y_value;
                        }
                    }
                }
            }
        }
    }

    /// Adds `factor * other`, entry by entry.
    pub fn add_scaled(&mut self, factor: f64, other: &StencilMatrix) {
        debug_assert_eq!(self.shape, other.shape);
        for (a, b) in self.values.iter_mut().zip(&other.values) {
            *a += factor * b;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kronecker_sum_and_product_match_the_dense_oracle() {
        let shape = TensorShape { basis: [4, 5], degree: [2, 3] };
        let band = |n: usize, p: usize, seed: f64| -> Vec<Vec<f64>> {
            (0..n).map(|i| (0..=p).map(|d| (seed * (i * 7 + d * 3 + 1) as f64).sin()).collect()).collect()
        };
        let (x, y) = (band(4, 2, 0.7), band(5, 3, 1.3));
        let mut a = StencilMatrix::zeros(shape);
        a.add_kronecker(1.5, &x, &y);
        let full = |b: &[Vec<f64>], i: usize, k: usize| -> f64 {
            let (hi, lo) = (i.max(k), i.min(k));
            b[hi].get(hi - lo).copied().unwrap_or(0.0)
        };
        let v: Vec<f64> = (0..20).map(|k| (k as f64 * 0.37).cos()).collect();
        let mut out = vec![0.0; 20];
        a.multiply(&v, &mut out);
        for row in 0..20 {
            let exact: f64 = (0..20).map(|c| 1.5 * full(&x, row / 5, c / 5) * full(&y, row % 5, c % 5) * v[c]).sum();
            assert!((out[row] - exact).abs() < 1e-13);
        }
    }
}
