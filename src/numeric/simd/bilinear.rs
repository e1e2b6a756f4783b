//! `out[r] += sum_t (X_t G_t Y_t)[r]`: small dense products by which a cell's moments become its part of the
//! equations.
//!
//! `X_t` is rows x powers, `G_t` powers x 8, `Y_t` 8 x 16; all are padded to whole sets of lanes.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// One term `X G Y`; only the first `powers[0]` rows of G and `powers[1]` rows of Y are read.
#[derive(Clone, Copy, Debug)]
pub struct BilinearTerm<'a> {
    /// X, one row per row of the result.
    pub left: &'a [[f64; 8]],
    /// G.
    pub middle: &'a [[f64; 8]],
    /// Y.
    pub right: &'a [[f64; 16]],
    /// Powers in x and in y.
    pub powers: [usize; 2],
}

#[inline(always)]
fn generic<V: Lanes>(terms: &[BilinearTerm<'_>], out: &mut [[f64; 16]]) {
    let zero = V::splat(0.0);
    for (r, row) in out.iter_mut().enumerate() {
        let mut sums = [zero; 4];
        for k in 0..16 / V::N {
            sums[k] = V::load(&row[k * V::N..]);
        }
        for term in terms {
            let mut half = [0.0; 8];
            for k in 0..8 / V::N {
                let mut sum = zero;
                for a in 0..term.powers[0] {
                    sum = V::splat(term.left[r][a]).mul_add(V::load(&term.middle[a][k * V::N..]), sum);
                }
                sum.store(&mut half[k * V::N..]);
            }
            for (value, right) in half[..term.powers[1]].iter().zip(term.right) {
                for k in 0..16 / V::N {
                    sums[k] = V::splat(*value).mul_add(V::load(&right[k * V::N..]), sums[k]);
                }
            }
        }
        for k in 0..16 / V::N {
            sums[k].store(&mut row[k * V::N..]);
        }
    }
}

/// Adds every term to `out`.
///
/// # Panics
/// When a matrix has fewer rows than its powers.
pub fn bilinear(isa: Isa, terms: &[BilinearTerm<'_>], out: &mut [[f64; 16]]) {
    dispatch!(isa, generic [](terms: &[BilinearTerm<'_>], out: &mut [[f64; 16]]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    /// Twin: the sum as it is written.
    #[test]
    fn every_isa_agrees_with_the_written_sum() {
        let value = |a: usize, b: usize, seed: f64| ((a * 17 + b) as f64 * 0.37 + seed).sin();
        let left: Vec<[f64; 8]> = (0..10).map(|r| std::array::from_fn(|a| value(r, a, 0.3))).collect();
        let middle: Vec<[f64; 8]> = (0..7).map(|a| std::array::from_fn(|b| value(a, b, 1.3))).collect();
        let right: Vec<[f64; 16]> = (0..8).map(|b| std::array::from_fn(|k| value(b, k, 2.3))).collect();
        let term = |powers| BilinearTerm { left: &left, middle: &middle, right: &right, powers };
        let terms = [term([7, 7]), term([5, 8])];
        for isa in Isa::available() {
            let mut out = vec![[0.25; 16]; 10];
            bilinear(isa, &terms, &mut out);
            let mut twins = Twins::new("bilinear", isa);
            for r in 0..10 {
                for k in 0..16 {
                    let mut expected = 0.25;
                    for t in &terms {
                        for a in 0..t.powers[0] {
                            for b in 0..t.powers[1] {
                                expected += left[r][a] * middle[a][b] * right[b][k];
                            }
                        }
                    }
                    twins.compare(out[r][k], expected);
                }
            }
            twins.hold(64.0);
        }
    }
}
