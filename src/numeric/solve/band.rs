//! Cholesky of a tensor spline's normal matrix as a band, eliminated from both ends at once.
//!
//! ```text
//!     [ A_l  B'        ]      unknowns i m + j, half-width p m + q
//! A = [ B    A_m   C'  ]      S = A_m - B A_l^-1 B' - C A_r^-1 C'
//!     [      C     A_r ]
//! ```
//!
//! The left part is eliminated forwards and the right part backwards, by reversing its numbering, until a middle as wide
//! as the band is left. The work is that of one band factorisation, but the two parts are independent of each other, so
//! two threads take one each, and the bits do not depend on the number of threads.

use super::numbering::Numbering;
use crate::linalg::{StencilMatrix, TensorShape};
use crate::simd::{BlockShape, GRAIN, Isa, PADDING, backward_block, factor_block, forward_block, update_block};

/// Columns eliminated at once. With 48 a tile's sums stay in registers over long runs. 72 is no faster, and the number of
/// zeros that a block stores grows with it: at 17,161 unknowns one end would exceed the 32 MB above which an allocator gets
/// new memory from the system each time, and page faults would take an eighth of a fit.
pub(super) const WIDTH: usize = 48;
/// Bytes.
const CACHE_LINE: usize = 64;

/// One end of the band, or the middle.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// Block columns, one after the other; the first begins at the start of a cache line.
    memory: Vec<f64>,
    start: usize,
    /// Number of block columns when all are filled.
    pub(super) count: usize,
    vector: Vec<f64>,
}

/// A reusable band factorisation of `D A D` for one shape.
#[derive(Clone, Debug)]
pub(super) struct BandCholesky {
    /// Number of unknowns eliminated from each end (0: all unknowns are in the middle), and of those in the middle.
    pub(super) end: usize,
    pub(super) middle: usize,
    pub(super) end_block: BlockShape,
    pub(super) middle_block: BlockShape,
    pub(super) left: Part,
    pub(super) right: Part,
    pub(super) centre: Part,
}

/// Half-width of the band.
fn half_width(shape: TensorShape) -> usize {
    shape.degree[0] * shape.basis[1] + shape.degree[1]
}

/// Number of products of the factorisation, and of sums: n w^2 / 2 of each.
pub(super) fn band_flops(shape: TensorShape) -> f64 {
    shape.unknowns() as f64 * (half_width(shape) as f64).powi(2)
}

impl BandCholesky {
    /// Plans the factorisation of every matrix of this shape.
    pub(super) fn plan(shape: TensorShape) -> BandCholesky {
        let (order, band) = (shape.unknowns(), half_width(shape).min(shape.unknowns() - 1));
        // with fewer unknowns than four half-widths the middle would be most of the matrix
        let end = if order >= 4 * band { (order - band) / 2 / WIDTH * WIDTH } else { 0 };
        let middle = order - 2 * end;
        let end_block = BlockShape { width: WIDTH, height: (WIDTH + band).next_multiple_of(GRAIN), reach: band };
        // after the elimination of both ends the middle is a full matrix
        let full = middle.next_multiple_of(WIDTH);
        let middle_block = if end == 0 { end_block } else { BlockShape { height: full, reach: full, ..end_block } };
        let mut made = BandCholesky {
            end,
            middle,
            end_block,
            middle_block,
            left: Part::default(),
            right: Part::default(),
            centre: Part::default(),
        };
        let middle_blocks = middle.div_ceil(WIDTH);
        if end > 0 {
            for part in [&mut made.left, &mut made.right] {
                // blocks are filled when the elimination gets to them, which saves a pass over the memory
                part.reserve(end / WIDTH + middle_blocks, end_block);
                part.vector = vec![0.0; order + end_block.height];
            }
        }
        made.centre.reserve(middle_blocks, middle_block);
        made.centre.vector = vec![0.0; middle_blocks * WIDTH + middle_block.height];
        made
    }

    /// Numbers stored.
    pub(super) fn entries(&self) -> usize {
        2 * self.left.count * self.end_block.len() + self.centre.count * self.middle_block.len()
    }

    /// Factors `D A D` and solves for `v` in the same pass: `v <- (D A D)^-1 v`. Returns the smallest squared pivot.
    ///
    /// # Errors
    /// The unknown at which a pivot is not positive.
    pub(super) fn factor_and_solve(
        &mut self,
        matrix: &StencilMatrix,
        scale: &[f64],
        v: &mut [f64],
    ) -> Result<f64, usize> {
        let isa = Isa::active();
        let smallest = self.eliminate_ends(isa, matrix, scale, v)?;
        self.gather_middle(matrix, scale, v);
        let smallest = smallest.min(self.factor_middle(isa)?);
        self.substitute_back(isa, v);
        Ok(smallest)
    }

