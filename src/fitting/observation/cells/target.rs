//! Destination of a panel's sums: its own lines of coefficients, and beyond their end the overlap with the next panel.

use palpate_numeric::linalg::TensorShape;

/// What a panel adds to the first lines of the next one.
#[derive(Clone, Debug, Default)]
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

    /// Adds a cell's part of the matrix; `block` holds the pairs (a, k <= a) of x functions, each (q + 1)^2 entries.
    pub(super) fn add_block(&mut self, first: [usize; 2], block: &[[f64; 16]]) {
        // the width is a literal, so that each row below takes two or three instructions
        match self.shape.degree[1] {
            1 => self.add_rows::<2>(first, block),
            2 => self.add_rows::<3>(first, block),
            _ => self.add_rows::<4>(first, block),
        }
    }

    #[inline]
    fn add_rows<const WIDTH: usize>(&mut self, first: [usize; 2], block: &[[f64; 16]]) {
        let (m, stencil, own) = (self.shape.basis[1], self.shape.stencil_width(), self.own_lines());
        let mut pairs = block.iter();
        for a in 0..=self.shape.degree[0] {
            let line = first[0] + a - self.origin;
            let (values, line) =
                if line < own { (&mut *self.values, line) } else { (&mut self.overlap.values[..], line - own) };
            let rows = &mut values[(line * m + first[1]) * stencil..][..WIDTH * stencil];
            for k in 0..=a {
                let Some(entries) = pairs.next() else { return };
                let (entries, _) = entries.as_chunks::<WIDTH>();
                for b in 0..WIDTH {
                    let start = b * stencil + (a - k) * (2 * WIDTH - 1) + WIDTH - 1 - b;
                    let row = &mut rows[start..start + WIDTH];
                    // of the diagonal block only the lower half is stored
                    for l in 0..WIDTH {
                        row[l] += entries[b][l];
                    }
                }
            }
        }
    }

    pub(super) fn right_row(&mut self, line: usize, column: usize) -> &mut [f64] {
        let (m, own, line) = (self.shape.basis[1], self.own_lines(), line - self.origin);
        if line < own {
            &mut self.right[line * m + column..(line + 1) * m]
        } else {
            &mut self.overlap.right[(line - own) * m + column..(line - own + 1) * m]
        }
    }
}
