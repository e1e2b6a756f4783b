//! Shape index and curvedness of a height field from its five derivatives, without a cancelling root.
//!
//! With `p = S_x, q = S_y, e = S_xx, f = S_xy, g = S_yy`, `v = 1 + p^2`, `w = v + q^2`, the symmetric shape operator
//! `[a b; b c]` of `Derivatives::principal`, multiplied by the positive `v w^(3/2)`, needs no division:
//!
//! ```text
//! a' = e w          u = f v - p q e          b' = u sqrt(w)          c' = g v^2 - p q (f v + u)
//! m = a' + c'       h^2 = (a' - c')^2 + 4 u^2 w                      (sum and difference of k1, k2, scaled)
//! S = -(2/pi) atan2(m, h)       R = sqrt((k1^2 + k2^2)/2) = sqrt((m^2 + h^2) / (4 v^2 w^3))
//! ```
//!
//! Where both curvatures are zero S is NaN; callers report it as undefined. The squares limit the range: curvatures between 1e-140 and 1e140 and slopes up to 1e25, in the patch's unit.

use super::arctangent::{angle, reduced};
use super::lanes::Lanes;
#[cfg(test)]
use super::{Isa, dispatch};

/// Points of a batch in the test: 32 sets of eight lanes, as in most kernels. Kernels with few points use shorter batches,
/// because every batch is first zeroed.
#[cfg(test)]
const BATCH: usize = 256;

/// Change of S for one radian.
const UNIT: f64 = std::f64::consts::FRAC_2_PI;

/// Intermediate results of S and R for a batch of points.
///
/// One point is a chain of 90 instructions (polynomials, root, division, arctangent) that takes 180 cycles, and a processor
/// looks ahead over about a hundred waiting instructions: taking points one after another leaves it idle half of the time.
/// Taking each step for many points makes the chains short.
#[repr(align(64))]
pub(super) struct ShapeBatch<const B: usize> {
    /// -m; its sign is that of S.
    minus: [f64; B],
    /// h^2, then the arctangent's quotient.
    gap: [f64; B],
    /// 4 v^2 w^3, then the arctangent's multiple of pi/4.
    scale: [f64; B],
}

impl<const B: usize> ShapeBatch<B> {
    #[inline(always)]
    pub(super) fn new() -> ShapeBatch<B> {
        ShapeBatch { minus: [0.0; B], gap: [0.0; B], scale: [0.0; B] }
    }

    /// First step of the lanes at `at`, from `(S_x, S_y, S_xx, S_xy, S_yy)`.
    #[inline(always)]
    pub(super) fn put<V: Lanes>(&mut self, at: usize, [p, q, e, f, g]: [V; 5]) {
        let v = p.mul_add(p, V::splat(1.0));
        let w = q.mul_add(q, v);
        let pq = p * q;
        let fv = f * v;
        let u = pq.neg_mul_add(e, fv);
        let minus_c = pq.mul_add(fv + u, g.neg_mul_add(v * v, V::splat(0.0)));
        let minus = e.neg_mul_add(w, minus_c);
        let d = e.mul_add(w, minus_c);
        let four_w = w * V::splat(4.0);
        let vw = v * w;
        minus.store(&mut self.minus[at..]);
        (u * u).mul_add(four_w, d * d).store(&mut self.gap[at..]);
        (vw * vw * four_w).store(&mut self.scale[at..]);
    }

    /// Second step: roots and division. Returns R.
    #[inline(always)]
    pub(super) fn root<V: Lanes>(&mut self, at: usize) -> V {
        let (minus, h_square) = (V::load(&self.minus[at..]), V::load(&self.gap[at..]));
        let scale = V::load(&self.scale[at..]);
        let (quotient, offset) = reduced(minus, h_square.sqrt(), UNIT);
        quotient.store(&mut self.gap[at..]);
        offset.store(&mut self.scale[at..]);
        minus.mul_add(minus, h_square).sqrt_ratio(scale)
    }

    /// Third step: the arctangent. Returns S.
    #[inline(always)]
    pub(super) fn index<V: Lanes>(&self, at: usize) -> V {
        let [minus, quotient, offset] =
            [V::load(&self.minus[at..]), V::load(&self.gap[at..]), V::load(&self.scale[at..])];
        angle(quotient, offset, minus, UNIT)
    }

    /// S and R of as many points as the arrays hold, from the first on.
    #[inline(always)]
    pub(super) fn finish<V: Lanes>(&mut self, shape_index: &mut [f64], curvedness: &mut [f64]) {
        let n = shape_index.len();
        for at in (0..n).step_by(V::N) {
            store_within(self.root::<V>(at), &mut curvedness[at..n]);
        }
        for at in (0..n).step_by(V::N) {
            store_within(self.index::<V>(at), &mut shape_index[at..n]);
        }
    }
}

/// Stores as many lanes as `to` has room for.
#[inline(always)]
fn store_within<V: Lanes>(lanes: V, to: &mut [f64]) {
    if to.len() >= V::N {
        lanes.store(to);
    } else {
        let mut all = [0.0; 8];
        lanes.store(&mut all);
        to.copy_from_slice(&all[..to.len()]);
    }
}

