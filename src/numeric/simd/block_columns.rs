//! The inner loops of a banded Cholesky factorisation by block columns.
//!
//! A block column holds `width` columns of L, each with `height` rows from the block's own diagonal downwards. It is stored
//! in panels of eight rows: the eight rows of one column are one cache line, and the columns of a panel follow one another.
//!
//! ```text
//! C -= sum_r A_r B_r'     A_r, B_r: rows of the block column r blocks to the left, from C's first row on
//! C = L C_11^(-T)         the block's own triangle, then everything below it
//! ```
//!
//! The factor is written in the order in which it is read, so nothing needs to be packed. A tile of C stays in registers
//! over all its updates; A is loaded by whole registers from three streams, B by single numbers from a fourth, which is
//! 11 loads for 24 multiply-adds. Column c ends at row `c + reach`, so the sums for a tile far down begin with the first
//! column that reaches it.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Extra numbers to allocate, so that the first block can begin at the start of a cache line.
pub const PADDING: usize = PANEL - 1;
/// Widths and heights are multiples of this: three panels, the rows of a tile.
pub const GRAIN: usize = 3 * PANEL;
/// Rows of a panel.
pub(super) const PANEL: usize = 8;

/// Shape of one block column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockShape {
    /// Columns, a multiple of [`GRAIN`].
    pub width: usize,
    /// Rows from the block's diagonal on, a multiple of [`GRAIN`].
    pub height: usize,
    /// Column c is zero below row `c + reach`.
    pub reach: usize,
}

impl BlockShape {
    /// Numbers in one block column.
    pub(crate) fn len(self) -> usize {
        self.width * self.height
    }

    /// Position of this entry in the block.
    #[inline(always)]
    pub(crate) fn place(self, row: usize, column: usize) -> usize {
        (row / PANEL * self.width + column) * PANEL + row % PANEL
    }

    /// The cache lines of columns `from .. to` of the panel that holds `row`.
    #[inline(always)]
    pub(super) fn panel(self, block: &[f64], row: usize, from: usize, to: usize) -> &[[f64; PANEL]] {
        let start = row / PANEL * self.width;
        &block.as_chunks::<PANEL>().0[start + from..][..to - from]
    }

    /// The first column that reaches `row`.
    #[inline(always)]
    pub(super) fn first_column(self, row: usize) -> usize {
        row.saturating_sub(self.reach).min(self.width)
    }
}

/// `c -= sum_k A[left.., k] A[right.., k]` over the columns of A from the first that reaches row `left` to before `to`.
#[inline(always)]
fn accumulate<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    c: &mut [[V; COLUMNS]; ROWS],
    shape: BlockShape,
    source: &[f64],
    [left, right]: [usize; 2],
    to: usize,
) {
    let from = shape.first_column(left.max(right)).min(to);
    let mut rows: [&[[f64; PANEL]]; ROWS] = [&[]; ROWS];
    for v in 0..ROWS {
        rows[v] = shape.panel(source, left + v * V::N, from, to);
    }
    let factors = shape.panel(source, right, from, to);
    for k in 0..to - from {
        let mut a = [V::splat(0.0); ROWS];
        for v in 0..ROWS {
            a[v] = V::load(&rows[v][k][(left + v * V::N) % PANEL..]);
        }
        let factors = &factors[k][right % PANEL..][..COLUMNS];
        for j in 0..COLUMNS {
            let factor = V::splat(factors[j]);
            for v in 0..ROWS {
                c[v][j] = a[v].neg_mul_add(factor, c[v][j]);
            }
        }
    }
}

#[inline(always)]
fn load_tile<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    shape: BlockShape,
    block: &[f64],
    [row, column]: [usize; 2],
) -> [[V; COLUMNS]; ROWS] {
    // loops and not closures, because a closure does not carry the instruction set
    let mut c = [[V::splat(0.0); COLUMNS]; ROWS];
    for v in 0..ROWS {
        let lines = shape.panel(block, row + v * V::N, column, column + COLUMNS);
        for j in 0..COLUMNS {
            c[v][j] = V::load(&lines[j][(row + v * V::N) % PANEL..]);
        }
    }
    c
}

#[inline(always)]
fn store_tile<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    c: &[[V; COLUMNS]; ROWS],
    shape: BlockShape,
    block: &mut [f64],
    [row, column]: [usize; 2],
) {
    for v in 0..ROWS {
        let start = shape.place(row + v * V::N, column);
        let lines = &mut block[start..][..(COLUMNS - 1) * PANEL + V::N];
        for j in 0..COLUMNS {
            c[v][j].store(&mut lines[j * PANEL..]);
        }
    }
}