    /// Factors `D A D`. Returns the smallest squared pivot.
    ///
    /// # Errors
    /// As [`BandCholesky::factor_and_solve`].
    pub(super) fn factor(&mut self, matrix: &StencilMatrix, scale: &[f64]) -> Result<f64, usize> {
        let mut nothing = vec![0.0; matrix.order()];
        self.factor_and_solve(matrix, scale, &mut nothing)
    }

    fn eliminate_ends(&mut self, isa: Isa, matrix: &StencilMatrix, scale: &[f64], v: &[f64]) -> Result<f64, usize> {
        if self.end == 0 {
            return Ok(f64::INFINITY);
        }
        let (order, end, block) = (matrix.order(), self.end, self.end_block);
        let (left, right) = (&mut self.left, &mut self.right);
        left.vector.fill(0.0);
        right.vector.fill(0.0);
        left.vector[..end].copy_from_slice(&v[..end]);
        for (target, value) in right.vector[..end].iter_mut().zip(v.iter().rev()) {
            *target = *value;
        }
        let forwards = Numbering { matrix, scale, reversed: false };
        let backwards = Numbering { matrix, scale, reversed: true };
        let products = end * block.reach * block.reach;
        let (a, b) = crate::threads::join_if_long(
            products,
            || left.eliminate(isa, block, end, &forwards),
            || right.eliminate(isa, block, end, &backwards),
        );
        Ok(a?.min(b.map_err(|unknown| order - 1 - unknown)?))
    }

    /// Fills the middle with its own entries less the products of both ends, and likewise its right-hand side.
    fn gather_middle(&mut self, matrix: &StencilMatrix, scale: &[f64], v: &[f64]) {
        let (end, middle, block) = (self.end, self.middle, self.middle_block);
        let numbering = Numbering { matrix, scale, reversed: false };
        self.centre.vector.fill(0.0);
        self.centre.vector[..middle].copy_from_slice(&v[end..end + middle]);
        self.centre.memory.clear();
        for b in 0..self.centre.count {
            self.centre.memory.resize(self.centre.start + (b + 1) * block.len(), 0.0);
            let columns = self.centre.block_mut(b, block);
            for c in 0..WIDTH {
                let unknown = b * WIDTH + c;
                if unknown >= middle {
                    // the last block is completed by columns of the identity
                    columns[block.place(c, c)] = 1.0;
                    continue;
                }
                let below = middle - b * WIDTH;
                numbering.column(end + unknown, |offset, value| {
                    if c + offset < below {
                        columns[block.place(c + offset, c)] = value;
                    }
                });
            }
        }
        if end > 0 {
            self.take_from_ends();
        }
    }

    /// Adds to the middle what both ends have accumulated in their last blocks. The left end has the order of the middle,
    /// the right end the reversed one.
    fn take_from_ends(&mut self) {
        let (end, middle, block, ends) = (self.end, self.middle, self.middle_block, self.end_block);
        for k in 0..middle {
            self.centre.vector[k] += self.left.vector[end + k] + self.right.vector[end + middle - 1 - k];
        }
        for b in 0..self.centre.count {
            // an entry has the same place in blocks of either height, because their widths are equal; beyond the middle
            // both hold zeros
            let from_left = self.left.block(end / WIDTH + b, ends);
            self.centre.block_mut(b, block).iter_mut().zip(from_left).for_each(|(t, l)| *t += l);
        }
        for j in 0..middle {
            // column j of the reversed middle is row `middle - 1 - j` of the middle
            let (b, c) = (j / WIDTH, j % WIDTH);
            let from_right = self.right.block(end / WIDTH + b, ends);
            let row = middle - 1 - j;
            for r in c..(middle - b * WIDTH).min(c + ends.reach + 1) {
                let column = row + c - r;
                let target = self.centre.block_mut(column / WIDTH, block);
                target[block.place(row - column / WIDTH * WIDTH, column % WIDTH)] += from_right[ends.place(r, c)];
            }
        }
    }

