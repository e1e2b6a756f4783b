//! Derivatives of S and R at eight points of one cell by the cell's coefficients.
//!
//! ```text
//! l^2 = 1 + p^2, w^2 = 1 + p^2 + q^2, s = p q / l^2          a = r/(l^2 w)
//! S = -(2/pi) atan2(a + c, d)                                b = (t - s r)/w^2
//! R = sqrt((a^2 + c^2)/2 + b^2)                              c = l^2 (u - 2 s t + s^2 r)/w^3
//! d = sqrt((a - c)^2 + 4 b^2)                                p, q, r, t, u = S_x, S_y, S_xx, S_xy, S_yy
//! dS/dc_ij = sum_k (dS/d_k) D_k(N_i M_j)                     d_k the five derivatives, D_k the same of the basis
//!
//! d_k = sum_a N_a^(i) g_a^(j), g_a^(j) = sum_b c_ab M_b^(j)  the curves g are shared by all points of one y in the cell
//! ```
//!
//! The eight points have the same x. Besides the gradients the kernel returns the sizes of the terms of which the five
//! derivatives are sums, because rounding errors are relative to these sizes.

use super::lanes::Lanes;
use super::{Isa, by_width, dispatch};

/// Points taken at once.
pub const POINTS: usize = 8;

/// One number for each point.
pub type PointLanes = [f64; POINTS];

/// `sum_b c_ab M_b^(j)` for j = 0, 1, 2, then the same of absolute values: one row of a cell's coefficients.
pub type CurveLanes = [PointLanes; 6];

/// Eight points of a cell with one x.
#[derive(Clone, Copy, Debug)]
pub struct CellPoints<'a> {
    /// N, N', N'' at x, `p + 1` each.
    pub x: [&'a [f64]; 3],
    /// M, M', M'' at the points, `q + 1` each.
    pub y: [&'a [PointLanes]; 3],
    /// The cell's coefficients summed along y by [`cell_curves`], `p + 1` rows.
    pub curves: &'a [CurveLanes],
}

/// Rounding error of a derivative relative to the size of its terms, and of S and R relative to their own size. They come
/// from sums over the tensor basis in which each term is rounded about eight times.
pub const ROUNDING: f64 = 8.0 * 0.5 * f64::EPSILON;

/// What [`shape_gradients`] finds at the eight points besides the gradients.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointShapes {
    /// `u (1 + sum_k |dS/d_k| |terms of d_k|)`, and R's with R for 1, u eight half units in the last place, and the terms of a derivative
    /// `sum_ab |c_ab| |D_k(N_a M_b)|`; NaN where curvatures are so large or small that their squares are lost.
    pub roundings: [PointLanes; 2],
    /// What errors of S and of R are relative to: 1 and R.
    pub sizes: [PointLanes; 2],
    /// `k1 - k2`.
    pub difference: PointLanes,
    /// `(|k1 + k2| + k1 - k2) / 2`.
    pub bend: PointLanes,
    /// `2 u (e_xx + 2 e_xy + e_yy) + 4 u bend (e_x + e_y)`, e the terms: what rounding alone opens a gap of `k1 - k2` by.
    pub opening: PointLanes,
}

/// Orders of the five derivatives in x and in y.
pub const ORDERS: [(usize, usize); 5] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

// three lanes are written out, because `array::map` inside a kernel becomes a call that passes registers through memory
#[inline(always)]
fn splats<V: Lanes>([a, b, c]: [f64; 3]) -> [V; 3] {
    [V::splat(a), V::splat(b), V::splat(c)]
}

#[inline(always)]
fn three<V: Lanes>(rows: [&[[f64; POINTS]]; 3], b: usize, lanes: usize) -> [V; 3] {
    [V::load(&rows[0][b][lanes..]), V::load(&rows[1][b][lanes..]), V::load(&rows[2][b][lanes..])]
}

#[inline(always)]
fn curves<V: Lanes, const P: usize, const Q: usize>(
    c: &[f64],
    runs: &[usize],
    y: [&[PointLanes]; 3],
    out: &mut [CurveLanes],
) {
    let (rows, width) = if P * Q == 0 { (runs.len(), y[0].len()) } else { (P, Q) };
    let y = [&y[0][..width], &y[1][..width], &y[2][..width]];
    for (start, curves) in runs[..rows].iter().zip(&mut out[..rows]) {
        let c = &c[*start..*start + width];
        for lanes in (0..POINTS).step_by(V::N) {
            let (mut sums, mut sizes) = ([V::splat(0.0); 3], [V::splat(0.0); 3]);
            for (b, value) in c.iter().enumerate() {
                let (value, m) = (V::splat(*value), three::<V>(y, b, lanes));
                for j in 0..3 {
                    sums[j] = value.mul_add(m[j], sums[j]);
                    sizes[j] = value.abs().mul_add(m[j].abs(), sizes[j]);
                }
            }
            for j in 0..3 {
                sums[j].store(&mut curves[j][lanes..]);
                sizes[j].store(&mut curves[3 + j][lanes..]);
            }
        }
    }
}

