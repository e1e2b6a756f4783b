//! Cholesky in single precision of a normal matrix, for refinement in double.
//!
//! ```text
//! D A D = L L',  D = diag(A)^-1/2,  L in f32        v <- D L'^-1 L^-1 D v
//! ```
//!
//! It is dense: at the sizes at which a fit takes microseconds a band saves little, and refinement does the rest. A condition
//! of E beyond 1e3.5 squares to more than single precision holds, and the factor breaks down.

use palpate_numeric::linalg::StencilMatrix;

/// The factor.
#[derive(Debug)]
pub(super) struct SingleFactor {
    order: usize,
    scale: Vec<f64>,
    /// Rows of the lower triangle, one behind the other.
    lower: Vec<f32>,
}

impl SingleFactor {
    /// Factors the matrix.
    ///
    /// # Errors
    /// Where a pivot is not positive, in words.
    pub(crate) fn new(matrix: &StencilMatrix) -> Result<SingleFactor, String> {
        let order = matrix.order();
        let scale: Vec<f64> = matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
        let mut lower = vec![0.0_f32; order * (order + 1) / 2];
        let values = matrix.values();
        matrix.for_each_lower(|row, column, at| {
            lower[row * (row + 1) / 2 + column] = (values[at] * scale[row] * scale[column]) as f32;
        });
        for i in 0..order {
            let (above, row) = lower.split_at_mut(i * (i + 1) / 2);
            for j in 0..i {
                let other = &above[j * (j + 1) / 2..][..=j];
                let sum: f32 = row[..j].iter().zip(&other[..j]).map(|(a, b)| a * b).sum();
                row[j] = (row[j] - sum) / other[j];
            }
            let pivot = row[i] - row[..i].iter().map(|a| a * a).sum::<f32>();
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(format!("the normal matrix is not positive definite in single precision at unknown {i}"));
            }
            row[i] = pivot.sqrt();
        }
        Ok(SingleFactor { order, scale, lower })
    }

    /// `v <- A^-1 v`, to the digits of single precision.
    pub(crate) fn solve(&self, v: &mut [f64]) {
        // corrections shrink far below the range of single precision: they are scaled to one
        let size = v.iter().zip(&self.scale).fold(0.0_f64, |m, (v, s)| m.max((v * s).abs()));
        if size == 0.0 {
            return;
        }
        let row = |i: usize| &self.lower[i * (i + 1) / 2..][..=i];
        let mut w: Vec<f32> = v.iter().zip(&self.scale).map(|(v, s)| (v * s / size) as f32).collect();
        for i in 0..self.order {
            let sum: f32 = row(i)[..i].iter().zip(&w).map(|(a, b)| a * b).sum();
            w[i] = (w[i] - sum) / row(i)[i];
        }
        for i in (0..self.order).rev() {
            w[i] /= row(i)[i];
            let own = w[i];
            row(i)[..i].iter().zip(&mut w).for_each(|(a, b)| *b -= a * own);
        }
        v.iter_mut().zip(w.iter().zip(&self.scale)).for_each(|(v, (w, s))| *v = f64::from(*w) * s * size);
    }
}
