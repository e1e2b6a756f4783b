//! Rows of one cell, summed into the normal matrix: `A += J' J`, `b += J' t`.
//!
//! ```text
//! [ J t ]' [ J t ]     J: one row per residual, column d L + alpha for coordinate d of coefficient alpha
//!                        of the L nonzero in the cell, t last
//! ```

use super::cells::Row;
use super::vector::Vector;
use palpate_numeric::linalg::{BlockMatrix, GramOfRows};
use palpate_numeric::simd::{Isa, RowTerm, combine_rows};

/// Sums over the rows of one cell, and the buffers that they are made in.
#[derive(Clone, Debug)]
pub(super) struct Gather {
    isa: Isa,
    local: usize,
    gram: GramOfRows,
}

impl Gather {
    /// For cells with `local` nonzero coefficients.
    pub(super) fn new(local: usize) -> Gather {
        let isa = Isa::active();
        Gather { isa, local, gram: GramOfRows::new(isa, 3 * local + 1) }
    }

    /// Begins the next cell.
    pub(super) fn clear(&mut self) {
        self.gram.clear();
    }

    /// Adds the row `sum_k direction_k (x) products_k` with its target.
    #[inline]
    pub(super) fn add(&mut self, terms: &[RowTerm<'_>], target: f64) {
        let row = self.gram.next_row();
        combine_rows(self.isa, self.local, terms, row);
        row[3 * self.local] = target;
    }

    /// Adds `direction (x) products` to the right-hand side alone.
    pub(super) fn add_right(&mut self, direction: Vector, products: &[f64]) {
        let sums = &mut self.gram.sums_mut(3 * self.local)[..3 * self.local];
        for (part, w) in sums.chunks_exact_mut(self.local).zip(direction) {
            part.iter_mut().zip(products).for_each(|(r, p)| *r += w * p);
        }
    }

    /// Multiplies out the rows that are left.
    pub(super) fn finish(&mut self) {
        self.gram.finish();
    }

    /// Adds the cell, whose coefficients have the numbers `alive`, to the matrix and the right-hand side.
    pub(super) fn scatter(&self, alive: &[usize], matrix: &mut BlockMatrix, rhs: &mut [f64]) {
        if self.gram.is_empty() {
            return;
        }
        let local = self.local;
        for (alpha, &row) in alive.iter().enumerate() {
            (0..3).for_each(|d| rhs[3 * row + d] += self.gram.at(3 * local, d * local + alpha));
            for (beta, &column) in alive[..=alpha].iter().enumerate() {
                let at = |a: usize, b: usize| {
                    let (i, j) = (a * local + alpha, b * local + beta);
                    self.gram.at(i.max(j), i.min(j))
                };
                if column <= row {
                    matrix.add(row, column, &[0, 1, 2].map(|a| [0, 1, 2].map(|b| at(a, b))));
                } else {
                    matrix.add(column, row, &[0, 1, 2].map(|a| [0, 1, 2].map(|b| at(b, a))));
                }
            }
        }
    }
}

/// Products of a basis row for several orders of derivatives.
#[derive(Clone, Debug)]
pub(super) struct Products {
    local: usize,
    values: Vec<f64>,
}

impl Products {
    /// For `local` nonzero coefficients and so many orders.
    pub(super) fn new(local: usize, orders: usize) -> Products {
        Products { local, values: vec![0.0; local * orders] }
    }

    /// Fills in the products of `row`.
    pub(super) fn fill(&mut self, row: &Row, orders: &[(usize, usize)]) {
        for (out, order) in self.values.chunks_exact_mut(self.local).zip(orders) {
            row.products(*order, out);
        }
    }

    /// Products of the k-th order.
    #[inline]
    pub(super) fn of(&self, k: usize) -> &[f64] {
        &self.values[k * self.local..(k + 1) * self.local]
    }
}

/// The contacts of every cell, in ascending order.
#[derive(Clone, Debug, Default)]
pub(super) struct Buckets {
    starts: Vec<usize>,
    members: Vec<usize>,
}

impl Buckets {
    /// Sorts the numbers 0, 1, .. by their cells, by counting.
    pub(super) fn new(count: usize, cells: impl Iterator<Item = usize> + Clone) -> Buckets {
        let mut starts = vec![0; count + 1];
        cells.clone().for_each(|cell| starts[cell + 1] += 1);
        (0..count).for_each(|cell| starts[cell + 1] += starts[cell]);
        let mut next = starts.clone();
        let mut members = vec![0; starts[count]];
        for (r, cell) in cells.enumerate() {
            members[next[cell]] = r;
            next[cell] += 1;
        }
        Buckets { starts, members }
    }

    /// Members of one cell.
    pub(super) fn of(&self, cell: usize) -> &[usize] {
        &self.members[self.starts[cell]..self.starts[cell + 1]]
    }
}
