//! A generator that every language can repeat to the bit.
//!
//! ```text
//! state <- state * 6364136223846793005 + 1442695040888963407  (mod 2^64),   uniform = (state >> 11) / 2^53
//! ```

use std::convert::Infallible;

use rand::distr::{Distribution, StandardUniform};
use rand::{SeedableRng, TryRng};

/// Knuth's linear congruential generator: enough to scatter test sites, and the same in every language.
#[derive(Clone, Debug)]
pub struct Lcg {
    state: u64,
}

impl Lcg {
    /// Starts with `seed` as the state.
    pub fn new(seed: u64) -> Lcg {
        Lcg { state: seed }
    }

    /// Uniform in [0, 1): rand's, which takes the upper 53 bits.
    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(self)
    }

    /// Sum of twelve uniforms less six: mean 0, variance 1.
    pub fn normal(&mut self) -> f64 {
        let mut total = 0.0;
        for _ in 0..12 {
            total += self.uniform();
        }
        total - 6.0
    }
}

impl TryRng for Lcg {
    type Error = Infallible;

    /// The upper half, because the lower bits have short periods.
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.try_next_u64().map(|word| (word >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.state = self.state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        Ok(self.state)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for part in bytes.chunks_mut(8) {
            let word = self.try_next_u64()?.to_le_bytes();
            part.copy_from_slice(&word[..part.len()]);
        }
        Ok(())
    }
}

impl SeedableRng for Lcg {
    type Seed = [u8; 8];

    fn from_seed(seed: [u8; 8]) -> Lcg {
        Lcg::new(u64::from_le_bytes(seed))
    }
}
