//! Uniforms and gaussians from random words, branch-free: `u = (k + 1/2) 2^-53`, Box-Muller in pairs.
//!
//! `ln` and `sin, cos` are polynomials over a reduced range, good to 2 units in the last place. They give the same bits on
//! every machine, whatever its mathematical library, and loops without calls. The polynomials are those of FreeBSD's msun
//! (`e_log.c`, `k_sin.c`, `k_cos.c`; Sun Microsystems 1993).

use rand::Rng;
use rand_distr::Distribution;

/// A uniform in (0, 1) from the upper 53 bits of a word; never 0, never 1.
#[inline(always)]
pub fn uniform_open(word: u64) -> f64 {
    // 2^-54 is added to a multiple of 2^-53; the largest sum, 1 - 2^-54, would round to 1, so it is limited
    let u = (word >> 11) as f64 * 2.0_f64.powi(-53) + 2.0_f64.powi(-54);
    u.min(1.0 - 2.0_f64.powi(-53))
}

/// `values[2i], values[2i + 1]` from `words[2i], words[2i + 1]`: two independent gaussians.
///
/// Largest value 8.65 (u = 2^-54): the tail beyond has probability 5e-18.
#[inline]
pub fn box_muller(words: &[u64], values: &mut [f64]) {
    for (pair, word) in values.chunks_exact_mut(2).zip(words.chunks_exact(2)) {
        let radius = (-2.0 * ln_unit(uniform_open(word[0]))).sqrt();
        let (sin, cos) = sin_cos_turn(word[1]);
        pair[0] = radius * cos;
        pair[1] = radius * sin;
    }
}

/// [`uniform_open`] of a generator's next word, a law of `rand` like any other.
#[derive(Clone, Copy, Debug)]
pub struct OpenUniform;

impl Distribution<f64> for OpenUniform {
    fn sample<R: Rng + ?Sized>(&self, generator: &mut R) -> f64 {
        uniform_open(generator.next_u64())
    }
}

/// [`box_muller`] of a generator's next two words. `rand_distr`'s normal law rejects, so that a draw has no address.
#[derive(Clone, Copy, Debug)]
pub struct BoxMuller;

impl Distribution<[f64; 2]> for BoxMuller {
    fn sample<R: Rng + ?Sized>(&self, generator: &mut R) -> [f64; 2] {
        let words = [generator.next_u64(), generator.next_u64()];
        let mut pair = [0.0; 2];
        box_muller(&words, &mut pair);
        pair
    }
}

/// `ln u` for u in (0, 1): `u = 2^e m`, m in [sqrt(1/2), sqrt 2), `ln m = 2 artanh s`, `s = (m - 1)/(m + 1)`.
#[inline(always)]
fn ln_unit(u: f64) -> f64 {
    const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
    let shifted = u.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (shifted as i64 >> 52) as f64;
    let mantissa = f64::from_bits((shifted & 0x000f_ffff_ffff_ffff).wrapping_add(SQRT_HALF_BITS));
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let series = z
        * (6.666_666_666_666_735e-1
            + z * (3.999_999_999_940_942e-1
                + z * (2.857_142_874_366_239e-1
                    + z * (2.222_219_843_214_978e-1
                        + z * (1.818_357_216_161_805e-1
                            + z * (1.531_383_769_920_937e-1 + z * 1.479_819_860_511_658_6e-1))))));
    let half_square = 0.5 * f * f;
    const LN2_HI: f64 = 6.931_471_803_691_238e-1;
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    exponent * LN2_HI - ((half_square - (s * (half_square + series) + exponent * LN2_LO)) - f)
}

/// `(sin, cos)` of `2 pi` times the word as a fraction: the two top bits choose the quadrant, the rest the angle in
/// it, which is measured from the middle of the quadrant.
#[inline(always)]
fn sin_cos_turn(word: u64) -> (f64, f64) {
    let quarter = word >> 62;
    // angle within the quadrant, in (-pi/4, pi/4): 51 bits and a half step
    let fraction = ((word << 2) >> 13) as f64 * 2.0_f64.powi(-51) + (2.0_f64.powi(-52) - 0.5);
    let angle = fraction * std::f64::consts::FRAC_PI_2;
    let z = angle * angle;
    let sin = angle
        + angle
            * z
            * (-1.666_666_666_666_663_2e-1
                + z * (8.333_333_333_322_49e-3
                    + z * (-1.984_126_982_985_795e-4
                        + z * (2.755_731_370_707_006_8e-6
                            + z * (-2.505_076_025_340_686_3e-8 + z * 1.589_690_995_211_55e-10)))));
    let cos = 1.0 - 0.5 * z
        + z * z
            * (4.166_666_666_666_66e-2
                + z * (-1.388_888_888_887_411e-3
                    + z * (2.480_158_728_947_673e-5
                        + z * (-2.755_731_435_139_066_3e-7
                            + z * (2.087_572_321_298_175e-9 - z * 1.135_964_755_778_819_5e-11)))));
    // odd quadrants swap sine and cosine, and the quadrant sets the signs; all by bits, without a branch
    let odd = 0_u64.wrapping_sub(quarter & 1);
    let (s, c) = (sin.to_bits(), cos.to_bits());
    let first = (s & !odd) | (c & odd);
    let second = (c & !odd) | (s & odd);
    let sign_first = (quarter & 2) << 62;
    let sign_second = ((quarter + 1) & 2) << 62;
    (f64::from_bits(first ^ sign_first), f64::from_bits(second ^ sign_second))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_agree_with_the_library_to_two_units() {
        let mut word = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..200_000 {
            word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let u = uniform_open(word ^ (word >> 29));
            assert!((ln_unit(u) - u.ln()).abs() <= 2.0 * f64::EPSILON * u.ln().abs(), "ln {u}");
            let (sin, cos) = sin_cos_turn(word);
            let fraction = (word >> 62) as f64 * 0.25 + (((word << 2) >> 13) as f64 + 0.5) * 2.0_f64.powi(-53) - 0.125;
            let angle = fraction * std::f64::consts::TAU;
            assert!((sin - angle.sin()).abs() < 2e-15 && (cos - angle.cos()).abs() < 2e-15, "angle {angle}");
        }
        for u in [2.0_f64.powi(-54), 0.5, 0.75, 0.707, 0.708, 1.0 - 2.0_f64.powi(-53)] {
            assert!((ln_unit(u) - u.ln()).abs() <= 2.0 * f64::EPSILON * u.ln().abs(), "ln {u}");
        }
    }
}
