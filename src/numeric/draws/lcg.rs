//! A generator that every language can repeat to the bit.
//!
//! ```text
//! state <- state * 6364136223846793005 + 1442695040888963407  (mod 2^64),   uniform = (state >> 11) / 2^53
//! ```

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

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.state >> 11) as f64 / 9007199254740992.0
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
