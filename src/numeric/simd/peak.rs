//! The machine's multiply-add peak, with which benches compare the kernels: `x <- a x + b` on twelve registers at once. It stands
//! here and not among the benches, because a loop for each instruction set is unsafe code, which this folder alone may hold.
//!
//! ```text
//! x_k = a^k x_0 + b (1 - a^k)/(1 - a)          12 independent chains hide a latency of 4 on two multipliers
//! ```

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Independent chains.
const CHAINS: usize = 12;

#[inline(always)]
fn generic<V: Lanes>(rounds: usize, a: f64, b: f64) -> [f64; 2] {
    let mut sums = [V::splat(1.0); CHAINS];
    let (a, b) = (V::splat(a), V::splat(b));
    for _ in 0..rounds {
        for k in 0..CHAINS {
            sums[k] = sums[k].mul_add(a, b);
        }
    }
    let mut total = 0.0;
    for k in 0..CHAINS {
        total += sums[k].sum();
    }
    [total, (rounds * CHAINS * V::N) as f64]
}

/// The sum of all chains after `rounds` steps from 1, and the number of multiply-adds.
pub fn multiply_add_peak(isa: Isa, rounds: usize, a: f64, b: f64) -> [f64; 2] {
    dispatch!(isa, generic [](rounds: usize, a: f64, b: f64) -> [f64; 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chain_ends_where_the_series_does() {
        for isa in Isa::available() {
            let [total, count] = multiply_add_peak(isa, 9, 0.5, 3.0);
            let chains = count / 9.0;
            // 2^-9 + 6 (1 - 2^-9), exact in binary
            assert_eq!(total, chains * (6.0 - 5.0 / 512.0), "{}", isa.name());
        }
    }
}
