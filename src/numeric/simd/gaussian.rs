//! Gaussians (standard normal variates) from pairs of random words, without a branch.
//!
//! ```text
//! u = (k + 1/2) 2^-53, k the upper 53 bits         n0, n1 = sqrt(-2 ln u0) (cos, sin)(2 pi u1)
//! ln u = e ln 2 + 2 artanh(s),  u = 2^e (1 + f),  1 + f in [sqrt(1/2), sqrt 2),  s = f/(2 + f)
//! ```
//!
//! The top two bits of the second word choose one of four quadrants, the other bits the angle in (-pi/4, pi/4) within it.
//! The polynomials are those of FreeBSD's msun (`e_log.c`, and of `sine.rs`; Sun Microsystems 1993). The largest value is 8.65.
//! G. E. P. Box, M. E. Muller, *Ann. Math. Stat.* 29 (1958) 610.

use super::chacha8::{BLOCKS, WORDS};
use super::lanes::Lanes;
use super::sine::{of_eighth, series};
use super::{Isa, dispatch};

const LN: [f64; 7] = [
    6.666_666_666_666_735_130e-1,
    3.999_999_999_940_941_908e-1,
    2.857_142_874_366_239_149e-1,
    2.222_219_843_214_978_396e-1,
    1.818_357_216_161_805_012e-1,
    1.531_383_769_920_937_332e-1,
    1.479_819_860_511_658_591e-1,
];
/// The bits of sqrt(1/2): mantissas 1 + f lie between it and sqrt 2.
const SQRT_HALF_BITS: u64 = 0x3fe6_a09e_667f_3bcd;
const LN2: f64 = std::f64::consts::LN_2;

/// `(e, f, s)` of `u = (k + 1/2) 2^-53 = 2^e (1 + f)`: everything up to the division.
#[inline(always)]
fn reduced<V: Lanes>(word: V::Bits) -> [V; 3] {
    let unit = V::splat(2.0_f64.powi(-53));
    // from 2^52 on the half step is lost to rounding, and the largest word gives u = 1, whose logarithm and radius are 0
    let u = V::from_integer(V::shift_right::<11>(word)).mul_add(unit, V::splat(2.0_f64.powi(-54)));
    let shifted = V::plus(u.to_bits(), V::splat_bits(SQRT_HALF_BITS.wrapping_neg()));
    // exponents run from -54 to 0; 64 is added before the unsigned shift and subtracted after it
    let biased = V::shift_right::<52>(V::plus(shifted, V::splat_bits(64 << 52)));
    let exponent = V::from_integer(biased) - V::splat(64.0);
    let fraction = V::and(shifted, V::splat_bits(0x000f_ffff_ffff_ffff));
    let f = V::from_bits(V::plus(fraction, V::splat_bits(SQRT_HALF_BITS))) - V::splat(1.0);
    [exponent, f, f.div(f + V::splat(2.0))]
}

/// `sqrt(-2 ln u)` from what [`reduced`] returns.
#[inline(always)]
fn radius<V: Lanes>([exponent, f, s]: [V; 3]) -> V {
    let z = s * s;
    let half_square = f * f * V::splat(0.5);
    let tail = s * z.mul_add(series(z, &LN), half_square) - half_square;
    let ln = exponent.mul_add(V::splat(LN2), tail + f);
    (ln * V::splat(-2.0)).max(V::splat(0.0)).sqrt()
}

/// `(cos, sin)` of the angle `2 pi word / 2^64 - pi/4`, up to half a step of the word.
#[inline(always)]
fn cos_sin<V: Lanes>(word: V::Bits) -> (V, V) {
    let within = V::from_integer(V::shift_right::<13>(V::shift_left::<2>(word)));
    let step = std::f64::consts::FRAC_PI_2 * 2.0_f64.powi(-51);
    let middle = std::f64::consts::FRAC_PI_2 * (2.0_f64.powi(-52) - 0.5);
    let angle = within.mul_add(V::splat(step), V::splat(middle));
    let [sin, cos] = of_eighth(angle);
    // quadrant 1: (-sin, cos); 2: (-cos, -sin); 3: (sin, -cos)
    let top = V::splat_bits(1 << 63);
    let low_bit = V::and(V::shift_left::<1>(word), top);
    let high_bit = V::and(word, top);
    let odd = V::from_bits(V::xor(low_bit, V::splat(1.0).to_bits())).less(V::splat(0.0));
    let flip = |v: V, sign: V::Bits| V::from_bits(V::xor(v.to_bits(), sign));
    (flip(V::select(odd, sin, cos), V::xor(high_bit, low_bit)), flip(V::select(odd, cos, sin), high_bit))
}