/// The five derivatives, and the sizes of their terms.
#[inline(always)]
fn derivatives<V: Lanes>(points: &CellPoints, lanes: usize) -> [[V; 5]; 2] {
    let (mut d, mut sizes) = ([V::splat(0.0); 5], [V::splat(0.0); 5]);
    for (a, curves) in points.curves.iter().enumerate() {
        let n = splats::<V>([points.x[0][a], points.x[1][a], points.x[2][a]]);
        for (k, (i, j)) in ORDERS.into_iter().enumerate() {
            d[k] = n[i].mul_add(V::load(&curves[j][lanes..]), d[k]);
            sizes[k] = n[i].abs().mul_add(V::load(&curves[3 + j][lanes..]), sizes[k]);
        }
    }
    [d, sizes]
}

/// `1/v`, 0 where v is not above 0.
#[inline(always)]
fn inverse<V: Lanes>(v: V) -> V {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    V::select(zero.less(v), one.div(v), zero)
}

/// `[dS/d_k, dR/d_k]`, and `k1 + k2`, `k1 - k2`, R.
#[inline(always)]
fn gradient<V: Lanes>([p, q, r, t, u]: [V; 5]) -> ([[V; 5]; 2], [V; 3]) {
    let (zero, one, two, three) = (V::splat(0.0), V::splat(1.0), V::splat(2.0), V::splat(3.0));
    let l2 = p.mul_add(p, one);
    let (by_l2, by_w2) = (one.div(l2), one.div(q.mul_add(q, l2)));
    let by_w = by_w2.sqrt();
    let s = p * q * by_l2;
    let a = r * by_l2 * by_w;
    let b = s.neg_mul_add(r, t) * by_w2;
    let outer = l2 * by_w2 * by_w;
    let bend_s = two * s.neg_mul_add(r, t);
    // u - 2 s t + s^2 r
    let c = outer * s.neg_mul_add(t + s.neg_mul_add(r, t), u);
    let s_p = q * p.neg_mul_add(p, one) * by_l2 * by_l2;
    let s_q = p * by_l2;
    let (along, over, across) = (two * p * by_l2, p * by_w2, q * by_w2);
    let da = [zero - a * (along + over), zero - a * across, by_l2 * by_w];
    let r_w = r * by_w2;
    let db =
        [zero - s_p.mul_add(r_w, two * b * over), zero - s_q.mul_add(r_w, two * b * across), zero - s * by_w2, by_w2];
    let scaled_bend = outer * bend_s;
    let dc = [
        (c * three.neg_mul_add(over, along)) - scaled_bend * s_p,
        zero - three.mul_add(c * across, scaled_bend * s_q),
        outer * s * s,
        zero - two * outer * s,
        outer,
    ];
    let (sum, half) = (a + c, a - c);
    let twice = b + b;
    let gap2 = half.mul_add(half, twice * twice);
    let gap = gap2.sqrt();
    let size2 = sum.mul_add(sum, gap2);
    let by_size2 = inverse(size2);
    let (by_gap, by_size) = (inverse(gap), by_size2.sqrt());
    let (of_sum, of_gap) = (gap * by_size2, sum * by_size2);
    let mut out = [[zero; 5]; 2];
    for k in 0..5 {
        let ak = if k < 3 { da[k] } else { zero };
        let bk = if k < 4 { db[k] } else { zero };
        let d_gap = half.mul_add(ak - dc[k], two * twice * bk) * by_gap;
        out[0][k] = of_gap.neg_mul_add(d_gap, of_sum * (ak + dc[k])) * V::splat(-std::f64::consts::FRAC_2_PI);
        out[1][k] = a.mul_add(ak, c.mul_add(dc[k], twice * bk)) * by_size;
    }
    (out, [sum, gap, size2 * by_size * V::splat(0.5)])
}

impl<'a> CellPoints<'a> {
    #[inline(always)]
    fn cut<const P: usize, const Q: usize>(&self) -> CellPoints<'a> {
        if P * Q == 0 {
            return *self;
        }
        let ([x, dx, ddx], [y, dy, ddy]) = (self.x, self.y);
        CellPoints { x: [&x[..P], &dx[..P], &ddx[..P]], y: [&y[..Q], &dy[..Q], &ddy[..Q]], curves: &self.curves[..P] }
    }
}

