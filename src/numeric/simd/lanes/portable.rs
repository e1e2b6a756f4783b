//! Four lanes in plain Rust: every product and sum rounded on its own, so the bits are the same on every machine.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use super::Lanes;
use super::words::PortableWords;

/// Four numbers, for which compilers use two SSE2 or NEON registers.
#[derive(Clone, Copy)]
pub(in crate::simd) struct Portable([f64; 4]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Portable, f: impl Fn(f64, f64) -> f64) -> Portable {
        Portable(from_fn(|k| f(self.0[k], other.0[k])))
    }
}

impl Add for Portable {
    type Output = Portable;
    #[inline(always)]
    fn add(self, other: Portable) -> Portable {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Portable {
    type Output = Portable;
    #[inline(always)]
    fn sub(self, other: Portable) -> Portable {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Portable {
    type Output = Portable;
    #[inline(always)]
    fn mul(self, other: Portable) -> Portable {
        self.zip(other, |a, b| a * b)
    }
}

impl Lanes for Portable {
    const N: usize = 4;
    type Mask = [bool; 4];
    type Bits = [u64; 4];
    type Words = PortableWords;

    #[inline(always)]
    fn splat(value: f64) -> Portable {
        Portable([value; 4])
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Portable {
        let from = &from[..4];
        Portable(from_fn(|k| from[k]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..4].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, b: Portable, c: Portable) -> Portable {
        self * b + c
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Portable, c: Portable) -> Portable {
        c - self * b
    }
    #[inline(always)]
    fn div(self, by: Portable) -> Portable {
        self.zip(by, |a, b| a / b)
    }
    #[inline(always)]
    fn max(self, other: Portable) -> Portable {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self) -> Portable {
        Portable(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn sqrt(self) -> Portable {
        Portable(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn sqrt_ratio(self, by: Portable) -> Portable {
        self.div(by).sqrt()
    }
    #[inline(always)]
    fn less(self, other: Portable) -> [bool; 4] {
        from_fn(|k| self.0[k] < other.0[k])
    }
    #[inline(always)]
    fn select(mask: [bool; 4], yes: Portable, no: Portable) -> Portable {
        Portable(from_fn(|k| if mask[k] { yes.0[k] } else { no.0[k] }))
    }
    #[inline(always)]
    fn with_sign_of(self, sign: Portable) -> Portable {
        self.zip(sign, f64::copysign)
    }
    #[inline(always)]
    fn to_bits(self) -> [u64; 4] {
        self.0.map(f64::to_bits)
    }
    #[inline(always)]
    fn from_bits(bits: [u64; 4]) -> Portable {
        Portable(bits.map(f64::from_bits))
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> [u64; 4] {
        let from = &from[..4];
        from_fn(|k| from[k])
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> [u64; 4] {
        [value; 4]
    }
    #[inline(always)]
    fn and(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
        from_fn(|k| a[k] & b[k])
    }
    #[inline(always)]
    fn xor(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
        from_fn(|k| a[k] ^ b[k])
    }
    #[inline(always)]
    fn plus(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
        from_fn(|k| a[k].wrapping_add(b[k]))
    }
    #[inline(always)]
    fn shift_right<const BY: u32>(a: [u64; 4]) -> [u64; 4] {
        a.map(|v| v >> BY)
    }
    #[inline(always)]
    fn shift_left<const BY: u32>(a: [u64; 4]) -> [u64; 4] {
        a.map(|v| v << BY)
    }
    #[inline(always)]
    fn from_integer(a: [u64; 4]) -> Portable {
        Portable(a.map(|v| v as f64))
    }
}
