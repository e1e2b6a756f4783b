//! Columns of an equilibrated stencil matrix from either end.
//!
//! ```text
//! forwards    unknown u is number u            backwards    unknown u is number n m - 1 - u
//! ```

use crate::linalg::StencilMatrix;

/// Columns of `D A D` in the order of elimination.
pub(super) struct Numbering<'a> {
    pub(super) matrix: &'a StencilMatrix,
    pub(super) scale: &'a [f64],
    pub(super) reversed: bool,
}

impl Numbering<'_> {
    /// Calls `put(offset, value)` for the entries on and below the diagonal of column `number`.
    #[inline]
    pub(super) fn column(&self, number: usize, mut put: impl FnMut(usize, f64)) {
        let shape = self.matrix.shape();
        let ([n, m], [p, q]) = (shape.basis, shape.degree);
        let values = self.matrix.values();
        if self.reversed {
            // entries below the diagonal in the reversed numbering are those before it in the plain one: the row's own stencil
            let v = self.matrix.order() - 1 - number;
            let (i, j) = (v / m, v % m);
            for di in 0..=p.min(i) {
                let to = if di == 0 { q } else { (2 * q).min(m - 1 - j + q) };
                for dj in q.saturating_sub(j)..=to {
                    let offset = di * m + q - dj;
                    put(offset, values[self.matrix.position(v, di, dj)] * self.scale[v] * self.scale[v - offset]);
                }
            }
        } else {
            let (i, j) = (number / m, number % m);
            for di in 0..=p.min(n - 1 - i) {
                let from = if di == 0 { 0 } else { -(q.min(j) as isize) };
                for dj in from..=(q.min(m - 1 - j) as isize) {
                    let offset = (di as isize * m as isize + dj) as usize;
                    let row = number + offset;
                    let position = self.matrix.position(row, di, (q as isize - dj) as usize);
                    put(offset, values[position] * self.scale[number] * self.scale[row]);
                }
            }
        }
    }
}