/// Updates the tiles of `target` that begin in `row`. `blocks` are the sources, the nearest last; `gap` blocks lie between
/// the nearest source and the target.
#[inline(always)]
fn update_rows<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    shape: BlockShape,
    blocks: &[f64],
    gap: usize,
    target: &mut [f64],
    row: usize,
) {
    let count = blocks.len() / shape.len() + gap;
    for column in (0..shape.width.min(row + ROWS * V::N)).step_by(COLUMNS) {
        let mut c = load_tile::<V, ROWS, COLUMNS>(shape, target, [row, column]);
        for (b, block) in blocks.chunks_exact(shape.len()).enumerate() {
            let offset = (count - b) * shape.width;
            if offset + row < shape.height {
                accumulate(&mut c, shape, block, [offset + row, offset + column], shape.width);
            }
        }
        store_tile(&c, shape, target, [row, column]);
    }
}

/// Numbers of source blocks that stay in the caches, beside the target, while they are used for all tiles.
const CACHED: usize = 1 << 16;

#[inline(always)]
fn update<V: Lanes>(shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]) {
    let total = blocks.len() / shape.len();
    let together = (CACHED / shape.len()).max(1);
    for (k, group) in blocks.chunks(together * shape.len()).enumerate() {
        let gap = gap + total - k * together - group.len() / shape.len();
        // the nearest source ends there
        let end = shape.height.saturating_sub((gap + 1) * shape.width);
        // near the diagonal panel by panel, so that nothing is computed above it; registers of eight lanes have room for
        // 24 sums, those of four lanes for 12
        for row in (0..shape.width.min(end)).step_by(PANEL) {
            if V::N == PANEL {
                update_rows::<V, 1, 8>(shape, group, gap, target, row);
            } else {
                update_rows::<V, 2, 4>(shape, group, gap, target, row);
            }
        }
        for row in (shape.width..end).step_by(3 * V::N) {
            if V::N == PANEL {
                update_rows::<V, 3, 8>(shape, group, gap, target, row);
            } else {
                update_rows::<V, 3, 4>(shape, group, gap, target, row);
            }
        }
    }
}

/// The triangle of eight columns on the diagonal, and the reciprocals of its diagonal.
struct Triangle {
    entries: [[f64; PANEL]; PANEL],
    inverse: [f64; PANEL],
    smallest: f64,
}

/// Factors the updated triangle of the columns from `at` on. `Err(column)` for a bad pivot.
#[inline(always)]
fn factor_triangle(shape: BlockShape, block: &mut [f64], at: usize) -> Result<Triangle, usize> {
    let mut made = Triangle { entries: [[0.0; PANEL]; PANEL], inverse: [0.0; PANEL], smallest: f64::INFINITY };
    let entries = &mut made.entries;
    for j in 0..PANEL {
        let column = &mut block[shape.place(at, at + j)..][..PANEL];
        let mut pivot = column[j];
        for k in 0..j {
            pivot -= entries[j][k] * entries[j][k];
        }
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(at + j);
        }
        made.smallest = f64::min(made.smallest, pivot);
        entries[j][j] = pivot.sqrt();
        made.inverse[j] = 1.0 / entries[j][j];
        for i in j + 1..PANEL {
            let mut sum = column[i];
            for k in 0..j {
                sum -= entries[i][k] * entries[j][k];
            }
            entries[i][j] = sum * made.inverse[j];
        }
        for i in j..PANEL {
            column[i] = entries[i][j];
        }
    }
    Ok(made)
}

/// Finishes some rows below the triangle of the eight columns from `at` on: subtracts the products of the block's earlier
/// columns and solves with the triangle.
#[inline(always)]
fn finish_rows<V: Lanes, const ROWS: usize>(
    shape: BlockShape,
    block: &mut [f64],
    [row, at]: [usize; 2],
    triangle: &Triangle,
) {
    // the tile is stored before it is solved: otherwise it would not stay in registers while it is summed
    let mut c = load_tile::<V, ROWS, PANEL>(shape, block, [row, at]);
    accumulate(&mut c, shape, block, [row, at], at);
    store_tile(&c, shape, block, [row, at]);
    for row in (row..row + ROWS * V::N).step_by(V::N) {
        let [mut x] = load_tile::<V, 1, PANEL>(shape, block, [row, at]);
        for j in 0..PANEL {
            let mut sum = x[j];
            for k in 0..j {
                sum = x[k].neg_mul_add(V::splat(triangle.entries[j][k]), sum);
            }
            x[j] = sum * V::splat(triangle.inverse[j]);
        }
        store_tile(&[x], shape, block, [row, at]);
    }
}

