//! The inner loops of a banded Cholesky factorisation by block columns.
//!
//! A block column holds `width` columns of L, each `height` numbers from the block's own diagonal downwards (column
//! major, `height` a multiple of 8 plus [`PADDING`] rows of zeros, so that whole tiles may be read past the end).
//!
//! ```text
//! C -= sum_r A_r B_r'     A_r, B_r: rows of the block column r blocks to the left, from C's first row on
//! C = L C_11^(-T)         the block's own triangle, then everything below it
//! ```
//!
//! Nothing is packed: a tile of C stays in registers over all its updates, A comes by whole registers and B by single
//! numbers, 11 loads for 24 multiply-adds, so two multipliers are kept busy from the second-level cache.

use super::lanes::Lanes;
use super::{Level, dispatch};

/// Rows of zeros below every block column.
pub const PADDING: usize = 16;
/// Widths and heights are multiples of this.
pub const GRAIN: usize = 8;

/// Shape of one block column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockShape {
    /// Columns, a multiple of [`GRAIN`].
    pub width: usize,
    /// Rows from the block's diagonal on, a multiple of [`GRAIN`], padding not counted.
    pub height: usize,
}

impl BlockShape {
    /// Distance of two columns.
    pub fn stride(self) -> usize {
        self.height + PADDING
    }

    /// Numbers in one block column.
    pub fn len(self) -> usize {
        self.width * self.stride()
    }

    /// No columns at all.
    pub fn is_empty(self) -> bool {
        self.width == 0
    }
}

/// `c -= sum_k A[left.., k] A[right.., k]` over the columns `columns` of A.
#[inline(always)]
fn accumulate<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    c: &mut [[V; COLUMNS]; ROWS],
    columns: &[f64],
    stride: usize,
    left: usize,
    right: usize,
) {
    for values in columns.chunks_exact(stride) {
        let rows = &values[left..][..ROWS * V::N];
        let factors = &values[right..][..COLUMNS];
        let mut a = [V::splat(0.0); ROWS];
        for v in 0..ROWS {
            a[v] = V::load(&rows[v * V::N..]);
        }
        for j in 0..COLUMNS {
            let factor = V::splat(factors[j]);
            for v in 0..ROWS {
                c[v][j] = a[v].neg_mul_add(factor, c[v][j]);
            }
        }
    }
}

