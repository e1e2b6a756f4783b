//! `atan2(y, x)` for `x >= 0`, to two units in the last place.
//!
//! ```text
//! |y|/x below tan(pi/8):  atan2 = atan(|y|/x);    above tan(3 pi/8):  pi/2 + atan(-x/|y|)
//! between:  pi/4 + atan((|y| - x)/(|y| + x))
//! atan r = r - r z (a0 + a1 z + .. + a10 z^10),  z = r^2,  |r| <= tan(pi/8)
//! ```
//!
//! The result at the origin is NaN. There is one division; the steps before it and those after it are separate
//! functions, and callers do the first steps of many points before the last steps of any, so that none waits for the
//! divider. The angle may be in any `unit`, at the cost of one product. The polynomial is that of FreeBSD's msun `s_atan.c` (Sun Microsystems 1993), good to |r| < 7/16.

use super::lanes::Lanes;

const SERIES: [f64; 11] = [
    3.333_333_333_333_293_180_27e-1,
    -1.999_999_999_987_648_324_76e-1,
    1.428_571_427_250_346_637_11e-1,
    -1.111_111_040_546_235_578_80e-1,
    9.090_887_133_436_506_561_96e-2,
    -7.691_876_205_044_829_994_95e-2,
    6.661_073_137_387_531_206_69e-2,
    -5.833_570_133_790_573_486_45e-2,
    4.976_877_994_615_932_360_17e-2,
    -3.653_157_274_421_691_552_70e-2,
    1.628_582_011_536_578_236_23e-2,
];

/// tan(pi/8), above which the angle is reduced by pi/4.
const TAN_EIGHTH: f64 = 0.414_213_562_373_095_05;

/// The quotient r and the multiple of pi/4, in parts of `unit`, whose sum with `atan r` is `atan2(|y|, x)`.
#[inline(always)]
pub(super) fn reduced<V: Lanes>(y: V, x: V, unit: f64) -> (V, V) {
    let (height, zero) = (y.abs(), V::splat(0.0));
    let tangent = V::splat(TAN_EIGHTH);
    let (steep, steepest) = ((x * tangent).less(height), x.less(height * tangent));
    let above = V::select(steepest, zero - x, V::select(steep, height - x, height));
    let below = V::select(steepest, height, V::select(steep, height + x, x));
    let quarter = V::splat(std::f64::consts::FRAC_PI_4 * unit);
    let half = V::splat(std::f64::consts::FRAC_PI_2 * unit);
    (above.div(below), V::select(steepest, half, V::select(steep, quarter, zero)))
}

/// `unit` times the angle whose [`reduced`] quotient is `r`, with the sign of y.
#[inline(always)]
pub(super) fn angle<V: Lanes>(r: V, offset: V, y: V, unit: f64) -> V {
    let z = r * r;
    let w = z * z;
    let a = |k: usize| V::splat(SERIES[k] * unit);
    // even and odd terms are summed apart: two short chains instead of a long one
    let even = w.mul_add(w.mul_add(w.mul_add(w.mul_add(w.mul_add(a(10), a(8)), a(6)), a(4)), a(2)), a(0));
    let odd = w.mul_add(w.mul_add(w.mul_add(w.mul_add(a(9), a(7)), a(5)), a(3)), a(1));
    let series = z.mul_add(odd, even) * z;
    let small = series.neg_mul_add(r, r * V::splat(unit));
    (offset + small).with_sign_of(y)
}

#[cfg(test)]
mod tests {
    use super::super::{Isa, dispatch, ulps};
    use super::*;

    #[inline(always)]
    fn all<V: Lanes>(y: &[f64], x: &[f64], out: &mut [f64]) {
        for i in (0..y.len()).step_by(V::N) {
            let y = V::load(&y[i..]);
            let (r, offset) = reduced(y, V::load(&x[i..]), 1.0);
            angle(r, offset, y, 1.0).store(&mut out[i..]);
        }
    }

    /// Twin: the library's `atan2`. Angles spread evenly, then every power of two of the ratio, then the axes.
    #[test]
    fn two_units_in_the_last_place_of_the_library() {
        let mut y = Vec::new();
        let mut x = Vec::new();
        for k in 0..100_000 {
            let angle = (k as f64 / 50_000.0 - 1.0) * std::f64::consts::FRAC_PI_2;
            y.push(angle.sin() * 3.7);
            x.push(angle.cos().max(0.0) * 3.7);
        }
        for e in -300..300 {
            y.extend([2.0_f64.powi(e) * 1.3, -2.0_f64.powi(e)]);
            x.extend([1.7, 0.3]);
        }
        y.extend([0.0, 1.0, -1.0, 1.0, -1.0, 1e-300, 0.5, TAN_EIGHTH]);
        x.extend([1.0, 0.0, 0.0, 1.0, 1.0, 1e-300, 2.0, 1.0]);
        assert_eq!(y.len() % 8, 0);
        for isa in Isa::available() {
            let mut out = vec![0.0; y.len()];
            let (ys, xs, o) = (&y[..], &x[..], &mut out[..]);
            dispatch!(isa, all [](ys: &[f64], xs: &[f64], o: &mut [f64]));
            let worst = (0..y.len()).map(|i| ulps(out[i], y[i].atan2(x[i]))).fold(0.0, f64::max);
            println!("atan2 {}: largest difference {worst:.2} ulp", isa.name());
            assert!(worst <= 2.0, "{}: {worst} ulp", isa.name());
        }
    }
}
