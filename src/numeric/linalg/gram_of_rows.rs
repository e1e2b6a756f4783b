//! `J' J` of rows that come one after another: a few dozen wait, so that a tile of the sums stays in registers over all of them.

use crate::simd::{Isa, gram_rows};

/// Rows that wait: with 56 entries each they fill a first-level cache.
const WAITING: usize = 64;

/// Numbers in a whole set of lanes.
const LANES: usize = 8;

/// Sums over rows of one length.
#[derive(Clone, Debug)]
pub struct GramOfRows {
    isa: Isa,
    stride: usize,
    rows: Vec<f64>,
    waiting: usize,
    gram: Vec<f64>,
    is_empty: bool,
}

impl GramOfRows {
    /// Of no row yet, of so many entries.
    pub fn new(isa: Isa, entries: usize) -> GramOfRows {
        let stride = entries.next_multiple_of(LANES);
        let (rows, gram) = (vec![0.0; WAITING * stride], vec![0.0; stride * stride]);
        GramOfRows { isa, stride, rows, waiting: 0, gram, is_empty: true }
    }

    /// The next row, to be written in full. Entries behind those that it was made for are zero and stay it.
    #[inline(always)]
    pub fn next_row(&mut self) -> &mut [f64] {
        if self.waiting == WAITING {
            self.finish();
        }
        self.is_empty = false;
        self.waiting += 1;
        &mut self.rows[(self.waiting - 1) * self.stride..self.waiting * self.stride]
    }

    /// Adds the rows that wait to the sums.
    pub fn finish(&mut self) {
        if self.waiting > 0 {
            gram_rows(self.isa, self.stride, &self.rows[..self.waiting * self.stride], &mut self.gram);
            self.waiting = 0;
        }
    }

    /// The sum of products of two entries, the first no less than the second, over all rows that wait no longer.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.gram[i * self.stride + j]
    }

    /// The sums of one entry with those up to it, for what is no row.
    pub fn sums_mut(&mut self, i: usize) -> &mut [f64] {
        self.is_empty = false;
        &mut self.gram[i * self.stride..(i + 1) * self.stride]
    }

    /// Whether no row has come since it was made or cleared.
    pub fn is_empty(&self) -> bool {
        self.is_empty
    }

    /// Begins anew.
    pub fn clear(&mut self) {
        self.gram.fill(0.0);
        (self.waiting, self.is_empty) = (0, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_rows_before_and_after_clearing() {
        let entry = |r: usize, k: usize| ((r * 7 + k * 3) as f64).sin();
        let mut sums = GramOfRows::new(Isa::active(), 11);
        for count in [3, WAITING, 2 * WAITING + 5] {
            sums.clear();
            assert!(sums.is_empty());
            for r in 0..count {
                sums.next_row()[..11].iter_mut().enumerate().for_each(|(k, v)| *v = entry(r, k));
            }
            sums.finish();
            for i in 0..11 {
                for j in 0..=i {
                    let expected: f64 = (0..count).map(|r| entry(r, i) * entry(r, j)).sum();
                    assert!((sums.at(i, j) - expected).abs() < 1e-12 * count as f64, "{count}: {i} {j}");
                }
            }
        }
        assert!(!sums.is_empty());
    }
}