#[inline(always)]
fn gradients<V: Lanes, const P: usize, const Q: usize>(
    points: &CellPoints,
    entries: [&mut [PointLanes]; 2],
    out: &mut PointShapes,
) {
    let points = &points.cut::<P, Q>();
    let width = points.y[0].len();
    let [of_shape_index, of_curvedness] = entries;
    let cell = points.x[0].len() * width;
    let entries = [&mut of_shape_index[..cell], &mut of_curvedness[..cell]];
    for lanes in (0..POINTS).step_by(V::N) {
        let [d, sizes] = derivatives::<V>(points, lanes);
        let (gradients, [sum, difference, size]) = gradient(d);
        let sound = is_sound(&gradients, size);
        let unit = V::splat(ROUNDING);
        for (k, g) in gradients.iter().enumerate() {
            let mut rounding = if k == 0 { V::splat(1.0) } else { size };
            (0..5).for_each(|k| rounding = g[k].abs().mul_add(sizes[k], rounding));
            V::select(sound, rounding * unit, V::splat(f64::NAN)).store(&mut out.roundings[k][lanes..]);
            for (a, target) in entries[k].chunks_exact_mut(width).enumerate() {
                let [n, dn, ddn] = splats([points.x[0][a], points.x[1][a], points.x[2][a]]);
                let of_m = g[0].mul_add(dn, g[2] * ddn);
                let of_dm = g[1].mul_add(n, g[3] * dn);
                let of_ddm = g[4] * n;
                for (b, value) in target.iter_mut().enumerate() {
                    let [m, dm, ddm] = three::<V>(points.y, b, lanes);
                    of_m.mul_add(m, of_dm.mul_add(dm, of_ddm * ddm)).store(&mut value[lanes..]);
                }
            }
        }
        let bend = (sum.abs() + difference) * V::splat(0.5);
        difference.store(&mut out.difference[lanes..]);
        bend.store(&mut out.bend[lanes..]);
        opening(&sizes, bend).store(&mut out.opening[lanes..]);
        V::splat(1.0).store(&mut out.sizes[0][lanes..]);
        size.store(&mut out.sizes[1][lanes..]);
    }
}

/// Lanes in which R has a gradient and both gradients are finite. At an umbilic the gradient of S is set to zero, and the
/// opening of the kink is used instead.
#[inline(always)]
fn is_sound<V: Lanes>([of_s, of_r]: &[[V; 5]; 2], size: V) -> V::Mask {
    let (mut reach, mut other) = (V::splat(0.0), size);
    for k in 0..5 {
        reach = reach + of_r[k].abs();
        other = other + of_s[k].abs();
    }
    // infinity or NaN times 0 is NaN, for which the comparison is false
    V::splat(0.0).less(other.mul_add(V::splat(0.0), reach))
}

#[inline(always)]
fn opening<V: Lanes>(sizes: &[V; 5], bend: V) -> V {
    let second = V::splat(2.0) * sizes[3].mul_add(V::splat(2.0), sizes[2] + sizes[4]);
    (V::splat(4.0) * bend).mul_add(sizes[0] + sizes[1], second) * V::splat(ROUNDING)
}

/// The curves of a cell: `c` the coefficients, `runs` the first of each row of the cell, `y` M, M', M'' at the points.
///
/// # Panics
/// When a run leaves the coefficients, or rows are not of one length.
pub fn cell_curves(isa: Isa, c: &[f64], runs: &[usize], y: [&[PointLanes]; 3], out: &mut [CurveLanes]) {
    by_width!(isa, [runs.len(), y[0].len()], curves(
        c: &[f64],
        runs: &[usize],
        y: [&[PointLanes]; 3],
        out: &mut [CurveLanes],
    ));
}

/// The gradients at eight points, dS/dc and dR/dc, in `entries` number `a (q + 1) + b`; returns the rest of the results.
///
/// # Panics
/// When there are fewer curves or entries than basis rows ask for.
pub fn shape_gradients(isa: Isa, points: &CellPoints, entries: [&mut [PointLanes]; 2], out: &mut PointShapes) {
    let widths = [points.x[0].len(), points.y[0].len()];
    by_width!(isa, widths, gradients(
        points: &CellPoints,
        entries: [&mut [PointLanes]; 2],
        out: &mut PointShapes,
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_does_not_depend_on_its_lane_and_flat_ones_have_no_gradient() {
        let x = [&[0.5, 0.5][..], &[-1.0, 1.0], &[0.0, 0.0]];
        let y: [Vec<[f64; POINTS]>; 3] =
            [vec![[0.3; POINTS], [0.7; POINTS]], vec![[-1.0; POINTS], [1.0; POINTS]], vec![[0.0; POINTS]; 2]];
        let y = y.each_ref().map(|y| &y[..]);
        for isa in Isa::available() {
            for (twist, alive) in [(0.3, true), (0.0, false)] {
                // c_01 - c_00 and c_11 - c_10 are the slopes in y; the twist is their difference
                let c = [0.1, 0.3, 0.1, 0.3 + twist];
                let mut curves = [CurveLanes::default(); 2];
                cell_curves(isa, &c, &[0, 2], y, &mut curves);
                let [mut of_s, mut of_r] = [[[0.0; POINTS]; 4]; 2];
                let mut made = PointShapes::default();
                let points = CellPoints { x, y, curves: &curves };
                shape_gradients(isa, &points, [&mut of_s, &mut of_r], &mut made);
                let [first, ..] = made.roundings[0];
                assert!(made.roundings[0].iter().all(|r| r.is_nan() != alive && (!alive || *r == first)));
            }
        }
    }
}
