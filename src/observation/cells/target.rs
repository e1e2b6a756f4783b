//! Where a panel's sums go: its own lines of coefficients, and past their end the overlap with the next panel.

use crate::linalg::TensorShape;

/// What a panel adds to the first lines of the next one.
#[derive(Debug, Default)]
pub(super) struct Overlap {
    pub values: Vec<f64>,
    pub right: Vec<f64>,
}

/// One panel's part of the matrix and of the right-hand side.
pub(super) struct Target<'a> {
    pub shape: TensorShape,
    /// First line of coefficients of the panel.
    pub origin: usize,
    pub values: &'a mut [f64],
    pub right: &'a mut [f64],
    pub overlap: &'a mut Overlap,
}

impl Target<'_> {
    /// Lines that the panel owns; the last panel owns all that are left.
    fn own_lines(&self) -> usize {
        self.right.len() / self.shape.basis[1]
    }

    pub fn add_block(&mut self, first: [usize; 2], block: &[[f64; 16]]) {
        let (q, m, stencil) = (self.shape.degree[1], self.shape.basis[1], self.shape.stencil_width());
        let (width, own) = (q + 1, self.own_lines());
        let mut pairs = block.iter();
        for a in 0..=self.shape.degree[0] {
            let line = first[0] + a - self.origin;
            let values = if line < own {
                &mut self.values[line * m * stencil..]
            } else {
                &mut self.overlap.values[(line - own) * m * stencil..]
            };
            for k in 0..=a {
                let Some(entries) = pairs.next() else { return };
                for b in 0..width {
                    // on the diagonal block only the lower half is stored
                    let take = if a == k { b + 1 } else { width };
                    let start = (first[1] + b) * stencil + (a - k) * (2 * q + 1) + q - b;
                    let row = &mut values[start..start + take];
                    for (value, entry) in row.iter_mut().zip(&entries[b * width..b * width + take]) {
                        *value += entry;
                    }
                }
            }
        }
    }

    pub fn right_row(&mut self, line: usize, column: usize) -> &mut [f64] {
        let (m, own, line) = (self.shape.basis[1], self.own_lines(), line - self.origin);
        if line < own {
            &mut self.right[line * m + column..(line + 1) * m]
        } else {
            &mut self.overlap.right[(line - own) * m + column..(line - own + 1) * m]
        }
    }
}
