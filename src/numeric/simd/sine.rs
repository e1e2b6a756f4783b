//! `sin x` and `cos x` together for |x| up to 8: to two units in the last place, next to a zero of either to 2^-52.
//!
//! ```text
//! n = nearest integer to 2 x/pi       r = x - n pi/2       |r| <= pi/4
//! sin r = r + r z (s1 + .. + s6 z^5)       cos r = 1 - z/2 + z^2 (c1 + .. + c6 z^5)       z = r^2
//! n mod 4 says which of the two, and with which sign, is sin x and cos x
//! ```
//!
//! The polynomials, and pi/2 in two parts of which the first has 33 bits, are those of FreeBSD's msun `k_sin.c`, `k_cos.c` and
//! `e_rem_pio2.c` (Sun Microsystems 1993).

use super::lanes::Lanes;

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_243_48e-1,
    8.333_333_333_322_489_461_24e-3,
    -1.984_126_982_985_794_931_34e-4,
    2.755_731_370_707_006_767_89e-6,
    -2.505_076_025_340_686_341_95e-8,
    1.589_690_995_211_550_102_21e-10,
];

const COSINE: [f64; 6] = [
    4.166_666_666_666_660_190_37e-2,
    -1.388_888_888_887_410_957_49e-3,
    2.480_158_728_947_672_941_78e-5,
    -2.755_731_435_139_066_330_35e-7,
    2.087_572_321_298_174_827_90e-9,
    -1.135_964_755_778_819_482_65e-11,
];

/// pi/2: its first 33 bits, and the rest.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_614_17, 6.077_100_506_506_192_249_32e-11];

/// 1.5 times 2^52: a sum with it is rounded to an integer, which then stands in its lowest bits.
const INTEGERS: f64 = 6_755_399_441_055_744.0;

/// `c_0 + c_1 z + ..` by Horner.
#[inline(always)]
pub(super) fn series<V: Lanes>(z: V, c: &[f64]) -> V {
    let mut sum = V::splat(c[c.len() - 1]);
    for &term in c[..c.len() - 1].iter().rev() {
        sum = sum.mul_add(z, V::splat(term));
    }
    sum
}

/// `[sin r, cos r]` for |r| up to pi/4.
#[inline(always)]
pub(super) fn of_eighth<V: Lanes>(r: V) -> [V; 2] {
    let z = r * r;
    let sine = (r * z).mul_add(series(z, &SINE), r);
    let cosine = (z * z).mul_add(series(z, &COSINE), z.neg_mul_add(V::splat(0.5), V::splat(1.0)));
    [sine, cosine]
}

/// `[sin x, cos x]`; |x| must not exceed 8.
#[inline(always)]
pub(super) fn sine_and_cosine<V: Lanes>(x: V) -> [V; 2] {
    let shifted = x.mul_add(V::splat(std::f64::consts::FRAC_2_PI), V::splat(INTEGERS));
    let n = shifted - V::splat(INTEGERS);
    let r = n.neg_mul_add(V::splat(QUARTER[1]), n.neg_mul_add(V::splat(QUARTER[0]), x));
    let [sine, cosine] = of_eighth(r);
    let turns = shifted.to_bits();
    let odd = V::splat(0.5).less(V::from_integer(V::and(turns, V::splat_bits(1))));
    let signed = |value: V, turns: V::Bits| {
        let sign = V::shift_left::<62>(V::and(turns, V::splat_bits(2)));
        V::from_bits(V::xor(value.to_bits(), sign))
    };
    let next = V::plus(turns, V::splat_bits(1));
    [signed(V::select(odd, cosine, sine), turns), signed(V::select(odd, sine, cosine), next)]
}

#[cfg(test)]
mod tests {
    use super::super::{Isa, dispatch, ulps};
    use super::*;

    #[inline(always)]
    fn all<V: Lanes>(x: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
        for i in (0..x.len()).step_by(V::N) {
            let [sine, cosine] = sine_and_cosine(V::load(&x[i..]));
            sine.store(&mut sines[i..]);
            cosine.store(&mut cosines[i..]);
        }
    }

    /// Twin: the library's `sin_cos`, at angles from -8 to 8 and at every power of two below.
    #[test]
    fn two_units_in_the_last_place_of_the_library() {
        let mut x: Vec<f64> = (0..160_000).map(|k| k as f64 / 10_000.0 - 8.0).collect();
        x.extend((-300..4).flat_map(|e| [2.0_f64.powi(e), -1.3 * 2.0_f64.powi(e - 1)]));
        x.extend([0.0, -0.0, 8.0, -8.0]);
        x.resize(x.len().next_multiple_of(8), 1.0);
        for isa in Isa::available() {
            let (mut sines, mut cosines) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            let (xs, s, c) = (&x[..], &mut sines[..], &mut cosines[..]);
            dispatch!(isa, all [](xs: &[f64], s: &mut [f64], c: &mut [f64]));
            // next to a zero of either, what is left of pi/2 decides its last places: errors there are counted in parts of 1
            let off = |found: f64, expected: f64| {
                if expected.abs() > 0.01 { ulps(found, expected) } else { (found - expected).abs() / f64::EPSILON }
            };
            let worst = (0..x.len()).map(|i| off(sines[i], x[i].sin()).max(off(cosines[i], x[i].cos())));
            let worst = worst.fold(0.0, f64::max);
            println!("sin and cos {}: largest difference {worst:.2} ulp", isa.name());
            assert!(worst <= 2.0, "{}: {worst} ulp", isa.name());
        }
    }
}