    fn factor_middle(&mut self, isa: Isa) -> Result<f64, usize> {
        let block = self.middle_block;
        let reach = (block.height - 1) / WIDTH;
        let mut smallest = f64::INFINITY;
        for b in 0..self.centre.count {
            let Part { memory, start, vector, .. } = &mut self.centre;
            let (done, rest) = memory[*start..].split_at_mut(b * block.len());
            let target = &mut rest[..block.len()];
            update_block(isa, block, &done[b.saturating_sub(reach) * block.len()..], 0, target);
            let pivot = factor_block(isa, block, target).map_err(|c| self.end + b * WIDTH + c)?;
            smallest = smallest.min(pivot);
            forward_block(isa, block, target, &mut vector[b * WIDTH..b * WIDTH + block.height]);
        }
        Ok(smallest)
    }

    fn substitute_back(&mut self, isa: Isa, v: &mut [f64]) {
        let (end, middle, block) = (self.end, self.middle, self.middle_block);
        for b in (0..self.centre.count).rev() {
            let Part { memory, start, vector, .. } = &mut self.centre;
            let columns = &memory[*start + b * block.len()..][..block.len()];
            backward_block(isa, block, columns, &mut vector[b * WIDTH..b * WIDTH + block.height]);
        }
        v[end..end + middle].copy_from_slice(&self.centre.vector[..middle]);
        if end == 0 {
            return;
        }
        for k in 0..middle {
            self.left.vector[end + k] = v[end + k];
            self.right.vector[end + k] = v[end + middle - 1 - k];
        }
        let ends = self.end_block;
        let [mut left, mut right] = [&mut self.left, &mut self.right].map(|part| std::mem::take(&mut part.vector));
        crate::threads::join_if_long(
            end * ends.reach,
            || self.left.back(isa, ends, end, &mut left),
            || self.right.back(isa, ends, end, &mut right),
        );
        v[..end].copy_from_slice(&left[..end]);
        v[end + middle..].iter_mut().rev().zip(&right[..end]).for_each(|(target, value)| *target = *value);
        (self.left.vector, self.right.vector) = (left, right);
    }

    /// `v <- (D A D)^-1 v` with the current factor.
    pub(super) fn solve(&self, v: &mut [f64]) {
        let isa = Isa::active();
        let (end, middle) = (self.end, self.middle);
        let mut left = vec![0.0; if end == 0 { 0 } else { self.left.vector.len() }];
        let mut right = left.clone();
        let mut centre = vec![0.0; self.centre.vector.len()];
        centre[..middle].copy_from_slice(&v[end..end + middle]);
        let ends = self.end_block;
        if end > 0 {
            left[..end].copy_from_slice(&v[..end]);
            right[..end].iter_mut().zip(v.iter().rev()).for_each(|(t, s)| *t = *s);
            crate::threads::join_if_long(
                end * ends.reach,
                || self.left.forth(isa, ends, end, &mut left),
                || self.right.forth(isa, ends, end, &mut right),
            );
            for k in 0..middle {
                centre[k] += left[end + k] + right[end + middle - 1 - k];
            }
        }
        let block = self.middle_block;
        for b in 0..self.centre.count {
            forward_block(isa, block, self.centre.block(b, block), &mut centre[b * WIDTH..b * WIDTH + block.height]);
        }
        for b in (0..self.centre.count).rev() {
            backward_block(isa, block, self.centre.block(b, block), &mut centre[b * WIDTH..b * WIDTH + block.height]);
        }
        v[end..end + middle].copy_from_slice(&centre[..middle]);
        if end > 0 {
            for k in 0..middle {
                left[end + k] = centre[k];
                right[end + middle - 1 - k] = centre[k];
            }
            crate::threads::join_if_long(
                end * ends.reach,
                || self.left.back(isa, ends, end, &mut left),
                || self.right.back(isa, ends, end, &mut right),
            );
            v[..end].copy_from_slice(&left[..end]);
            v[end + middle..].iter_mut().rev().zip(&right[..end]).for_each(|(t, s)| *t = *s);
        }
    }
}

impl Part {
    /// Reserves memory for `count` blocks without writing to it.
    fn reserve(&mut self, count: usize, shape: BlockShape) {
        self.count = count;
        self.memory = Vec::with_capacity(count * shape.len() + PADDING);
        self.start = self.memory.as_ptr().align_offset(CACHE_LINE).min(PADDING);
    }

    pub(super) fn block(&self, b: usize, shape: BlockShape) -> &[f64] {
        &self.memory[self.start + b * shape.len()..][..shape.len()]
    }

    fn block_mut(&mut self, b: usize, shape: BlockShape) -> &mut [f64] {
        &mut self.memory[self.start + b * shape.len()..][..shape.len()]
    }

