//! Cholesky of a small dense matrix whose order is known to the compiler; the right-hand side is one more row.
//!
//! ```text
//! [ A  b ]     column k: a_ij -= a_ik a_jk / a_kk, l_kk = sqrt(a_kk), l_ik = a_ik / l_kk     i > k, i = n being b:
//! [ b' . ]     after the last column row n holds y = L^-1 b;   then L' x = y from the bottom
//! ```
//!
//! Columns are padded to whole sets of lanes; entries above the diagonal are never read. The inverse, from Z = L^-1:
//!
//! ```text
//! z_j = (e_j - sum_(m<j) l_jm z_m) / l_jj          A^-1 = Z'Z, row u = sum_(i>=u) z_iu z_i          z_j row j of Z
//! ```

use super::lanes::Lanes;
use super::{Isa, dispatch};

/// Columns of a matrix of order N with one more row for the right-hand side; `PADDED > N` is a multiple of 8.
pub type DenseColumns<const N: usize, const PADDED: usize> = [[f64; PADDED]; N];

#[inline(always)]
fn factor<V: Lanes, const N: usize, const PADDED: usize>(columns: &mut DenseColumns<N, PADDED>) -> Result<f64, usize> {
    let mut smallest = f64::INFINITY;
    for k in 0..N {
        let (done, rest) = columns.split_at_mut(k + 1);
        let column = &mut done[k];
        let pivot = column[k];
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(k);
        }
        smallest = f64::min(smallest, pivot);
        // later columns need the reciprocal only, so the square root delays none of them
        let reciprocal = 1.0 / pivot;
        for (j, target) in rest.iter_mut().enumerate() {
            let j = k + 1 + j;
            let factor = V::splat(column[j] * reciprocal);
            for i in (j / V::N * V::N..PADDED).step_by(V::N) {
                V::load(&column[i..]).neg_mul_add(factor, V::load(&target[i..])).store(&mut target[i..]);
            }
        }
        let inverse = V::splat(1.0 / pivot.sqrt());
        for i in (k / V::N * V::N..PADDED).step_by(V::N) {
            (V::load(&column[i..]) * inverse).store(&mut column[i..]);
        }
    }
    Ok(smallest)
}

/// Factors in place; the smallest squared pivot, or the column whose pivot is not positive.
///
/// # Errors
/// `Err(column)`.
pub fn factor_columns<const N: usize, const PADDED: usize>(
    isa: Isa,
    columns: &mut DenseColumns<N, PADDED>,
) -> Result<f64, usize> {
    const { assert!(PADDED > N && PADDED.is_multiple_of(8)) };
    dispatch!(isa, factor [N, PADDED](columns: &mut DenseColumns<N, PADDED>) -> Result<f64, usize>)
}

#[inline(always)]
fn invert<V: Lanes, const N: usize, const PADDED: usize>(
    columns: &DenseColumns<N, PADDED>,
    reciprocals: &[f64; N],
) -> DenseColumns<N, PADDED> {
    let [mut z, mut out] = [[[0.0; PADDED]; N]; 2];
    for j in 0..N {
        let (done, rest) = z.split_at_mut(j);
        let row = &mut rest[0];
        row[j] = 1.0;
        for i in (0..=j).step_by(V::N) {
            let mut sum = V::load(&row[i..]);
            // rows above i are zero in these lanes
            for (m, solved) in done.iter().enumerate().skip(i) {
                sum = V::load(&solved[i..]).neg_mul_add(V::splat(columns[m][j]), sum);
            }
            (sum * V::splat(reciprocals[j])).store(&mut row[i..]);
        }
    }
    for (u, row) in out.iter_mut().enumerate() {
        for v in (0..N).step_by(V::N) {
            let mut sum = V::splat(0.0);
            for solved in &z[u.max(v)..] {
                sum = V::load(&solved[v..]).mul_add(V::splat(solved[u]), sum);
            }
            sum.store(&mut row[v..]);
        }
    }
    out
}

/// `(L L')^-1` row by row, from the columns of L that [`factor_columns`] left and the reciprocals of its diagonal;
/// entries beyond N in a row have no meaning.
pub fn invert_columns<const N: usize, const PADDED: usize>(
    isa: Isa,
    columns: &DenseColumns<N, PADDED>,
    reciprocals: &[f64; N],
) -> DenseColumns<N, PADDED> {
    const { assert!(PADDED > N && PADDED.is_multiple_of(8)) };
    dispatch!(isa, invert [N, PADDED](
        columns: &DenseColumns<N, PADDED>,
        reciprocals: &[f64; N],
    ) -> DenseColumns<N, PADDED>)
}

/// Columns that are taken from all later ones at once: a later column is loaded and stored once for four multiply-adds.
const PANEL: usize = 4;

/// Takes column k from the columns behind it, whose numbers begin with that of column `first`.
#[inline(always)]
fn take_one<V: Lanes>(column: &[f64], stride: usize, first: usize, targets: &mut [f64]) {
    for (j, target) in targets.chunks_exact_mut(stride).enumerate() {
        let j = first + j;
        let factor = V::splat(column[j]);
        for i in (j / V::N * V::N..stride).step_by(V::N) {
            V::load(&column[i..]).neg_mul_add(factor, V::load(&target[i..])).store(&mut target[i..]);
        }
    }
}

