//! A row of 32-bit words, for the random generator: sums, exclusive ors and bit rotations, lane by lane.
//!
//! Two rows are the low and the high halves of 64-bit words. Wide registers can interleave two rows only within parts of
//! 128 bits, so the lanes of a row are ordered such that the interleaved words ascend:
//!
//! ```text
//! place     0 1 2 3 | 4 5 6 7 | ..        order(4 q + r) = 2 q + r, r < 2;   N/2 + 2 q + r - 2 beyond
//! lower halves of all quarters -> words 0 .. N/2,     upper halves -> words N/2 .. N
//! ```

/// `N` words that go through the same arithmetic.
///
/// As with [`super::Lanes`], every method is `#[inline(always)]`.
pub(in crate::simd) trait Words: Copy {
    /// Words in a row, at most 16.
    const N: usize;

    fn splat(value: u32) -> Self;
    /// The first `N` words of `from`; panics when there are fewer.
    fn load(from: &[u32]) -> Self;
    /// Wrapping sum.
    fn plus(self, other: Self) -> Self;
    fn xor(self, other: Self) -> Self;
    /// Rotates left by `BY` bits. `BACK` must be 32 - `BY`: one constant parameter cannot be computed from another.
    fn rotate_left<const BY: i32, const BACK: i32>(self) -> Self;
    /// Place p of a row holds number `order()[p]` of `N` ascending ones.
    fn order() -> &'static [u32];
    /// `low | high << 32` of every lane into the first `N` places of `to`, by ascending order; panics when there are
    /// fewer.
    fn store_pairs(low: Self, high: Self, to: &mut [u64]);
}

/// The order for registers of `N` words that interleave within parts of 128 bits.
#[cfg(target_arch = "x86_64")]
pub(super) const fn quartered<const N: usize>() -> [u32; N] {
    let mut order = [0; N];
    let mut place = 0;
    while place < N {
        let (quarter, rest) = (place / 4, place % 4);
        order[place] = (2 * quarter + rest % 2 + rest / 2 * (N / 2)) as u32;
        place += 1;
    }
    order
}

/// Four words in plain Rust, in their natural order.
#[derive(Clone, Copy)]
pub(in crate::simd) struct PortableWords([u32; 4]);

impl Words for PortableWords {
    const N: usize = 4;

    #[inline(always)]
    fn splat(value: u32) -> PortableWords {
        PortableWords([value; 4])
    }
    #[inline(always)]
    fn load(from: &[u32]) -> PortableWords {
        PortableWords([from[0], from[1], from[2], from[3]])
    }
    #[inline(always)]
    fn plus(self, other: PortableWords) -> PortableWords {
        PortableWords(std::array::from_fn(|k| self.0[k].wrapping_add(other.0[k])))
    }
    #[inline(always)]
    fn xor(self, other: PortableWords) -> PortableWords {
        PortableWords(std::array::from_fn(|k| self.0[k] ^ other.0[k]))
    }
    #[inline(always)]
    fn rotate_left<const BY: i32, const BACK: i32>(self) -> PortableWords {
        PortableWords(self.0.map(|word| word << BY | word >> BACK))
    }
    #[inline(always)]
    fn order() -> &'static [u32] {
        &[0, 1, 2, 3]
    }
    #[inline(always)]
    fn store_pairs(low: PortableWords, high: PortableWords, to: &mut [u64]) {
        for (k, word) in to[..4].iter_mut().enumerate() {
            *word = u64::from(low.0[k]) | u64::from(high.0[k]) << 32;
        }
    }
}
