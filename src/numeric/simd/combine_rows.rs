//! `row[d L + a] = sum_k g_k[d] p_k[a]`: one row of equations for a parametric surface, from the derivatives g of a residual
//! by the vectors of a jet (the surface's point and derivatives) and the products p of basis functions.
//!
//! These are plain loops, which the compiler vectorises for each instruction set.

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// One term: direction and products.
pub type RowTerm<'a> = ([f64; 3], &'a [f64]);

#[inline(always)]
fn generic<V: Lanes>(local: usize, terms: &[RowTerm<'_>], row: &mut [f64]) {
    let _ = V::N;
    let Some(((direction, products), more)) = terms.split_first() else { return };
    let (x, rest) = row.split_at_mut(local);
    let (y, rest) = rest.split_at_mut(local);
    let z = &mut rest[..local];
    let products = &products[..local];
    for a in 0..local {
        x[a] = direction[0] * products[a];
        y[a] = direction[1] * products[a];
        z[a] = direction[2] * products[a];
    }
    for (direction, products) in more {
        let products = &products[..local];
        for a in 0..local {
            x[a] += direction[0] * products[a];
            y[a] += direction[1] * products[a];
            z[a] += direction[2] * products[a];
        }
    }
}

/// Overwrites the first `3 local` numbers of `row`.
///
/// # Panics
/// When `row` or the products of a term are shorter than that.
pub fn combine_rows(isa: Isa, local: usize, terms: &[RowTerm<'_>], row: &mut [f64]) {
    dispatch!(isa, generic [](local: usize, terms: &[RowTerm<'_>], row: &mut [f64]))
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    #[test]
    fn every_isa_agrees_with_the_formula() {
        let products: Vec<f64> = (0..48).map(|k| (k as f64 * 1.3).sin()).collect();
        for local in [4, 9, 16] {
            let directions = [[1.0, -0.5, 0.25], [0.3, 0.7, -2.0], [-1.0, 0.1, 0.9]];
            let terms: Vec<RowTerm<'_>> =
                directions.iter().enumerate().map(|(k, d)| (*d, &products[16 * k..16 * k + local])).collect();
            for isa in Isa::available() {
                let mut row = vec![9.0; 3 * local];
                combine_rows(isa, local, &terms, &mut row);
                let mut twins = Twins::new("combine_rows", isa);
                for (k, value) in row.iter().enumerate() {
                    let expected: f64 = terms.iter().map(|(g, p)| g[k / local] * p[k % local]).sum();
                    twins.compare(*value, expected);
                }
                twins.hold(2.0);
            }
        }
    }
}
