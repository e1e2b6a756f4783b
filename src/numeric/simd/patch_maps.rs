//! S and R over a grid of points that lie on one segment, all rows in one call. For small patches this
//! replaces [`super::curvature_row`], whose preparations would cost more than the points.
//!
//! ```text
//! e_a,k = sum_v D_k[v] c_av                    powers of t = y - centre instead of basis functions, once for all rows
//! P_d,k = sum_a N_a^(d)(x) e_a,k               a row's polynomials;  S_y, S_xy, S_yy from k P_0,k, k P_1,k, k (k - 1) P_0,k
//! ```

use super::curvature_row::RowPieces;
use super::lanes::Lanes;
use super::shape_maps::ShapeBatch;
use super::{Isa, dispatch};

/// Grids up to this many points go through this kernel; the rows of larger ones are better shared among threads.
pub const PATCH_POINTS: usize = 4096;

/// Points whose S and R are computed together: an 8 x 8 grid. Larger grids go in parts.
const BATCH: usize = 64;

/// k and k (k - 1), the factors of a derivative.
const FIRST: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
const SECOND: [f64; 8] = [0.0, 0.0, 2.0, 6.0, 12.0, 20.0, 30.0, 42.0];

/// `sum_k c[from + k] t^k`.
#[inline(always)]
fn horner<V: Lanes>(c: &[f64; 8], from: usize, width: usize, t: V) -> V {
    if from >= width {
        return V::splat(0.0);
    }
    let mut sum = V::splat(c[width - 1]);
    for k in (from..width - 1).rev() {
        sum = sum.mul_add(t, V::splat(c[k]));
    }
    sum
}

#[inline(always)]
fn generic<V: Lanes, const W: usize>(
    row: &RowPieces,
    basis: [&[f64]; 3],
    coefficients: &[f64],
    shape_index: &mut [f64],
    curvedness: &mut [f64],
) {
    let n = row.len();
    let mut powers = [[0.0; 8]; W];
    for (a, line) in powers.iter_mut().enumerate() {
        let c = &coefficients[a * row.n_basis..][..W];
        for (k, value) in line[..W].iter_mut().enumerate() {
            for v in 0..W {
                *value += row.taylor[(k * W + v) * row.padded] * c[v];
            }
        }
    }
    let points = shape_index.len();
    let mut batch = ShapeBatch::<BATCH>::new();
    let mut from = 0;
    for i in 0..points / n {
        let mut pieces = [[0.0; 8]; 3];
        let (mut slopes, mut second) = ([[0.0; 8]; 2], [0.0; 8]);
        for lane in (0..8).step_by(V::N) {
            let mut sums = [V::splat(0.0); 3];
            for a in 0..W {
                let line = V::load(&powers[a][lane..]);
                for d in 0..3 {
                    sums[d] = V::splat(basis[d][i * W + a]).mul_add(line, sums[d]);
                }
            }
            for d in 0..3 {
                sums[d].store(&mut pieces[d][lane..]);
            }
            for d in 0..2 {
                (sums[d] * V::load(&FIRST[lane..])).store(&mut slopes[d][lane..]);
            }
            (sums[0] * V::load(&SECOND[lane..])).store(&mut second[lane..]);
        }
        for j in (0..n).step_by(V::N) {
            let t = V::load(&row.offsets[j..]);
            let x = horner(&pieces[1], 0, W, t);
            let y = horner(&slopes[0], 1, W, t);
            let xy = horner(&slopes[1], 1, W, t);
            let at = i * n + j;
            if at + V::N > from + BATCH {
                batch.finish::<V>(&mut shape_index[from..at], &mut curvedness[from..at]);
                from = at;
            }
            // the lanes beyond the row's end are overwritten by the next row
            batch.put(at - from, [x, y, horner(&pieces[2], 0, W, t), xy, horner(&second, 2, W, t)]);
        }
    }
    batch.finish::<V>(&mut shape_index[from..], &mut curvedness[from..]);
}

