//! The normal matrix of a parametric surface, a map into space: one 3 x 3 block for each pair of coefficients whose basis
//! functions overlap.
//!
//! ```text
//! A[(i,j),(k,l)] = 0 unless |i - k| <= p and |j - l| <= q          (modulo the period in a closed direction)
//! ```
//!
//! Coefficient `(i, j)` has number `i m + j`, its three unknowns `3 (i m + j) + d`. Only blocks with column <= row are
//! stored; a diagonal block is stored whole.

/// Numbers of distinct coefficients of a parametric surface, its degrees, and which directions are closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapShape {
    /// Distinct coefficients in u and v.
    pub free: [usize; 2],
    /// Degrees p and q.
    pub degree: [usize; 2],
    /// Closed directions.
    pub closed: [bool; 2],
}

impl MapShape {
    /// Number of coefficients n m; three unknowns each.
    pub fn coefficients(&self) -> usize {
        self.free[0] * self.free[1]
    }

    /// Indices in direction `axis` whose basis functions overlap that of `index`, ascending.
    fn neighbours(&self, axis: usize, index: usize) -> Vec<usize> {
        let (n, p) = (self.free[axis], self.degree[axis]);
        let mut near: Vec<usize> = if self.closed[axis] {
            (0..=2 * p).map(|k| (index + k + n * p - p) % n).collect()
        } else {
            (index.saturating_sub(p)..=(index + p).min(n - 1)).collect()
        };
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// A symmetric matrix of 3 x 3 blocks with the sparsity of a [`MapShape`].
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMatrix {
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<[[f64; 3]; 3]>,
}

impl BlockMatrix {
    /// The zero matrix.
    pub fn zeros(shape: MapShape) -> BlockMatrix {
        let m = shape.free[1];
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for i in 0..shape.free[0] {
            let rows = shape.neighbours(0, i);
            for j in 0..m {
                let across = shape.neighbours(1, j);
                let all = rows.iter().flat_map(|k| across.iter().map(move |l| k * m + l));
                columns.extend(all.filter(|column| *column <= i * m + j));
                starts.push(columns.len());
            }
        }
        let values = vec![[[0.0; 3]; 3]; columns.len()];
        BlockMatrix { starts, columns, values }
    }

    /// Number of coefficients.
    pub(crate) fn coefficients(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of unknowns.
    pub fn order(&self) -> usize {
        3 * self.coefficients()
    }

    /// Back to zero, keeping the memory.
    pub fn clear(&mut self) {
        self.values.fill([[0.0; 3]; 3]);
    }

    /// Adds `block` to `A[row, column]`, `column <= row`; a pair whose basis functions do not overlap is ignored.
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, block: &[[f64; 3]; 3]) {
        let range = self.starts[row]..self.starts[row + 1];
        if let Ok(k) = self.columns[range.clone()].binary_search(&column) {
            let target = &mut self.values[range.start + k];
            for (t, b) in target.iter_mut().zip(block) {
                (0..3).for_each(|d| t[d] += b[d]);
            }
        }
    }

    /// Columns and blocks stored of one row of blocks, columns ascending; the last one is the diagonal's.
    pub(crate) fn row(&self, row: usize) -> (&[usize], &[[[f64; 3]; 3]]) {
        let range = self.starts[row]..self.starts[row + 1];
        (&self.columns[range.clone()], &self.values[range])
    }

    /// Adds a matrix of the same pattern.
    pub fn add_matrix(&mut self, other: &BlockMatrix) {
        debug_assert_eq!(self.columns, other.columns);
        for (a, b) in
            self.values.as_flattened_mut().as_flattened_mut().iter_mut().zip(other.values.as_flattened().as_flattened())
        {
            *a += b;
        }
    }

    /// Calls `visit(row, column, entry)` for every stored block, rows ascending, columns ascending in each.
    pub(crate) fn for_each(&self, mut visit: impl FnMut(usize, usize, &[[f64; 3]; 3])) {
        for row in 0..self.coefficients() {
            for k in self.starts[row]..self.starts[row + 1] {
                visit(row, self.columns[k], &self.values[k]);
            }
        }
    }

    /// Diagonal entries, one per unknown.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order()).map(|u| self.values[self.starts[u / 3 + 1] - 1][u % 3][u % 3]).collect()
    }

    /// `sum_kl A_kl B_kl` with a full symmetric B, given by columns.
    pub fn contracted(&self, b: &[Vec<f64>]) -> f64 {
        let mut sum = 0.0;
        self.for_each(|row, column, block| {
            let twice = if row == column { 1.0 } else { 2.0 };
            for (a, line) in block.iter().enumerate() {
                let values = &b[3 * row + a][3 * column..3 * column + 3];
                sum += twice * line.iter().zip(values).map(|(x, y)| x * y).sum::<f64>();
            }
        });
        sum
    }

    /// `out = A v`.
    pub fn multiply(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.for_each(|row, column, block| {
            for a in 0..3 {
                for b in 0..3 {
                    out[3 * row + a] += block[a][b] * v[3 * column + b];
                    if row != column {
                        out[3 * column + b] += block[a][b] * v[3 * row + a];
                    }
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_directions_overlap_across_the_seam() {
        let shape = MapShape { free: [6, 3], degree: [2, 2], closed: [true, false] };
        let mut a = BlockMatrix::zeros(shape);
        // coefficient (5, 0) overlaps (0, 0) across the seam, (3, 0) does not
        a.add(15, 0, &[[1.0; 3]; 3]);
        a.add(9, 0, &[[7.0; 3]; 3]);
        let mut v = vec![0.0; a.order()];
        v[0] = 1.0;
        let mut out = vec![0.0; a.order()];
        a.multiply(&v, &mut out);
        assert_eq!(out[45..48], [1.0; 3]);
        assert_eq!(out.iter().filter(|w| **w != 0.0).count(), 3);
    }
}