/// Which columns update a tile.
#[derive(Clone, Copy)]
enum Sources<'a> {
    /// Whole block columns, the nearest last, `gap` blocks short of the target's neighbour.
    Before { blocks: &'a [f64], gap: usize },
    /// The columns of the block itself that stand left of column `first`, where the target begins.
    Own { columns: &'a [f64], first: usize },
}

/// One tile of `target` at `[row, column]`.
#[inline(always)]
fn tile<V: Lanes, const ROWS: usize, const COLUMNS: usize>(
    shape: BlockShape,
    sources: Sources<'_>,
    target: &mut [f64],
    [row, column]: [usize; 2],
) {
    if let Sources::Before { gap, .. } = sources
        && (gap + 1) * shape.width + row.max(column) >= shape.height
    {
        return; // even the nearest source ends above this tile
    }
    let stride = shape.stride();
    let mut c = [[V::splat(0.0); COLUMNS]; ROWS];
    for j in 0..COLUMNS {
        let from = &target[(column + j) * stride + row..][..ROWS * V::N];
        for v in 0..ROWS {
            c[v][j] = V::load(&from[v * V::N..]);
        }
    }
    match sources {
        Sources::Own { columns, first } => accumulate(&mut c, columns, stride, row, first + column),
        Sources::Before { blocks, gap } => {
            let count = blocks.len() / shape.len() + gap;
            for (b, block) in blocks.chunks_exact(shape.len()).enumerate() {
                let offset = (count - b) * shape.width;
                if offset + row.max(column) < shape.height {
                    accumulate(&mut c, block, stride, offset + row, offset + column);
                }
            }
        }
    }
    for j in 0..COLUMNS {
        let to = &mut target[(column + j) * stride + row..][..ROWS * V::N];
        for v in 0..ROWS {
            c[v][j].store(&mut to[v * V::N..]);
        }
    }
}

/// All tiles of the first `columns` columns of `target`, from the diagonal downwards.
#[inline(always)]
fn tiles<V: Lanes>(shape: BlockShape, sources: Sources<'_>, target: &mut [f64], columns: usize) {
    let left_of_target = if let Sources::Own { first, .. } = sources { first } else { 0 };
    // eight lanes leave room for 24 sums in registers, four lanes for 12
    macro_rules! sized {
        ($rows:literal, $columns:literal) => {
            for column in (0..columns).step_by($columns) {
                let diagonal = left_of_target + column;
                let mut row = diagonal - diagonal % GRAIN;
                while row < shape.height {
                    tile::<V, $rows, $columns>(shape, sources, target, [row, column]);
                    row += $rows * V::N;
                }
            }
        };
    }
    if V::N == 8 { sized!(3, 8) } else { sized!(2, 4) }
}

/// The 8 columns from `at` on, already updated: their triangle, then every row below it. `Err(column)` for a bad pivot.
#[inline(always)]
fn factor_eight<V: Lanes>(shape: BlockShape, block: &mut [f64], at: usize) -> Result<f64, usize> {
    let stride = shape.stride();
    let mut triangle = [[0.0; GRAIN]; GRAIN];
    let mut smallest = f64::INFINITY;
    let mut inverse = [0.0; GRAIN];
    for j in 0..GRAIN {
        let mut pivot = block[(at + j) * stride + at + j];
        for k in 0..j {
            pivot -= triangle[j][k] * triangle[j][k];
        }
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(at + j);
        }
        smallest = f64::min(smallest, pivot);
        triangle[j][j] = pivot.sqrt();
        inverse[j] = 1.0 / triangle[j][j];
        for i in j + 1..GRAIN {
            let mut sum = block[(at + j) * stride + at + i];
            for k in 0..j {
                sum -= triangle[i][k] * triangle[j][k];
            }
            triangle[i][j] = sum * inverse[j];
        }
        for i in j..GRAIN {
            block[(at + j) * stride + at + i] = triangle[i][j];
        }
    }
    for row in (at + GRAIN..shape.height).step_by(V::N) {
        let mut x = [V::splat(0.0); GRAIN];
        for j in 0..GRAIN {
            let place = (at + j) * stride + row;
            let mut sum = V::load(&block[place..]);
            for k in 0..j {
                sum = x[k].neg_mul_add(V::splat(triangle[j][k]), sum);
            }
            x[j] = sum * V::splat(inverse[j]);
            x[j].store(&mut block[place..]);
        }
    }
    Ok(smallest)
}

/// Numbers of source blocks that stay in a second-level cache of 1 MB beside the target, while all tiles go over them.
const CACHED: usize = 1 << 16;

#[inline(always)]
fn update<V: Lanes>(shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]) {
    let total = blocks.len() / shape.len();
    let together = (CACHED / shape.len()).max(1);
    for (k, group) in blocks.chunks(together * shape.len()).enumerate() {
        let nearer = total - k * together - group.len() / shape.len();
        tiles::<V>(shape, Sources::Before { blocks: group, gap: gap + nearer }, target, shape.width);
    }
}

#[inline(always)]
fn factor<V: Lanes>(shape: BlockShape, block: &mut [f64]) -> Result<f64, usize> {
    let mut smallest = f64::INFINITY;
    for at in (0..shape.width).step_by(GRAIN) {
        let (done, rest) = block.split_at_mut(at * shape.stride());
        if at > 0 {
            tiles::<V>(shape, Sources::Own { columns: done, first: at }, rest, GRAIN);
        }
        smallest = smallest.min(factor_eight::<V>(shape, block, at)?);
    }
    Ok(smallest)
}

/// `target -= sum A_r B_r'` over `blocks`, all of one shape, of which the last is `gap + 1` blocks left of the target.
pub fn update_block(level: Level, shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]) {
    dispatch!(level, update [](shape: BlockShape, blocks: &[f64], gap: usize, target: &mut [f64]));
}

/// Factors an updated block column in place; its smallest squared pivot, or the column whose pivot is not positive.
///
/// # Errors
/// `Err(column)`, counted from the block's first.
pub fn factor_block(level: Level, shape: BlockShape, block: &mut [f64]) -> Result<f64, usize> {
    dispatch!(level, factor [](shape: BlockShape, block: &mut [f64]) -> Result<f64, usize>)
}