#[cfg(test)]
#[inline(always)]
fn generic<V: Lanes>(words: [&[u64]; 2], first: &mut [f64], second: Option<&mut [f64]>) {
    let n = first.len();
    assert!(n.is_multiple_of(8), "gaussians are made by eights");
    match second {
        Some(second) => {
            for i in (0..n).step_by(V::N) {
                let r = radius(reduced::<V>(V::load_bits(&words[0][i..])));
                let (cos, sin) = cos_sin::<V>(V::load_bits(&words[1][i..]));
                (r * cos).store(&mut first[i..]);
                (r * sin).store(&mut second[i..]);
            }
        }
        None => {
            for i in (0..n).step_by(V::N) {
                let r = radius(reduced::<V>(V::load_bits(&words[0][i..])));
                (r * cos_sin::<V>(V::load_bits(&words[1][i..])).0).store(&mut first[i..]);
            }
        }
    }
}

/// `first[i], second[i]` from `words[0][i], words[1][i]`: two independent gaussians, or only the
/// first. Fits take [`gaussian_triples`]; this is the same arithmetic on any number of words, to test its distribution.
///
/// # Panics
/// When `first.len()` is no multiple of 8 or another array is shorter.
#[cfg(test)]
fn gaussians(isa: Isa, words: [&[u64]; 2], first: &mut [f64], second: Option<&mut [f64]>) {
    dispatch!(isa, generic [](words: [&[u64]; 2], first: &mut [f64], second: Option<&mut [f64]>));
}

#[inline(always)]
fn triples<V: Lanes>(words: &[[u64; BLOCKS]; WORDS], out: &mut [[f64; 2 * BLOCKS]; 3]) {
    // each step is taken for all words before the next begins: the chains are short and the divider is always busy
    let mut parts = [[[0.0; BLOCKS]; 3]; WORDS / 2];
    for (row, part) in parts.iter_mut().enumerate() {
        for i in (0..BLOCKS).step_by(V::N) {
            let all = reduced::<V>(V::load_bits(&words[2 * row][i..]));
            for k in 0..3 {
                all[k].store(&mut part[k][i..]);
            }
        }
    }
    for [exponent, f, s] in &mut parts {
        for i in (0..BLOCKS).step_by(V::N) {
            radius([V::load(&exponent[i..]), V::load(&f[i..]), V::load(&s[i..])]).store(&mut exponent[i..]);
        }
    }
    let [z, x, y] = out;
    for (row, [radius, ..]) in parts.iter().enumerate() {
        let from = row / 2 * BLOCKS;
        for i in (0..BLOCKS).step_by(V::N) {
            let r = V::load(&radius[i..]);
            let (cos, sin) = cos_sin::<V>(V::load_bits(&words[2 * row + 1][i..]));
            if row % 2 == 0 {
                (r * cos).store(&mut z[from + i..]);
                (r * sin).store(&mut x[from + i..]);
            } else {
                (r * cos).store(&mut y[from + i..]);
            }
        }
    }
}

/// Three gaussians for each half of every block, `out[k][16 half + block]`: the first three of the four that
/// Box and Muller's formula makes of the half's words.
pub fn gaussian_triples(isa: Isa, words: &[[u64; BLOCKS]; WORDS], out: &mut [[f64; 2 * BLOCKS]; 3]) {
    dispatch!(isa, triples [](words: &[[u64; BLOCKS]; WORDS], out: &mut [[f64; 2 * BLOCKS]; 3]));
}

/// The safe twin: the library's `ln`, `sin` and `cos`, one pair at a time.
#[cfg(test)]
fn box_muller_pairs(words: [&[u64]; 2], first: &mut [f64], second: &mut [f64]) {
    for i in 0..first.len() {
        let u = (words[0][i] >> 11) as f64 * 2.0_f64.powi(-53) + 2.0_f64.powi(-54);
        let r = (-2.0 * u.ln()).sqrt();
        let quarter = (words[1][i] >> 62) as f64;
        let within = ((words[1][i] << 2) >> 13) as f64 * 2.0_f64.powi(-51) + (2.0_f64.powi(-52) - 0.5);
        let (sin, cos) = ((quarter + within) * std::f64::consts::FRAC_PI_2).sin_cos();
        first[i] = r * cos;
        second[i] = r * sin;
    }
}

#[cfg(test)]
mod tests {
    use super::super::{chacha8, ulps};
    use super::*;

    fn words(count: usize, seed: u32) -> (Vec<u64>, Vec<u64>) {
        let mut out = [[0; BLOCKS]; WORDS];
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for block in (0..).step_by(BLOCKS) {
            chacha8(Isa::best(), &[seed, 0, 0, 0, 0, 0, 0, 0], 3, block, &mut out);
            for pair in out.chunks_exact(2) {
                a.extend(pair[0]);
                b.extend(pair[1]);
            }
            if a.len() >= count {
                break;
            }
        }
        (a, b)
    }

