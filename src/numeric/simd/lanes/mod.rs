//! A handful of `f64` lanes under one name, so that every kernel is written once as its formula.
//!
//! Three sets stand behind it: [`Portable`] (four lanes of plain Rust, the same bits on every machine), and on x86-64
//! `Avx2` (four lanes with fused multiply-add) and `Avx512` (eight). A kernel is generic over [`Lanes`] and inlined
//! whole into a function that carries the instruction set; see [`super::dispatch`]. The two wide types are private to
//! this folder: a kernel is compiled for them only through a [`Kind`] that was detected on this machine.
//!
//! `pulp`, which faer brings, has the sums and products but no estimate of a reciprocal root, no shift of 64-bit words, no
//! conversion from integers and no bit rotation: seven of the 24 kernels would keep these types beside pulp's. Its 512-bit lanes are
//! one switch for all crates, faer among them, whose answers would move (`benches/runs/lanes.md`).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod detected;
mod portable;
mod words;

#[cfg(target_arch = "x86_64")]
pub(super) use detected::Detected;
pub(super) use detected::Kind;
pub(super) use portable::Portable;
pub(super) use words::Words;

use std::ops::{Add, Mul, Sub};

/// `N` numbers that go through the same arithmetic.
///
/// Every method is `#[inline(always)]` in every implementation, because it is fast only inside the function that carries
/// the instruction set.
pub(super) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// Number of lanes.
    const N: usize;
    /// One truth value for each lane.
    type Mask: Copy;
    /// The lanes' bit patterns.
    type Bits: Copy;
    /// A register of 32-bit words of the same set.
    type Words: Words;

    fn splat(value: f64) -> Self;
    /// The first `N` numbers of `from`; panics when there are fewer.
    fn load(from: &[f64]) -> Self;
    /// Into the first `N` places of `to`; panics when there are fewer.
    fn store(self, to: &mut [f64]);
    /// `self * b + c`, fused where the set can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, fused where the set can.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    fn div(self, by: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// `sqrt(self)` to one unit in the last place; 0 at 0.
    fn sqrt(self) -> Self;
    /// `sqrt(self / by)` to two units in the last place; 0 where `self` is 0. `self * by` must not overflow.
    fn sqrt_ratio(self, by: Self) -> Self;
    /// Lanes where `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    fn with_sign_of(self, sign: Self) -> Self;

    fn to_bits(self) -> Self::Bits;
    fn from_bits(bits: Self::Bits) -> Self;
    /// The first `N` words of `from`; panics when there are fewer.
    fn load_bits(from: &[u64]) -> Self::Bits;
    fn splat_bits(value: u64) -> Self::Bits;
    fn and(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// Wrapping sum.
    fn plus(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    fn shift_right<const BY: u32>(a: Self::Bits) -> Self::Bits;
    fn shift_left<const BY: u32>(a: Self::Bits) -> Self::Bits;
    /// Integers below 2^53 as numbers, exactly.
    fn from_integer(a: Self::Bits) -> Self;

    /// The sum of all lanes, in the fixed order of pairs.
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; 8];
        self.store(&mut lanes);
        ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
    }
}