#[inline(always)]
fn factor<V: Lanes>(shape: BlockShape, block: &mut [f64]) -> Result<f64, usize> {
    let mut smallest = f64::INFINITY;
    for at in (0..shape.width).step_by(PANEL) {
        for row in (at..at + PANEL).step_by(V::N) {
            let mut c = load_tile::<V, 1, PANEL>(shape, block, [row, at]);
            accumulate(&mut c, shape, block, [row, at], at);
            store_tile(&c, shape, block, [row, at]);
        }
        let triangle = factor_triangle(shape, block, at)?;
        smallest = smallest.min(triangle.smallest);
        for row in (at + PANEL..shape.width).step_by(V::N) {
            finish_rows::<V, 1>(shape, block, [row, at], &triangle);
        }
        let end = shape.height.min(at + PANEL + shape.reach);
        for row in (shape.width..end).step_by(if V::N == PANEL { GRAIN } else { V::N }) {
            if V::N == PANEL {
                finish_rows::<V, 3>(shape, block, [row, at], &triangle);
            } else {
                finish_rows::<V, 1>(shape, block, [row, at], &triangle);
            }
        }
    }
    Ok(smallest)
}

/// `target -= sum A_r B_r'` over `blocks`, all of one shape, of which the last is `gap + 1` blocks left of the target.
pub fn update_block(isa: Isa, shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]) {
    dispatch!(isa, update [](shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]));
}

/// Factors an updated block column in place; its smallest squared pivot, or the column whose pivot is not positive.
///
/// # Errors
/// `Err(column)`, counted from the block's first.
pub fn factor_block(isa: Isa, shape: BlockShape, block: &mut [f64]) -> Result<f64, usize> {
    dispatch!(isa, factor [](shape: BlockShape, block: &mut [f64]) -> Result<f64, usize>)
}

#[cfg(test)]
mod tests {
    use super::super::{Twins, backward_block, forward_block};
    use super::*;

    /// Twin: the textbook's dense Cholesky of a banded matrix, by the definition.
    fn dense_cholesky(a: &[f64], n: usize) -> Vec<f64> {
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                let rest = a[i * n + j] - dot;
                l[i * n + j] = if i == j { rest.sqrt() } else { rest / l[j * n + j] };
            }
        }
        l
    }

    #[test]
    fn every_isa_factors_and_solves_as_the_dense_twin() {
        let (n, band) = (96, 27);
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in i.saturating_sub(band)..=i {
                let value = if i == j { 9.0 } else { ((i * 31 + j * 7) as f64 * 0.61).sin() * 0.4 };
                a[i * n + j] = value;
                a[j * n + i] = value;
            }
        }
        let expected = dense_cholesky(&a, n);
        let shape = BlockShape { width: 24, height: 72, reach: band };
        for isa in Isa::available() {
            let mut blocks = vec![0.0; n / 24 * shape.len()];
            let mut v: Vec<f64> = (0..n + 72).map(|i| if i < n { (i as f64).cos() } else { 0.0 }).collect();
            let right = v.clone();
            for b in 0..n / 24 {
                let (done, rest) = blocks.split_at_mut(b * shape.len());
                let block = &mut rest[..shape.len()];
                for c in 0..24 {
                    for r in c..=(c + band).min(n - b * 24 - 1) {
                        block[shape.place(r, c)] = a[(b * 24 + r) * n + b * 24 + c];
                    }
                }
                // beyond the end of the matrix rows stay zero
                update_block(isa, shape, &done[b.saturating_sub(3) * shape.len()..], 0, block);
                factor_block(isa, shape, block).unwrap();
                forward_block(isa, shape, block, &mut v[b * 24..b * 24 + 72]);
            }
            for b in (0..n / 24).rev() {
                backward_block(
                    isa,
                    shape,
                    &blocks[b * shape.len()..(b + 1) * shape.len()],
                    &mut v[b * 24..b * 24 + 72],
                );
            }
            let [mut factor, mut solution] = ["factor_block", "backward_block"].map(|kernel| Twins::new(kernel, isa));
            for i in 0..n {
                for j in i.saturating_sub(band)..=i {
                    let found = blocks[j / 24 * shape.len() + shape.place(i - j / 24 * 24, j % 24)];
                    factor.compare(found, expected[i * n + j]);
                }
                let product: f64 = (0..n).map(|k| a[i * n + k] * v[k]).sum();
                solution.compare(product, right[i]);
            }
            factor.hold(16.0);
            solution.hold(64.0);
            let mut bad = vec![0.0; shape.len()];
            bad[0] = 1.0;
            assert_eq!(factor_block(isa, shape, &mut bad), Err(1));
        }
    }
}
