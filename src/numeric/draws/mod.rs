//! Random numbers by address: each `(seed, replicate, effect, nominal contact)` has its own draws.
//!
//! ```text
//! ChaCha8 key = (seed, effect)      stream = nominal contact      position = replicate * slot
//! u = (k + 1/2) 2^-53, k of 53 bits              n0, n1 = sqrt(-2 ln u0) (cos, sin)(2 pi u1)
//! ```
//!
//! A draw is a function of its address alone: adding an effect, a replicate or a contact moves no other draw, and any
//! split of the replicates into blocks gives the same bits. Along one contact the replicates lie next to each other,
//! so that a block of them is one run of the generator and one branch-free Box-Muller loop that compilers vectorise.
//! ChaCha8: D. J. Bernstein, *ChaCha, a variant of Salsa20*, 2008. G. E. P. Box, M. E. Muller, *Ann. Math. Stat.* 29
//! (1958) 610.

mod gaussian;
mod law;
mod lcg;

use std::sync::Arc;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::Distribution;

pub use gaussian::{BoxMuller, OpenUniform, box_muller, uniform_open};
pub use law::{DrawSource, NoiseLaw};
pub use lcg::Lcg;

/// The golden section, less one.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Number `k` of a sequence that falls evenly into 0 to 1 wherever it is broken off: the multiples of the golden section, modulo 1.
///
/// ```
/// use palpate_numeric::draws::evenly;
///
/// let low = (0..1000).filter(|k| evenly(*k) < 0.3).count();
/// assert!(low.abs_diff(300) <= 2);
/// ```
pub fn evenly(k: usize) -> f64 {
    (k as f64 * GOLDEN).fract()
}

/// Words (u64) drawn from the generator at once: enough for the vector loop, and few enough (512 bytes) that clearing
/// the buffer costs a single replicate little.
const CHUNK: usize = 64;

/// The draws of one effect under one seed.
#[derive(Clone, Debug)]
pub struct EffectDraws {
    key: [u8; 32],
    /// Added to every replicate's number: other draws of the same effect.
    later: u64,
    law: NoiseLaw,
    source: Option<Arc<dyn DrawSource>>,
}

impl EffectDraws {
    /// Draws of the effect called `name` under `seed`. Because the address holds the name and not a
    /// position in a list, a new effect changes no other effect's draws.
    pub fn new(seed: u64, name: &str) -> EffectDraws {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&fnv1a(name.as_bytes()).to_le_bytes());
        EffectDraws { key, later: 0, law: NoiseLaw::Normal, source: None }
    }

    /// The same effect's draws under a law of this shape.
    pub fn with_law(self, law: NoiseLaw) -> EffectDraws {
        EffectDraws { law, ..self }
    }

    /// The draws of the replicates that lie `replicates` further on.
    pub fn later(self, replicates: u64) -> EffectDraws {
        EffectDraws { later: self.later.wrapping_add(replicates), ..self }
    }

    /// All numbers from `source` instead.
    pub fn from_source(source: Arc<dyn DrawSource>) -> EffectDraws {
        EffectDraws { key: [0; 32], later: 0, law: NoiseLaw::Normal, source: Some(source) }
    }

    /// The shape of the errors; [`NoiseLaw::Normal`] unless another was asked for.
    pub fn law(&self) -> NoiseLaw {
        self.law
    }

    /// The numbers are a script and not random: an effect at rest, or its derivative. An effect that takes its numbers from
    /// [`EffectDraws::generator`] does nothing then.
    pub fn is_scripted(&self) -> bool {
        self.source.is_some()
    }

    /// The generator of one contact in one replicate, for an effect of the caller's own: whatever `rand` and
    /// `rand_distr` can do with it, up to 512 draws of 64 bits, is as repeatable as the built-in effects.
    pub fn generator(&self, contact: u64, replicate: u64) -> ChaCha8Rng {
        self.at(contact, u128::from(replicate.wrapping_add(self.later)) << law::SLOT_BITS)
    }

    /// The generator's key, for kernels that run many blocks of it at once.
    pub fn key(&self) -> [u32; 8] {
        let (words, _) = self.key.as_chunks::<4>();
        std::array::from_fn(|k| u32::from_le_bytes(words[k]))
    }

    /// Fills `out` with `per` gaussians for each replicate from `first_replicate` on: `out[b * per + i]`.
    ///
    /// `out.len()` should be a multiple of `per`; numbers beyond the last multiple are left untouched.
    ///
    /// # Panics
    /// When `per` exceeds 64.
    pub fn gaussians(&self, contact: u64, first_replicate: u64, per: usize, out: &mut [f64]) {
        if let Some(source) = &self.source {
            return source.gaussians(contact, first_replicate, per, out);
        }
        if self.law != NoiseLaw::Normal {
            return self.shaped(contact, first_replicate, per, out, |v| v);
        }
        self.fill(contact, first_replicate, per, out, box_muller);
    }

    /// Fills `out` with `per` uniforms in (0, 1), both ends excluded, for each replicate: `out[b * per + i]`.
    ///
    /// # Panics
    /// When `per` exceeds 64.
    pub fn uniforms(&self, contact: u64, first_replicate: u64, per: usize, out: &mut [f64]) {
        if let Some(source) = &self.source {
            return source.uniforms(contact, first_replicate, per, out);
        }
        if self.law != NoiseLaw::Normal {
            // the mean and sd of the uniform law, in another shape
            return self.shaped(contact, first_replicate, per, out, |v| 0.5 + law::UNIFORM_SD * v);
        }
        self.fill(contact, first_replicate, per, out, |words, values| {
            for (value, word) in values.iter_mut().zip(words) {
                *value = uniform_open(*word);
            }
        });
    }

    fn shaped(&self, contact: u64, first: u64, per: usize, out: &mut [f64], map: impl Fn(f64) -> f64) {
        if per == 0 {
            return;
        }
        for (b, values) in out.chunks_exact_mut(per).enumerate() {
            let mut generator = self.generator(contact, first.wrapping_add(b as u64));
            values.iter_mut().for_each(|value| *value = map(self.law.sample(&mut generator)));
        }
    }

    fn fill(
        &self,
        contact: u64,
        first_replicate: u64,
        per: usize,
        out: &mut [f64],
        transform: impl Fn(&[u64], &mut [f64]),
    ) {
        if per == 0 || out.is_empty() {
            return;
        }
        // slots are even, because gaussians come in pairs
        let slot = per.next_multiple_of(2);
        let replicates = out.len() / per;
        let mut generator = self.at(contact, u128::from(first_replicate.wrapping_add(self.later)) * slot as u128 * 2);
        assert!(slot <= CHUNK, "an effect draws at most {CHUNK} numbers per contact");
        let at_once = CHUNK / slot;
        let mut words = [0_u64; CHUNK];
        let mut values = [0.0; CHUNK];
        for block in out[..replicates * per].chunks_mut(at_once * per) {
            let count = block.len() / per * slot;
            for word in &mut words[..count] {
                *word = generator.next_u64();
            }
            transform(&words[..count], &mut values[..count]);
            for (target, drawn) in block.chunks_exact_mut(per).zip(values.chunks_exact(slot)) {
                target.copy_from_slice(&drawn[..per]);
            }
        }
    }

    fn at(&self, contact: u64, word: u128) -> ChaCha8Rng {
        let mut generator = ChaCha8Rng::from_seed(self.key);
        generator.set_stream(contact);
        generator.set_word_pos(word);
        generator
    }
}