    #[test]
    fn every_isa_agrees_with_its_twin() {
        let (mut a, b) = words(1 << 16, 1);
        a[..8].copy_from_slice(&[0, u64::MAX, 1 << 11, 1 << 63, u64::MAX - (1 << 11), 1 << 62, 3 << 62, 5]);
        let n = a.len();
        let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
        box_muller_pairs([&a, &b], &mut x, &mut y);
        for isa in Isa::available() {
            let (mut p, mut q) = (vec![0.0; n], vec![0.0; n]);
            gaussians(isa, [&a, &b], &mut p, Some(&mut q));
            let mut worst = 0.0_f64;
            let mut in_ulps = 0.0_f64;
            for i in 0..n {
                let scale = x[i].hypot(y[i]);
                worst = worst.max((p[i] - x[i]).abs().max((q[i] - y[i]).abs()) / scale.max(1e-8));
                in_ulps = in_ulps.max(ulps(p[i].hypot(q[i]), scale));
            }
            println!("gaussians {}: radius {in_ulps:.1} ulp, point {worst:.1e} of the radius", isa.name());
            assert!(worst < 2e-15 && in_ulps < 8.0, "{}: {worst:e} {in_ulps}", isa.name());
            let mut alone = vec![0.0; n];
            gaussians(isa, [&a, &b], &mut alone, None);
            assert_eq!(alone, p);
        }
    }

    /// Twin of the twin: the pairs are held against the library above, the triples are theirs to the bit.
    #[test]
    fn triples_are_the_first_three_of_two_pairs() {
        for isa in Isa::available() {
            let mut words = [[0; BLOCKS]; WORDS];
            chacha8(isa, &[9, 0, 0, 0, 0, 0, 0, 1], 4, 11, &mut words);
            words[2][..3].copy_from_slice(&[0, u64::MAX, 1 << 63]);
            let mut triples = [[0.0; 2 * BLOCKS]; 3];
            gaussian_triples(isa, &words, &mut triples);
            for half in 0..2 {
                let of = |k: usize| &words[4 * half + k][..];
                let [mut z, mut x, mut y, mut unused] = [[0.0; BLOCKS]; 4];
                gaussians(isa, [of(0), of(1)], &mut z, Some(&mut x));
                gaussians(isa, [of(2), of(3)], &mut y, Some(&mut unused));
                for (triple, single) in triples.iter().zip([z, x, y]) {
                    assert_eq!(triple[half * BLOCKS..][..BLOCKS], single, "{} half {half}", isa.name());
                }
            }
        }
    }

    /// Moments to the sixth, the tail beyond 4 and Kolmogorov-Smirnov, each within 5 sigma over four million draws.
    #[test]
    fn they_are_normal() {
        use statrs::distribution::{ContinuousCDF, Normal};
        let (a, b) = words(1 << 21, 2);
        for isa in Isa::available() {
            let (mut p, mut q) = (vec![0.0; a.len()], vec![0.0; a.len()]);
            gaussians(isa, [&a, &b], &mut p, Some(&mut q));
            p.extend(q);
            let n = p.len() as f64;
            for (power, mean, variance) in
                [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0), (6, 15.0, 10170.0)]
            {
                let sum: f64 = p.iter().map(|v| v.powi(power)).sum();
                let sigmas = (sum / n - mean) / (variance / n).sqrt();
                println!("gaussians {}: moment {power} is {sigmas:+.2} sigma off", isa.name());
                assert!(sigmas.abs() < 5.0, "moment {power}: {sigmas} sigma");
            }
            let tail = p.iter().filter(|v| v.abs() > 4.0).count() as f64;
            let expected = 6.334_248_366_623_984e-5 * n;
            println!("gaussians {}: {tail} of {n} beyond 4, expected {expected:.0}", isa.name());
            assert!((tail - expected).abs() < 5.0 * expected.sqrt(), "tail {tail} of {expected}");
            p.sort_by(f64::total_cmp);
            let normal = Normal::standard();
            let distance =
                p.iter().enumerate().map(|(i, v)| (normal.cdf(*v) - (i as f64 + 0.5) / n).abs()).fold(0.0, f64::max);
            println!("gaussians {}: Kolmogorov-Smirnov {:.2}", isa.name(), distance * n.sqrt());
            // 1.95 is exceeded once in a thousand
            assert!(distance * n.sqrt() < 1.95, "Kolmogorov-Smirnov {distance}");
        }
    }
}
