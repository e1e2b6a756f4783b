//! Cholesky for a patch of one segment per direction, degree 2, 3 or 4: 9, 16 or 25 unknowns; the
//! compiler knows all lengths.

use crate::linalg::{StencilMatrix, TensorShape};
use crate::simd::{DenseColumns, Isa, factor_columns, invert_columns};

/// A factor of 9, 16 or 25 unknowns.
#[derive(Clone, Debug)]
pub(super) enum PatchCholesky {
    Quadratic(Box<Factor<3, 9, 16>>),
    Cubic(Box<Factor<4, 16, 24>>),
    Quartic(Box<Factor<5, 25, 32>>),
}

/// Columns of L, and the inverses of its diagonal.
#[derive(Clone, Debug)]
pub(super) struct Factor<const W: usize, const N: usize, const PADDED: usize> {
    columns: DenseColumns<N, PADDED>,
    inverse: [f64; N],
}

impl PatchCholesky {
    /// `None` where the shape is not that of such a patch.
    pub(super) fn plan(shape: TensorShape) -> Option<PatchCholesky> {
        match (shape.basis, shape.degree) {
            ([3, 3], [2, 2]) => Some(PatchCholesky::Quadratic(Box::new(Factor::new()))),
            ([4, 4], [3, 3]) => Some(PatchCholesky::Cubic(Box::new(Factor::new()))),
            ([5, 5], [4, 4]) => Some(PatchCholesky::Quartic(Box::new(Factor::new()))),
            _ => None,
        }
    }

    /// Factors `D A D`, D = `scale`, and solves for `v`, if it is given, in the same pass. Returns the smallest squared
    /// pivot and the largest column sum of magnitudes of `D A D`.
    pub(super) fn factor(
        &mut self,
        matrix: &StencilMatrix,
        scale: &[f64],
        v: Option<&mut [f64]>,
    ) -> Result<[f64; 2], usize> {
        match self {
            PatchCholesky::Quadratic(factor) => factor.factor(matrix, scale, v),
            PatchCholesky::Cubic(factor) => factor.factor(matrix, scale, v),
            PatchCholesky::Quartic(factor) => factor.factor(matrix, scale, v),
        }
    }

    /// `v <- (D A D)^-1 v`.
    pub(super) fn solve(&self, v: &mut [f64]) {
        match self {
            PatchCholesky::Quadratic(factor) => factor.solve(v),
            PatchCholesky::Cubic(factor) => factor.solve(v),
            PatchCholesky::Quartic(factor) => factor.solve(v),
        }
    }
}

impl PatchCholesky {
    /// `(L L')^-1`, row by row.
    pub(super) fn write_inverse(&self, out: &mut [f64]) {
        match self {
            PatchCholesky::Quadratic(factor) => factor.write_inverse(out),
            PatchCholesky::Cubic(factor) => factor.write_inverse(out),
            PatchCholesky::Quartic(factor) => factor.write_inverse(out),
        }
    }
}

impl<const W: usize, const N: usize, const PADDED: usize> Factor<W, N, PADDED> {
    fn new() -> Factor<W, N, PADDED> {
        Factor { columns: [[0.0; PADDED]; N], inverse: [0.0; N] }
    }

    fn factor(&mut self, matrix: &StencilMatrix, scale: &[f64], v: Option<&mut [f64]>) -> Result<[f64; 2], usize> {
        let norm = self.take(matrix, scale);
        if let Some(v) = &v {
            self.columns.iter_mut().zip(v.iter()).for_each(|(column, b)| column[N] = *b);
        }
        let pivot = factor_columns(Isa::active(), &mut self.columns)?;
        for (k, inverse) in self.inverse.iter_mut().enumerate() {
            *inverse = 1.0 / self.columns[k][k];
        }
        if let Some(v) = v {
            v.iter_mut().zip(&self.columns).for_each(|(y, column)| *y = column[N]);
            self.backward(v);
        }
        Ok([pivot, norm])
    }