#[inline(always)]
fn forward<V: Lanes>(shape: BlockShape, block: &[f64], v: &mut [f64]) {
    for (j, column) in block.chunks_exact(shape.stride()).enumerate() {
        let value = v[j] / column[j];
        v[j] = value;
        let from = (j + 1).next_multiple_of(GRAIN).min(shape.height);
        for i in j + 1..from {
            v[i] -= value * column[i];
        }
        for i in (from..shape.height).step_by(V::N) {
            V::load(&column[i..]).neg_mul_add(V::splat(value), V::load(&v[i..])).store(&mut v[i..]);
        }
    }
}

#[inline(always)]
fn backward<V: Lanes>(shape: BlockShape, block: &[f64], v: &mut [f64]) {
    for (j, column) in block.chunks_exact(shape.stride()).enumerate().rev() {
        let from = (j + 1).next_multiple_of(GRAIN).min(shape.height);
        let mut sums = [V::splat(0.0); 2];
        for (k, i) in (from..shape.height).step_by(V::N).enumerate() {
            sums[k % 2] = V::load(&column[i..]).mul_add(V::load(&v[i..]), sums[k % 2]);
        }
        let mut dot = (sums[0] + sums[1]).sum();
        for i in j + 1..from {
            dot += column[i] * v[i];
        }
        v[j] = (v[j] - dot) / column[j];
    }
}

/// `v <- L^-1 v` for one block column: the block's own unknowns, then what they take from those below. `v` starts at
/// the block's first unknown and has `height` numbers.
pub fn forward_block(level: Level, shape: BlockShape, block: &[f64], v: &mut [f64]) {
    dispatch!(level, forward [](shape: BlockShape, block: &[f64], v: &mut [f64]));
}

/// `v <- L^-T v` for one block column, those below being known.
pub fn backward_block(level: Level, shape: BlockShape, block: &[f64], v: &mut [f64]) {
    dispatch!(level, backward [](shape: BlockShape, block: &[f64], v: &mut [f64]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
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
    fn every_level_factors_and_solves_as_the_dense_twin() {
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
        let shape = BlockShape { width: 16, height: 48 };
        for level in Level::available() {
            let mut blocks = vec![0.0; n / 16 * shape.len()];
            let mut v: Vec<f64> = (0..n + 48).map(|i| if i < n { (i as f64).cos() } else { 0.0 }).collect();
            let right = v.clone();
            for b in 0..n / 16 {
                let (done, rest) = blocks.split_at_mut(b * shape.len());
                let block = &mut rest[..shape.len()];
                for c in 0..16 {
                    for r in c..48.min(n - b * 16) {
                        block[c * shape.stride() + r] = a[(b * 16 + r) * n + b * 16 + c];
                    }
                }
                // beyond the matrix: ones on the diagonal never occur, rows there stay zero
                update_block(level, shape, &done[b.saturating_sub(3) * shape.len()..], 0, block);
                factor_block(level, shape, block).unwrap();
                forward_block(level, shape, block, &mut v[b * 16..b * 16 + 48]);
            }
            for b in (0..n / 16).rev() {
                backward_block(
                    level,
                    shape,
                    &blocks[b * shape.len()..(b + 1) * shape.len()],
                    &mut v[b * 16..b * 16 + 48],
                );
            }
            let [mut factor, mut solution] = ["factor_block", "backward_block"].map(|kernel| Twins::new(kernel, level));
            for i in 0..n {
                for j in i.saturating_sub(band)..=i {
                    let found = blocks[j / 16 * shape.len() + j % 16 * shape.stride() + i - j / 16 * 16];
                    factor.compare(found, expected[i * n + j]);
                }
                let product: f64 = (0..n).map(|k| a[i * n + k] * v[k]).sum();
                solution.compare(product, right[i]);
            }
            factor.hold(16.0);
            solution.hold(64.0);
            let mut bad = vec![0.0; shape.len()];
            bad[0] = 1.0;
            assert_eq!(factor_block(level, shape, &mut bad), Err(1));
        }
    }
}