#[cfg(test)]
#[inline(always)]
fn generic<V: Lanes>([p, q, e, f, g]: [&[f64]; 5], shape_index: &mut [f64], curvedness: &mut [f64]) {
    let n = shape_index.len();
    let mut batch = ShapeBatch::<BATCH>::new();
    for from in (0..n).step_by(BATCH) {
        let to = n.min(from + BATCH);
        let whole = to - (to - from) % V::N;
        for i in (from..whole).step_by(V::N) {
            let all = [V::load(&p[i..]), V::load(&q[i..]), V::load(&e[i..]), V::load(&f[i..]), V::load(&g[i..])];
            batch.put(i - from, all);
        }
        if whole < to {
            // the last points are padded to full width, so that a point's bits do not depend on its place
            let mut padded = [[0.0; 8]; 5];
            for (row, d) in padded.iter_mut().zip([p, q, e, f, g]) {
                row[..to - whole].copy_from_slice(&d[whole..to]);
            }
            let [p, q, e, f, g] = &padded;
            batch.put(whole - from, [V::load(p), V::load(q), V::load(e), V::load(f), V::load(g)]);
        }
        batch.finish::<V>(&mut shape_index[from..to], &mut curvedness[from..to]);
    }
}

/// S and R at every point from `[S_x, S_y, S_xx, S_xy, S_yy]`, arrays of one length; S is NaN where the surface is flat. It
/// is the kernel that tests the steps of [`ShapeBatch`], which the kernels over grids share.
///
/// # Panics
/// When an array is shorter than `shape_index`.
#[cfg(test)]
fn shape_maps(isa: Isa, derivatives: [&[f64]; 5], shape_index: &mut [f64], curvedness: &mut [f64]) {
    dispatch!(isa, generic [](derivatives: [&[f64]; 5], shape_index: &mut [f64], curvedness: &mut [f64]));
}

/// The safe twin: the textbook's shape operator with divisions, `hypot` and the library's `atan2`, one point at a time.
pub fn shape_maps_twin(derivatives: [&[f64]; 5], shape_index: &mut [f64], curvedness: &mut [f64]) {
    for i in 0..shape_index.len() {
        let [p, q, e, f, g] = derivatives.map(|d| d[i]);
        let v = 1.0 + p * p;
        let root = (v + q * q).sqrt();
        let shear = p * q / v;
        let a = e / (v * root);
        let b = (f - shear * e) / (root * root);
        let c = (g - shear * (2.0 * f - shear * e)) * v / (root * root * root);
        let (mean, half_gap) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let flat = mean == 0.0 && half_gap == 0.0;
        shape_index[i] = if flat { f64::NAN } else { -std::f64::consts::FRAC_2_PI * mean.atan2(half_gap) };
        curvedness[i] = mean.hypot(half_gap);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ulps;
    use super::*;

    /// Spheres, cylinders at any angle, saddles, planes and anything, on slopes up to 30.
    fn samples() -> [Vec<f64>; 5] {
        let mut state = 9_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2.0_f64.powi(52) - 1.0
        };
        let mut out: [Vec<f64>; 5] = Default::default();
        for k in 0..20_011 {
            let steep = if k % 7 == 0 { 30.0 } else { 1.0 };
            let (p, q) = (next() * steep, next() * steep);
            let (s, c) = (next() * 3.0).sin_cos();
            let (e, f, g) = match k % 4 {
                0 => (next(), next(), next()),
                1 => (s * s, s * c, c * c),
                2 => (-(1.0 + p * p), -p * q, -(1.0 + q * q)), // a sphere's: both curvatures equal
                _ => (c, s, -c),
            };
            let scale = 10.0_f64.powi(k % 9 - 4);
            let flat = if k % 997 == 0 { 0.0 } else { scale };
            for (column, value) in out.iter_mut().zip([p, q, e * flat, f * flat, g * flat]) {
                column.push(value);
            }
        }
        out
    }

    #[test]
    fn every_isa_agrees_with_its_twin() {
        let d = samples();
        let n = d[0].len();
        let slices = d.each_ref().map(|v| &v[..]);
        let (mut s0, mut r0) = (vec![0.0; n], vec![0.0; n]);
        shape_maps_twin(slices, &mut s0, &mut r0);
        for isa in Isa::available() {
            let (mut s, mut r) = (vec![0.0; n], vec![0.0; n]);
            shape_maps(isa, slices, &mut s, &mut r);
            let (mut worst_s, mut worst_r) = (0.0_f64, 0.0_f64);
            for i in 0..n {
                assert_eq!(s[i].is_nan(), s0[i].is_nan());
                // next to an umbilic S moves by the square root of a rounding error: measured as the angle's distance
                worst_s = worst_s.max(if s[i].is_nan() { 0.0 } else { (s[i] - s0[i]).abs() });
                worst_r = worst_r.max(ulps(r[i], r0[i]));
            }
            println!("shape_maps {}: S {worst_s:.1e}, R {worst_r:.1} ulp", isa.name());
            assert!(worst_s < 1e-12 && worst_r < 600.0, "{}: {worst_s:e} {worst_r}", isa.name());
        }
    }

    #[test]
    fn a_point_does_not_depend_on_its_place() {
        let d = samples();
        for isa in Isa::available() {
            let (mut s, mut r) = (vec![0.0; 40], vec![0.0; 40]);
            shape_maps(isa, d.each_ref().map(|v| &v[..40]), &mut s, &mut r);
            for from in 1..30 {
                let (mut s1, mut r1) = (vec![0.0; 7], vec![0.0; 7]);
                shape_maps(isa, d.each_ref().map(|v| &v[from..from + 7]), &mut s1, &mut r1);
                let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
                assert!(same(&s1, &s[from..from + 7]) && same(&r1, &r[from..from + 7]));
            }
        }
    }
}