    /// The scaled lower triangle by columns; its 1-norm.
    fn take(&mut self, matrix: &StencilMatrix, scale: &[f64]) -> f64 {
        let stencil = W * (2 * W - 1);
        let values = &matrix.values()[..N * stencil];
        let scale = &scale[..N];
        let mut sums = [0.0; N];
        for i in 0..W {
            for j in 0..W {
                let row = i * W + j;
                for k in 0..=i {
                    for l in 0..if k == i { j + 1 } else { W } {
                        let column = k * W + l;
                        let value = values[row * stencil + (i - k) * (2 * W - 1) + W - 1 + l - j];
                        let scaled = value * scale[row] * scale[column];
                        self.columns[column][row] = scaled;
                        sums[row] += scaled.abs();
                        if column != row {
                            sums[column] += scaled.abs();
                        }
                    }
                }
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    fn solve(&self, v: &mut [f64]) {
        let v = &mut v[..N];
        for k in 0..N {
            v[k] *= self.inverse[k];
            let value = v[k];
            for i in k + 1..N {
                v[i] -= self.columns[k][i] * value;
            }
        }
        self.backward(v);
    }

    fn write_inverse(&self, out: &mut [f64]) {
        let inverse = invert_columns(Isa::for_work(N), &self.columns, &self.inverse);
        out.chunks_exact_mut(N).zip(&inverse).for_each(|(out, row)| out.copy_from_slice(&row[..N]));
    }

    /// `v <- L^-T v`; each sum ends with the unknown that was found last, so that its other terms need not wait.
    fn backward(&self, v: &mut [f64]) {
        let v = &mut v[..N];
        for k in (0..N).rev() {
            let mut sum = v[k];
            for i in (k + 1..N).rev() {
                sum -= self.columns[k][i] * v[i];
            }
            v[k] = sum * self.inverse[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::small::PackedCholesky;

    #[test]
    fn patches_agree_with_the_packed_factor() {
        for degree in [2, 3, 4] {
            let shape = TensorShape { basis: [degree + 1; 2], degree: [degree; 2] };
            let n = shape.unknowns();
            let mut matrix = StencilMatrix::zeros(shape);
            let mut places = Vec::new();
            matrix.for_each_lower(|row, column, at| places.push((row, column, at)));
            let scale: Vec<f64> = (0..n).map(|k| 0.3 + 0.01 * k as f64).collect();
            let mut packed = PackedCholesky::default();
            packed.reset(n);
            for (row, column, at) in places {
                let value = if row == column { 20.0 } else { ((row * 7 + column * 13) as f64).sin() };
                matrix.values_mut()[at] = value;
                packed.set(row, column, value * scale[row] * scale[column]);
            }
            packed.factor().unwrap();
            let norm = matrix.norm1_scaled(&scale);
            let right: Vec<f64> = (0..n).map(|k| (k as f64).cos()).collect();
            let (mut expected, mut found) = (right.clone(), right.clone());
            packed.solve(&mut expected);
            let mut patch = PatchCholesky::plan(shape).unwrap();
            let [pivot, sum] = patch.factor(&matrix, &scale, Some(&mut found)).unwrap();
            assert!((pivot / packed.smallest_pivot() - 1.0).abs() < 1e-14 && (sum / norm - 1.0).abs() < 1e-14);
            let mut again = right;
            patch.solve(&mut again);
            for k in 0..n {
                assert!((found[k] - expected[k]).abs() < 1e-14 && (again[k] - expected[k]).abs() < 1e-14);
            }
            let mut inverse = vec![0.0; n * n];
            patch.write_inverse(&mut inverse);
            for (u, row) in inverse.chunks_exact(n).enumerate() {
                let mut column = vec![0.0; n];
                column[u] = 1.0;
                packed.solve(&mut column);
                assert!(row.iter().zip(&column).all(|(a, b)| (a - b).abs() < 1e-15), "column {u}");
            }
        }
        assert!(PatchCholesky::plan(TensorShape { basis: [4, 3], degree: [2, 2] }).is_none());
    }
}