/// 64-bit FNV-1a, which makes keys of effect names. A test shows that the dozen names do not collide.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_split_into_blocks_gives_the_same_bits() {
        let draws = EffectDraws::new(7, "row_noise");
        for per in [1, 2, 3, 5] {
            let mut whole = vec![0.0; per * 700];
            draws.gaussians(11, 40, per, &mut whole);
            for (first, count) in [(0, 1), (0, 700), (1, 255), (256, 257), (513, 187), (699, 1)] {
                let mut part = vec![0.0; per * count];
                draws.gaussians(11, 40 + first as u64, per, &mut part);
                assert_eq!(part, whole[first * per..(first + count) * per]);
            }
        }
    }

    /// Mean 0 and sd 1 for every law, any split, and other replicates further on.
    #[test]
    fn laws_are_standardised_and_addressed() {
        let laws = [NoiseLaw::Uniform, NoiseLaw::StudentT { dof: 5.0 }, NoiseLaw::Laplace, NoiseLaw::Triangular];
        for law in laws {
            let draws = EffectDraws::new(5, "shaped").with_law(law);
            let mut whole = vec![0.0; 200_000];
            draws.gaussians(3, 0, 2, &mut whole);
            let mean = whole.iter().sum::<f64>() / 2e5;
            let variance = whole.iter().map(|v| v * v).sum::<f64>() / 2e5;
            assert!(mean.abs() < 0.015 && (variance - 1.0).abs() < 0.05, "{law}: {mean} {variance}");
            let mut part = vec![0.0; 60];
            draws.clone().later(500).gaussians(3, 77, 2, &mut part);
            assert_eq!(part, whole[2 * 577..2 * 607], "{law}");
        }
    }

    /// Draws of ranges of replicates that are far apart, and of neighbours, do not correlate; nor do contacts or effects.
    #[test]
    fn ranges_do_not_correlate() {
        const COUNT: usize = 1 << 16;
        let column = |name: &str, contact: u64, first: u64| {
            let mut out = vec![0.0; COUNT];
            EffectDraws::new(9, name).gaussians(contact, first, 1, &mut out);
            out
        };
        let reference = column("a", 7, 0);
        let n = COUNT as u64;
        let others = [
            column("a", 7, n),
            column("a", 7, 2 * n),
            column("a", 7, 1 << 32),
            column("a", 7, (1 << 40) + 1),
            column("a", 8, 0),
            column("b", 7, 0),
        ];
        for (k, other) in others.iter().enumerate() {
            let dot: f64 = reference.iter().zip(other).map(|(a, b)| a * b).sum();
            let squares: f64 = reference.iter().zip(other).map(|(a, b)| (a * a - 1.0) * (b * b - 1.0)).sum();
            let root = (COUNT as f64).sqrt();
            assert!((dot / root).abs() < 5.0 && (squares / root / 2.0).abs() < 5.0, "{k}: {dot} {squares}");
        }
        // an overlap would lower the variance of the mean over ranges: 64 of them against 1/length
        let means = (0..64).map(|k| column("a", 1, k * n).iter().sum::<f64>() / (COUNT as f64).sqrt());
        let variance: f64 = means.map(|m| m * m).sum::<f64>() / 64.0;
        assert!((0.5..1.7).contains(&variance), "{variance}");
    }

    /// A contact's stream is a generator of rand, and both kinds of numbers are laws of it: what is drawn in lanes is what
    /// they draw one by one.
    #[test]
    fn blocks_are_what_the_laws_draw_from_the_stream() {
        let draws = EffectDraws::new(9, "stream");
        let (mut gaussians, mut uniforms) = ([0.0; 90], [0.0; 90]);
        draws.gaussians(4, 6, 3, &mut gaussians);
        draws.uniforms(4, 6, 3, &mut uniforms);
        // slots of four words, two halves each
        let mut stream = draws.at(4, 6 * 4 * 2);
        for three in gaussians.chunks_exact(3) {
            let [a, b]: [[f64; 2]; 2] = [BoxMuller.sample(&mut stream), BoxMuller.sample(&mut stream)];
            assert_eq!(three, [a[0], a[1], b[0]]);
        }
        let mut stream = draws.at(4, 6 * 4 * 2);
        for three in uniforms.chunks_exact(3) {
            let four = [(); 4].map(|()| OpenUniform.sample(&mut stream));
            assert_eq!(three, &four[..3]);
        }
    }

    /// Every language repeats the generator to the bit, so rand's uniform law must be its own formula.
    #[test]
    fn the_congruential_generator_is_uniform_by_the_upper_53_bits() {
        let (mut lcg, mut state) = (Lcg::new(3), 3_u64);
        for _ in 0..100 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            assert_eq!(lcg.uniform(), (state >> 11) as f64 / 9_007_199_254_740_992.0);
        }
        assert_eq!(Lcg::from_seed(5_u64.to_le_bytes()).uniform(), Lcg::new(5).uniform());
    }

    #[test]
    fn every_part_of_the_address_matters() {
        let draw = |seed, name, contact, replicate| {
            let mut out = [0.0; 3];
            EffectDraws::new(seed, name).gaussians(contact, replicate, 3, &mut out);
            out
        };
        let reference = draw(1, "a", 1, 1);
        assert_eq!(reference, draw(1, "a", 1, 1));
        for other in [draw(2, "a", 1, 1), draw(1, "b", 1, 1), draw(1, "a", 2, 1), draw(1, "a", 1, 2)] {
            assert!(reference.iter().zip(&other).all(|(a, b)| a != b));
        }
    }

    /// Moments to the sixth and lag-one products, each within 5 sigma of its estimate over 10^6 draws.
    #[test]
    fn gaussians_have_the_moments_of_the_normal_distribution() {
        let count = 1_000_000;
        let mut out = vec![0.0; count];
        EffectDraws::new(3, "moments").gaussians(0, 0, 1, &mut out);
        // (power, mean, variance of the power)
        for (power, mean, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0), (6, 15.0, 10170.0)]
        {
            let sum: f64 = out.iter().map(|v| v.powi(power)).sum();
            let sigmas = (sum / count as f64 - mean) / (variance / count as f64).sqrt();
            assert!(sigmas.abs() < 5.0, "moment {power}: {sigmas} sigma");
        }
        let lag: f64 = out.windows(2).map(|w| w[0] * w[1]).sum();
        assert!((lag / (count as f64).sqrt()).abs() < 5.0);
    }

    #[test]
    fn uniforms_are_open_and_uniform() {
        let mut out = vec![0.0; 1_000_000];
        EffectDraws::new(3, "uniform").uniforms(5, 0, 2, &mut out);
        assert!(out.iter().all(|u| *u > 0.0 && *u < 1.0));
        let mut bins = [0_u32; 100];
        out.iter().for_each(|u| bins[(u * 100.0) as usize] += 1);
        let chi2: f64 = bins.iter().map(|b| (f64::from(*b) - 1e4).powi(2) / 1e4).sum();
        assert!((50.0..170.0).contains(&chi2), "chi-square with 99 degrees of freedom: {chi2}");
        assert_eq!(uniform_open(0), 0.5_f64.powi(54));
        assert!(uniform_open(u64::MAX) < 1.0);
    }
}
