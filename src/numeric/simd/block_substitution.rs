//! Forward and backward substitution with the block columns of a banded Cholesky factor.
//!
//! ```text
//! forward    x = L_11^-1 v_1, then v_2 -= L_21 x          backward    v_1 <- L_11^-T (v_1 - L_21' v_2)
//! ```
//!
//! The blocks are those of [`super::block_columns`], whose test compares both with a dense twin.

use super::block_columns::{BlockShape, PANEL};
use super::lanes::Lanes;
use super::{Isa, dispatch};

/// `v[row..] -= sum_k L[row.., k] x_k` over one panel's columns before `x.len()`, in four independent
/// sums.
#[inline(always)]
fn take_columns<V: Lanes>(shape: BlockShape, block: &[f64], row: usize, x: &[f64], v: &mut [f64]) {
    let from = shape.first_column(row).min(x.len());
    let lines = shape.panel(block, row, from, x.len());
    for half in (0..PANEL).step_by(V::N) {
        let mut sums = [V::splat(0.0); 4];
        let (fours, rest) = lines.as_chunks::<4>();
        let (factors, last) = x[from..].as_chunks::<4>();
        for (lines, factors) in fours.iter().zip(factors) {
            for k in 0..4 {
                sums[k] = V::load(&lines[k][half..]).mul_add(V::splat(factors[k]), sums[k]);
            }
        }
        for (line, factor) in rest.iter().zip(last) {
            sums[0] = V::load(&line[half..]).mul_add(V::splat(*factor), sums[0]);
        }
        let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        (V::load(&v[half..]) - sum).store(&mut v[half..]);
    }
}

#[inline(always)]
fn forward<V: Lanes>(shape: BlockShape, block: &[f64], v: &mut [f64]) {
    let (own, below) = v[..shape.height].split_at_mut(shape.width);
    for at in (0..shape.width).step_by(PANEL) {
        let (before, here) = own.split_at_mut(at);
        take_columns::<V>(shape, block, at, before, here);
        for (j, column) in shape.panel(block, at, at, at + PANEL).iter().enumerate() {
            let value = here[j] / column[j];
            here[j] = value;
            for i in j + 1..PANEL {
                here[i] -= value * column[i];
            }
        }
    }
    for (k, rows) in below.chunks_exact_mut(PANEL).enumerate() {
        take_columns::<V>(shape, block, shape.width + k * PANEL, own, rows);
    }
}

/// `sums[k] += L[row.., k] v[row..]`, lane by lane, over one panel's columns before `to`.
#[inline(always)]
fn gather_columns<V: Lanes>(
    shape: BlockShape,
    block: &[f64],
    [row, to]: [usize; 2],
    v: &[f64],
    sums: &mut [[f64; PANEL]],
) {
    let from = shape.first_column(row).min(to);
    for (line, sum) in shape.panel(block, row, from, to).iter().zip(&mut sums[from..to]) {
        for half in (0..PANEL).step_by(V::N) {
            V::load(&line[half..]).mul_add(V::load(&v[half..]), V::load(&sum[half..])).store(&mut sum[half..]);
        }
    }
}

/// Widest block that [`backward_block`] takes.
const WIDEST: usize = 96;

#[inline(always)]
fn backward<V: Lanes>(shape: BlockShape, block: &[f64], v: &mut [f64]) {
    let mut sums = [[0.0; PANEL]; WIDEST];
    let (own, below) = v[..shape.height].split_at_mut(shape.width);
    for (k, rows) in below.chunks_exact(PANEL).enumerate() {
        gather_columns::<V>(shape, block, [shape.width + k * PANEL, shape.width], rows, &mut sums);
    }
    for at in (0..shape.width).step_by(PANEL).rev() {
        let here = &mut own[at..at + PANEL];
        for (j, column) in shape.panel(block, at, at, at + PANEL).iter().enumerate().rev() {
            let mut dot = 0.0;
            for half in sums[at + j].chunks_exact(V::N) {
                dot += V::load(half).sum();
            }
            for i in j + 1..PANEL {
                dot += column[i] * here[i];
            }
            here[j] = (here[j] - dot) / column[j];
        }
        gather_columns::<V>(shape, block, [at, at], here, &mut sums);
    }
}

/// `v <- L^-1 v` for one block column: solves for the block's own unknowns, then subtracts their products from those
/// below. `v` starts at the block's first unknown and has `height` numbers.
pub fn forward_block(isa: Isa, shape: BlockShape, block: &[f64], v: &mut [f64]) {
    dispatch!(isa, forward [](shape: BlockShape, block: &[f64], v: &mut [f64]));
}

/// `v <- L^-T v` for one block column, when the unknowns below it are known.
///
/// # Panics
/// When the block is wider than 96 columns.
pub fn backward_block(isa: Isa, shape: BlockShape, block: &[f64], v: &mut [f64]) {
    dispatch!(isa, backward [](shape: BlockShape, block: &[f64], v: &mut [f64]));
}