/// Takes four columns from those behind them, one after the other, as [`take_one`] does.
#[inline(always)]
fn take_panel<V: Lanes>(panel: &[f64], stride: usize, first: usize, targets: &mut [f64]) {
    let mut columns = [panel; PANEL];
    for c in 0..PANEL {
        columns[c] = &panel[c * stride..][..stride];
    }
    for (j, target) in targets.chunks_exact_mut(stride).enumerate() {
        let j = first + j;
        // a closure would not be compiled for the instruction set
        let mut factors = [V::splat(0.0); PANEL];
        for c in 0..PANEL {
            factors[c] = V::splat(columns[c][j]);
        }
        for i in (j / V::N * V::N..stride).step_by(V::N) {
            let mut sum = V::load(&target[i..]);
            for c in 0..PANEL {
                sum = V::load(&columns[c][i..]).neg_mul_add(factors[c], sum);
            }
            sum.store(&mut target[i..]);
        }
    }
}

#[inline(always)]
fn factor_any<V: Lanes>(order: usize, stride: usize, columns: &mut [f64]) -> Result<f64, usize> {
    let mut smallest = f64::INFINITY;
    for start in (0..order).step_by(PANEL) {
        let end = (start + PANEL).min(order);
        let (done, rest) = columns[..order * stride].split_at_mut(end * stride);
        let panel = &mut done[start * stride..];
        for k in start..end {
            let (before, behind) = panel.split_at_mut((k + 1 - start) * stride);
            let column = &mut before[(k - start) * stride..];
            let pivot = column[k];
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(k);
            }
            smallest = f64::min(smallest, pivot);
            let inverse = V::splat(1.0 / pivot.sqrt());
            for i in (k / V::N * V::N..stride).step_by(V::N) {
                (V::load(&column[i..]) * inverse).store(&mut column[i..]);
            }
            take_one::<V>(column, stride, k + 1, behind);
        }
        if end - start == PANEL {
            take_panel::<V>(panel, stride, end, rest);
        }
    }
    Ok(smallest)
}

/// As [`factor_columns`] for any order, with columns one after another, `stride` numbers each, a multiple of 8.
///
/// # Errors
/// `Err(column)`.
///
/// # Panics
/// When `columns` is shorter than its shape, or `stride` no multiple of 8.
pub fn factor_dense(isa: Isa, order: usize, stride: usize, columns: &mut [f64]) -> Result<f64, usize> {
    assert!(stride.is_multiple_of(8) && stride >= order && columns.len() >= order * stride);
    dispatch!(isa, factor_any [](order: usize, stride: usize, columns: &mut [f64]) -> Result<f64, usize>)
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    /// Twin: the textbook's rows, one number at a time.
    fn textbook(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut l = vec![vec![0.0; a.len()]; a.len()];
        for i in 0..a.len() {
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
                l[i][j] = if i == j { (a[i][i] - dot).sqrt() } else { (a[i][j] - dot) / l[j][j] };
            }
        }
        l
    }

    fn check<const N: usize, const PADDED: usize>() {
        let a: Vec<Vec<f64>> = (0..N)
            .map(|i| {
                (0..N).map(|j| if i == j { 30.0 } else { ((i.max(j) * 31 + i.min(j) * 7) as f64).sin() }).collect()
            })
            .collect();
        let b: Vec<f64> = (0..N).map(|i| (i as f64).cos()).collect();
        let expected = textbook(&a);
        for isa in Isa::available() {
            let mut columns = [[0.0; PADDED]; N];
            for j in 0..N {
                (j..N).for_each(|i| columns[j][i] = a[i][j]);
                columns[j][N] = b[j];
            }
            let pivot = factor_columns(isa, &mut columns).unwrap();
            assert!(pivot > 1.0 && pivot <= 30.0);
            let [mut factor, mut forwards] = [(); 2].map(|()| Twins::new("factor_columns", isa));
            for i in 0..N {
                for j in 0..=i {
                    factor.compare(columns[j][i], expected[i][j]);
                }
                let forward: f64 = (0..=i).map(|k| expected[i][k] * columns[k][N]).sum();
                forwards.compare(forward, b[i]);
            }
            factor.hold(16.0);
            forwards.hold(16.0);
            let inverse = invert_columns(isa, &columns, &std::array::from_fn(|k| 1.0 / columns[k][k]));
            let mut products = Twins::new("invert_columns", isa);
            for i in 0..N {
                for j in 0..N {
                    let product: f64 = (0..N).map(|k| a[i][k] * inverse[k][j]).sum();
                    products.compare(product, if i == j { 1.0 } else { 0.0 });
                }
            }
            products.hold(16.0);
            let mut flat = vec![0.0; N * PADDED];
            for j in 0..N {
                (j..N).for_each(|i| flat[j * PADDED + i] = a[i][j]);
            }
            factor_dense(isa, N, PADDED, &mut flat).unwrap();
            let mut flattened = Twins::new("factor_dense", isa);
            for i in 0..N {
                for j in 0..=i {
                    flattened.compare(flat[j * PADDED + i], expected[i][j]);
                }
            }
            flattened.hold(16.0);
            columns[3] = [0.0; PADDED];
            assert!(factor_columns(isa, &mut columns).is_err());
        }
    }

    #[test]
    fn every_isa_agrees_with_the_textbook() {
        check::<9, 16>();
        check::<16, 24>();
        check::<25, 32>();
    }
}
