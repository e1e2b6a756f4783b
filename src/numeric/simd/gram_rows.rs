//! `G += J' J`, lower triangle, for the few hundred rows J of one cell: the sums of which normal matrices consist.
//!
//! J is row-major with `stride` columns, a multiple of 8; tiles of G stay in registers over all rows.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Rows of G in a tile. With two sets of lanes there are eight sums, enough to hide the latency of multiply-adds.
const TALL: usize = 4;

#[inline(always)]
fn tile<V: Lanes, const SETS: usize>(stride: usize, rows: &[f64], [i, j]: [usize; 2], out: &mut [f64]) {
    let mut sums = [[V::splat(0.0); SETS]; TALL];
    for (a, line) in sums.iter_mut().enumerate() {
        for (k, sum) in line.iter_mut().enumerate() {
            *sum = V::load(&out[(i + a) * stride + j + k * V::N..]);
        }
    }
    for row in rows.chunks_exact(stride) {
        let mut right = [V::splat(0.0); SETS];
        for (k, r) in right.iter_mut().enumerate() {
            *r = V::load(&row[j + k * V::N..]);
        }
        for (line, left) in sums.iter_mut().zip(&row[i..i + TALL]) {
            let left = V::splat(*left);
            for (sum, r) in line.iter_mut().zip(&right) {
                *sum = left.mul_add(*r, *sum);
            }
        }
    }
    for (a, line) in sums.iter().enumerate() {
        for (k, sum) in line.iter().enumerate() {
            sum.store(&mut out[(i + a) * stride + j + k * V::N..]);
        }
    }
}

#[inline(always)]
fn generic<V: Lanes>(stride: usize, rows: &[f64], out: &mut [f64]) {
    for i in (0..stride).step_by(TALL) {
        let mut j = 0;
        while j < i + TALL {
            if j + 2 * V::N <= stride {
                tile::<V, 2>(stride, rows, [i, j], out);
                j += 2 * V::N;
            } else {
                tile::<V, 1>(stride, rows, [i, j], out);
                j += V::N;
            }
        }
    }
}

/// Adds `J' J` to the lower triangle of `out`, `stride` x `stride`; entries above the diagonal have no meaning.
///
/// # Panics
/// When `out` is shorter than that, or `stride` no multiple of 8.
pub fn gram_rows(isa: Isa, stride: usize, rows: &[f64], out: &mut [f64]) {
    assert!(stride.is_multiple_of(8) && out.len() >= stride * stride);
    dispatch!(isa, generic [](stride: usize, rows: &[f64], out: &mut [f64]))
}

/// The safe twin: plain loops.
#[cfg(test)]
fn gram_rows_twin(stride: usize, rows: &[f64], out: &mut [f64]) {
    for row in rows.chunks_exact(stride) {
        for i in 0..stride {
            for j in 0..=i {
                out[i * stride + j] += row[i] * row[j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    #[test]
    fn every_isa_agrees_with_its_twin() {
        for (stride, count) in [(8, 3), (32, 17), (56, 64), (80, 5)] {
            let rows: Vec<f64> = (0..stride * count).map(|r| (r as f64 * 78.233).sin()).collect();
            let mut expected = vec![0.5; stride * stride];
            gram_rows_twin(stride, &rows, &mut expected);
            for isa in Isa::available() {
                let mut made = vec![0.5; stride * stride];
                gram_rows(isa, stride, &rows, &mut made);
                let mut twins = Twins::new("gram_rows", isa);
                for i in 0..stride {
                    for j in 0..=i {
                        twins.compare(made[i * stride + j], expected[i * stride + j]);
                    }
                }
                // at most 65 terms a sum
                twins.hold(8.0);
            }
        }
    }
}