    /// Factors the columns before `end`; the columns after it then hold what must be subtracted from the middle.
    fn eliminate(&mut self, isa: Isa, block: BlockShape, end: usize, a: &Numbering<'_>) -> Result<f64, usize> {
        let reach = (block.height - 1) / WIDTH;
        let mut smallest = f64::INFINITY;
        self.memory.clear();
        for b in 0..self.count {
            let vector = &mut self.vector;
            self.memory.resize(self.start + (b + 1) * block.len(), 0.0);
            let (done, target) = self.memory[self.start..].split_at_mut(b * block.len());
            let eliminated = b < end / WIDTH;
            if eliminated {
                for c in 0..WIDTH {
                    a.column(b * WIDTH + c, |offset, value| target[block.place(c + offset, c)] = value);
                }
            }
            let sources = b.saturating_sub(reach)..b.min(end / WIDTH);
            let near = done.get(sources.start * block.len()..sources.end * block.len()).unwrap_or(&[]);
            if near.is_empty() && b > 0 {
                continue;
            }
            update_block(isa, block, near, b - sources.end, target);
            if eliminated {
                smallest = smallest.min(factor_block(isa, block, target).map_err(|c| b * WIDTH + c)?);
                forward_block(isa, block, target, &mut vector[b * WIDTH..b * WIDTH + block.height]);
            }
        }
        Ok(smallest)
    }

    /// `v <- L^-1 v` down to the middle.
    fn forth(&self, isa: Isa, block: BlockShape, end: usize, v: &mut [f64]) {
        for b in 0..end / WIDTH {
            forward_block(isa, block, self.block(b, block), &mut v[b * WIDTH..b * WIDTH + block.height]);
        }
    }

    /// `v <- L'^-1 v` up from the middle.
    fn back(&self, isa: Isa, block: BlockShape, end: usize, v: &mut [f64]) {
        for b in (0..end / WIDTH).rev() {
            backward_block(isa, block, self.block(b, block), &mut v[b * WIDTH..b * WIDTH + block.height]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(shape: TensorShape) -> StencilMatrix {
        let mut a = StencilMatrix::zeros(shape);
        let mut places = Vec::new();
        a.for_each_lower(|row, column, position| places.push((row, column, position)));
        for (row, column, position) in places {
            a.values_mut()[position] =
                if row == column { 30.0 + (row as f64).sin() } else { ((row * 7 + column * 13) as f64).sin() };
        }
        a
    }

    #[test]
    fn solves_what_the_matrix_says_at_every_size() {
        for (basis, degree) in
            [([4, 4], [3, 3]), ([9, 9], [2, 2]), ([67, 9], [3, 3]), ([80, 31], [3, 2]), ([31, 12], [1, 4])]
        {
            let shape = TensorShape { basis, degree };
            let a = matrix(shape);
            let scale: Vec<f64> = a.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
            let right: Vec<f64> = (0..a.order()).map(|k| (k as f64 * 0.7).cos()).collect();
            let mut band = BandCholesky::plan(shape);
            for again in 0..2 {
                let mut v: Vec<f64> = right.iter().zip(&scale).map(|(b, d)| b * d).collect();
                let start = v.clone();
                let pivot = band.factor_and_solve(&a, &scale, &mut v).unwrap();
                assert!(pivot > 0.1 && pivot <= 1.0);
                let mut w = start;
                band.solve(&mut w);
                let x: Vec<f64> = v.iter().zip(&scale).map(|(b, d)| b * d).collect();
                let mut product = vec![0.0; a.order()];
                a.multiply(&x, &mut product);
                for k in 0..a.order() {
                    assert!((product[k] - right[k]).abs() < 1e-12, "{basis:?} {k} round {again}");
                    assert!((v[k] - w[k]).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn a_bad_pivot_is_named_from_either_end() {
        let shape = TensorShape { basis: [60, 9], degree: [2, 2] };
        for unknown in [3, 200, 530] {
            let mut a = matrix(shape);
            let position = a.position(unknown, 0, 2);
            a.values_mut()[position] = 1e-3;
            let found = BandCholesky::plan(shape).factor(&a, &vec![0.1; 540]);
            assert_eq!(found, Err(unknown));
        }
    }

    #[test]
    #[cfg(feature = "threads")]
    fn one_and_two_threads_give_the_same_bits() {
        let shape = TensorShape { basis: [67, 23], degree: [3, 3] };
        let a = matrix(shape);
        let scale = vec![0.2; a.order()];
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut v: Vec<f64> = (0..a.order()).map(|k| (k as f64).sin()).collect();
            pool.install(|| BandCholesky::plan(shape).factor_and_solve(&a, &scale, &mut v)).unwrap();
            v
        };
        assert_eq!(run(1), run(2));
    }
}
