//! `out += sum_t B_t' Z_t`: banded bases against images, one pass over each image.
//!
//! Row i of `B_t` holds `width` values from column `first[i]` on; `Z_t` is n x m, row-major. Rows that share `first`
//! (the pixels of one segment) are summed in registers before they are added to `out` (columns of B x m), so that reading
//! the image is nearly all the memory traffic.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// One term `B' Z`: `values[i * width + a]` is entry `(i, first[i] + a)` of B.
#[derive(Clone, Copy, Debug)]
pub struct BandTerm<'a> {
    /// Values of B, row after row.
    pub values: &'a [f64],
    /// Z, n x m, row-major.
    pub image: &'a [f64],
}

/// Columns `j .. j + SETS * N` of the rows `rows`, all of which start at the same column of B.
#[inline(always)]
fn strip<V: Lanes, const WIDTH: usize, const SETS: usize>(
    rows: std::ops::Range<usize>,
    terms: &[BandTerm<'_>],
    m: usize,
    j: usize,
    out: &mut [f64],
) {
    let mut sums = [[V::splat(0.0); SETS]; WIDTH];
    for (a, sum) in sums.iter_mut().enumerate() {
        for (k, s) in sum.iter_mut().enumerate() {
            *s = V::load(&out[a * m + j + k * V::N..]);
        }
    }
    for i in rows {
        for term in terms {
            let values = &term.values[i * WIDTH..(i + 1) * WIDTH];
            for k in 0..SETS {
                let z = V::load(&term.image[i * m + j + k * V::N..]);
                for a in 0..WIDTH {
                    sums[a][k] = V::splat(values[a]).mul_add(z, sums[a][k]);
                }
            }
        }
    }
    for (a, sum) in sums.iter().enumerate() {
        for (k, s) in sum.iter().enumerate() {
            s.store(&mut out[a * m + j + k * V::N..]);
        }
    }
}

#[inline(always)]
fn generic<V: Lanes, const WIDTH: usize>(first: &[usize], terms: &[BandTerm<'_>], m: usize, out: &mut [f64]) {
    let mut from = 0;
    while from < first.len() {
        let start = first[from];
        let to = from + first[from..].iter().take_while(|f| **f == start).count();
        let target = &mut out[start * m..(start + WIDTH) * m];
        let mut j = 0;
        while j + 2 * V::N <= m {
            strip::<V, WIDTH, 2>(from..to, terms, m, j, target);
            j += 2 * V::N;
        }
        while j + V::N <= m {
            strip::<V, WIDTH, 1>(from..to, terms, m, j, target);
            j += V::N;
        }
        rest(from..to, terms, WIDTH, m, j, target);
        from = to;
    }
}

/// Columns from `j` on, one number at a time.
fn rest(rows: std::ops::Range<usize>, terms: &[BandTerm<'_>], width: usize, m: usize, from: usize, out: &mut [f64]) {
    for i in rows {
        for term in terms {
            for a in 0..width {
                let value = term.values[i * width + a];
                for j in from..m {
                    out[a * m + j] += value * term.image[i * m + j];
                }
            }
        }
    }
}

/// `out += sum_t B_t' Z_t`, `out` (columns of B) x m, row-major.
///
/// # Panics
/// When an array is shorter than its shape.
pub fn contract_rows(isa: Isa, width: usize, first: &[usize], terms: &[BandTerm<'_>], m: usize, out: &mut [f64]) {
    macro_rules! of_width {
        ($w:literal) => {{
            #[inline(always)]
            fn fixed<V: Lanes>(first: &[usize], terms: &[BandTerm<'_>], m: usize, out: &mut [f64]) {
                generic::<V, $w>(first, terms, m, out);
            }
            dispatch!(isa, fixed [](first: &[usize], terms: &[BandTerm<'_>], m: usize, out: &mut [f64]))
        }};
    }
    match width {
        2 => of_width!(2),
        3 => of_width!(3),
        4 => of_width!(4),
        5 => of_width!(5),
        6 => of_width!(6),
        _ => contract_rows_twin(width, first, terms, m, out),
    }
}

/// The safe twin, and the path of degrees above 5: plain loops.
pub(super) fn contract_rows_twin(width: usize, first: &[usize], terms: &[BandTerm<'_>], m: usize, out: &mut [f64]) {
    for (i, &start) in first.iter().enumerate() {
        rest(i..i + 1, terms, width, m, 0, &mut out[start * m..(start + width) * m]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    #[test]
    fn every_isa_agrees_with_its_twin() {
        let noise = |n: usize, seed: f64| -> Vec<f64> { (0..n).map(|r| ((r as f64 + seed) * 78.233).sin()).collect() };
        for (width, m) in [(2, 5), (3, 16), (4, 39), (5, 8), (6, 23), (8, 11)] {
            let first: Vec<usize> = (0..40).map(|i| i / 7).collect();
            let columns = first[39] + width;
            let data: Vec<Vec<f64>> = (0..4).map(|k| noise(40 * m.max(width), k as f64)).collect();
            let terms =
                [BandTerm { values: &data[0], image: &data[1] }, BandTerm { values: &data[2], image: &data[3] }];
            let mut expected = vec![0.5; columns * m];
            contract_rows_twin(width, &first, &terms, m, &mut expected);
            for isa in Isa::available() {
                let mut made = vec![0.5; columns * m];
                contract_rows(isa, width, &first, &terms, m, &mut made);
                let mut twins = Twins::new("contract_rows", isa);
                made.iter().zip(&expected).for_each(|(a, b)| twins.compare(*a, *b));
                twins.hold(32.0);
            }
        }
    }
}
