//! Products of dense matrices that are kept in panels of eight rows, as the band's block columns are.
//!
//! ```text
//! C -= A B'      A rows x inner, B columns x inner      entry (r, k) at (r / 8 stride + k) 8 + r % 8
//! ```
//!
//! Neither factor is packed or transposed: a tile of C stays in registers over the whole inner length, A is loaded by
//! whole registers from three streams and B by single numbers from a fourth.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Rows of a panel.
const PANEL: usize = 8;

/// A part of a matrix in panels, beginning at some panel and column.
#[derive(Clone, Copy, Debug)]
pub struct Panels<'a> {
    /// The numbers, from the first of the part on.
    pub values: &'a [f64],
    /// Columns of a whole panel.
    pub stride: usize,
}

/// Size of a product: the rows of A are a multiple of 24, those of B a multiple of 8.
#[derive(Clone, Copy, Debug)]
pub struct ProductSize {
    /// Rows of A and C.
    pub rows: usize,
    /// Rows of B, columns of C.
    pub columns: usize,
    /// Columns of A and B.
    pub inner: usize,
}

#[inline(always)]
fn tile<V: Lanes, const COLUMNS: usize>(
    [a, b]: [Panels; 2],
    inner: usize,
    [row, column]: [usize; 2],
    c: &mut [f64],
    stride: usize,
) {
    let mut rows: [&[[f64; PANEL]]; 3] = [&[]; 3];
    for v in 0..3 {
        rows[v] = &a.values.as_chunks::<PANEL>().0[(row + v * V::N) / PANEL * a.stride..][..inner];
    }
    let factors = &b.values.as_chunks::<PANEL>().0[column / PANEL * b.stride..][..inner];
    let mut sums = [[V::splat(0.0); COLUMNS]; 3];
    for k in 0..inner {
        let mut x = [V::splat(0.0); 3];
        for v in 0..3 {
            x[v] = V::load(&rows[v][k][(row + v * V::N) % PANEL..]);
        }
        let factors = &factors[k][column % PANEL..][..COLUMNS];
        for j in 0..COLUMNS {
            let factor = V::splat(factors[j]);
            for v in 0..3 {
                sums[v][j] = x[v].mul_add(factor, sums[v][j]);
            }
        }
    }
    for v in 0..3 {
        let start = ((row + v * V::N) / PANEL * stride + column) * PANEL + (row + v * V::N) % PANEL;
        let lines = &mut c[start..][..(COLUMNS - 1) * PANEL + V::N];
        for j in 0..COLUMNS {
            (V::load(&lines[j * PANEL..]) - sums[v][j]).store(&mut lines[j * PANEL..]);
        }
    }
}

#[inline(always)]
fn subtract<V: Lanes>(factors: [Panels; 2], size: ProductSize, c: &mut [f64], stride: usize) {
    for row in (0..size.rows).step_by(3 * V::N) {
        // registers of eight lanes have room for 24 sums, those of four lanes for 12
        if V::N == PANEL {
            for column in (0..size.columns).step_by(8) {
                tile::<V, 8>(factors, size.inner, [row, column], c, stride);
            }
        } else {
            for column in (0..size.columns).step_by(4) {
                tile::<V, 4>(factors, size.inner, [row, column], c, stride);
            }
        }
    }
}

/// `C -= A B'` for the factors `[A, B]`; `c` has `stride` columns in each panel and begins at the product's first entry.
pub fn subtract_product(isa: Isa, factors: [Panels; 2], size: ProductSize, c: &mut [f64], stride: usize) {
    dispatch!(isa, subtract [](factors: [Panels<'_>; 2], size: ProductSize, c: &mut [f64], stride: usize));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    /// Twin: the written sum over the inner index.
    #[test]
    fn every_isa_multiplies_as_the_triple_loop() {
        let size = ProductSize { rows: 48, columns: 24, inner: 37 };
        let strides = [41, 40, 30];
        let at = |stride: usize, r: usize, k: usize| (r / PANEL * stride + k) * PANEL + r % PANEL;
        let filled = |length: usize, seed: f64| -> Vec<f64> { (0..length).map(|k| (k as f64 * seed).sin()).collect() };
        let (a, b, start) = (filled(6 * 41 * 8, 0.7), filled(3 * 40 * 8, 1.3), filled(6 * 30 * 8, 0.4));
        for isa in Isa::available() {
            let mut c = start.clone();
            let factors = [Panels { values: &a, stride: strides[0] }, Panels { values: &b, stride: strides[1] }];
            subtract_product(isa, factors, size, &mut c, strides[2]);
            let mut twins = Twins::new("subtract_product", isa);
            for (i, j) in (0..48 * 30).map(|n| (n / 30, n % 30)) {
                let place = at(strides[2], i, j);
                let product: f64 = (0..37).map(|k| a[at(strides[0], i, k)] * b[at(strides[1], j % 24, k)]).sum();
                twins.compare(c[place], if j < 24 { start[place] - product } else { start[place] });
            }
            twins.hold(8.0);
        }
    }
}