/// S and R, row-major, at the points of `row` for every x; `basis[d]` holds the d-th derivatives of the p + 1 basis
/// functions for one x after the other, `coefficients` start at the segment's first one in x and in y. S is NaN where
/// the surface is flat. Degrees of 2 to 4, equal in x and y; returns `false`, and does nothing, for others.
///
/// # Panics
/// When an array is shorter than its shape.
pub fn patch_maps(
    isa: Isa,
    row: &RowPieces,
    basis: [&[f64]; 3],
    coefficients: &[f64],
    shape_index: &mut [f64],
    curvedness: &mut [f64],
) -> bool {
    if row.is_empty() || row.only_segment().is_none() {
        return false;
    }
    match row.degree {
        2 => of_width::<3>(isa, row, basis, coefficients, shape_index, curvedness),
        3 => of_width::<4>(isa, row, basis, coefficients, shape_index, curvedness),
        4 => of_width::<5>(isa, row, basis, coefficients, shape_index, curvedness),
        _ => return false,
    }
    true
}

fn of_width<const W: usize>(
    isa: Isa,
    row: &RowPieces,
    basis: [&[f64]; 3],
    coefficients: &[f64],
    shape_index: &mut [f64],
    curvedness: &mut [f64],
) {
    dispatch!(isa, generic [W](
        row: &RowPieces, basis: [&[f64]; 3], coefficients: &[f64], shape_index: &mut [f64], curvedness: &mut [f64]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::super::shape_maps::shape_maps_twin;
    use super::*;

    /// Twin: every derivative as a double sum, then the textbook's shape operator.
    #[test]
    fn every_isa_agrees_with_its_twin() {
        let value = |a: usize, b: usize| ((a * 17 + b * 5) as f64 * 0.37).sin();
        for width in [3, 4, 5] {
            let offsets: Vec<f64> = (0..13).map(|j| -0.6 + 0.1 * j as f64).collect();
            let taylor: Vec<f64> = (0..width * width).map(|k| value(k, 3)).collect();
            let row = RowPieces::new(width - 1, width + 2, std::iter::once((13, 0, &taylor[..])), &offsets);
            let basis = [0, 1, 2].map(|d| (0..9 * width).map(|k| value(k, 40 + d)).collect::<Vec<f64>>());
            let c: Vec<f64> = (0..width * (width + 2)).map(|k| value(k, 90)).collect();
            let mut derivatives: [Vec<f64>; 5] = Default::default();
            for i in 0..9 {
                for t in &offsets {
                    // e-th derivative in y of the d-th in x
                    let at = |d: usize, e: usize| -> f64 {
                        let mut sum = 0.0;
                        for a in 0..width {
                            for k in e..width {
                                let falling: f64 = (0..e).map(|m| (k - m) as f64).product();
                                for v in 0..width {
                                    let power = falling * t.powi((k - e) as i32);
                                    sum += basis[d][i * width + a]
                                        * power
                                        * taylor[k * width + v]
                                        * c[a * (width + 2) + v];
                                }
                            }
                        }
                        sum
                    };
                    let all = [at(1, 0), at(0, 1), at(2, 0), at(1, 1), at(0, 2)];
                    derivatives.iter_mut().zip(all).for_each(|(column, value)| column.push(value));
                }
            }
            let (mut s, mut r) = (vec![0.0; 117], vec![0.0; 117]);
            shape_maps_twin(derivatives.each_ref().map(|d| &d[..]), &mut s, &mut r);
            for isa in Isa::available() {
                let (mut index, mut curved) = (vec![0.0; 117], vec![0.0; 117]);
                assert!(patch_maps(isa, &row, basis.each_ref().map(|b| &b[..]), &c, &mut index, &mut curved));
                let [mut twins_s, mut twins_r] = ["patch_maps S", "patch_maps R"].map(|kernel| Twins::new(kernel, isa));
                for j in 0..117 {
                    twins_s.compare(index[j], s[j]);
                    twins_r.compare(curved[j] / r[j], 1.0);
                }
                twins_s.hold(64.0);
                twins_r.hold(64.0);
            }
        }
    }
}
