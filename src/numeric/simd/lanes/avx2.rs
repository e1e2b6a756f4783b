//! Four lanes of AVX2 with fused multiply-add.
//!
//! SAFETY of every block below: the intrinsics need AVX2 and FMA. This type has no name outside this folder; kernels are
//! compiled for it by `dispatch` alone, in a function that carries both and is called only with the proof
//! ([`super::detected`]) that the processor has them. Loads and stores go through slices cut to their length before.

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::Lanes;
use super::words::{Words, quartered};

/// One 256-bit register.
#[derive(Clone, Copy)]
pub(in crate::simd) struct Avx2(__m256d);

impl Add for Avx2 {
    type Output = Avx2;
    #[inline(always)]
    fn add(self, other: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_add_pd(self.0, other.0) })
    }
}

impl Sub for Avx2 {
    type Output = Avx2;
    #[inline(always)]
    fn sub(self, other: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_sub_pd(self.0, other.0) })
    }
}

impl Mul for Avx2 {
    type Output = Avx2;
    #[inline(always)]
    fn mul(self, other: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_mul_pd(self.0, other.0) })
    }
}

impl Lanes for Avx2 {
    const N: usize = 4;
    type Mask = __m256d;
    type Bits = __m256i;
    type Words = Avx2Words;

    #[inline(always)]
    fn splat(value: f64) -> Avx2 {
        Avx2(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Avx2 {
        let from = &from[..4];
        Avx2(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..4];
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn mul_add(self, b: Avx2, c: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Avx2, c: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn div(self, by: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_div_pd(self.0, by.0) })
    }
    #[inline(always)]
    fn max(self, other: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Avx2 {
        Avx2(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Avx2 {
        Avx2(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn sqrt_ratio(self, by: Avx2) -> Avx2 {
        self.div(by).sqrt()
    }
    #[inline(always)]
    fn less(self, other: Avx2) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Avx2, no: Avx2) -> Avx2 {
        Avx2(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn with_sign_of(self, sign: Avx2) -> Avx2 {
        unsafe {
            let bit = _mm256_set1_pd(-0.0);
            Avx2(_mm256_or_pd(_mm256_andnot_pd(bit, self.0), _mm256_and_pd(bit, sign.0)))
        }
    }
    #[inline(always)]
    fn to_bits(self) -> __m256i {
        unsafe { _mm256_castpd_si256(self.0) }
    }
    #[inline(always)]
    fn from_bits(bits: __m256i) -> Avx2 {
        Avx2(unsafe { _mm256_castsi256_pd(bits) })
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> __m256i {
        let from = &from[..4];
        unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> __m256i {
        unsafe { _mm256_set1_epi64x(value.cast_signed()) }
    }
    #[inline(always)]
    fn and(a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_and_si256(a, b) }
    }
    #[inline(always)]
    fn xor(a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_xor_si256(a, b) }
    }
    #[inline(always)]
    fn plus(a: __m256i, b: __m256i) -> __m256i {
        unsafe { _mm256_add_epi64(a, b) }
    }
    #[inline(always)]
    fn shift_right<const BY: u32>(a: __m256i) -> __m256i {
        unsafe { _mm256_srl_epi64(a, _mm_cvtsi64_si128(i64::from(BY))) }
    }
    #[inline(always)]
    fn shift_left<const BY: u32>(a: __m256i) -> __m256i {
        unsafe { _mm256_sll_epi64(a, _mm_cvtsi64_si128(i64::from(BY))) }
    }
    /// Exact: the upper and lower halves of each word go into the mantissas of 2^84 and 2^52, whose sum is subtracted.
    #[inline(always)]
    fn from_integer(a: __m256i) -> Avx2 {
        unsafe {
            let high = _mm256_or_si256(_mm256_srli_epi64::<32>(a), _mm256_set1_epi64x(0x4530_0000_0000_0000));
            let low = _mm256_blend_epi32::<0b1010_1010>(a, _mm256_set1_epi64x(0x4330_0000_0000_0000));
            let offset = _mm256_set1_pd(19_342_813_118_337_666_422_669_312.0); // 2^84 + 2^52
            Avx2(_mm256_add_pd(_mm256_sub_pd(_mm256_castsi256_pd(high), offset), _mm256_castsi256_pd(low)))
        }
    }
}

/// Eight words in one 256-bit register.
#[derive(Clone, Copy)]
pub(in crate::simd) struct Avx2Words(__m256i);

const ORDER: [u32; 8] = quartered();

impl Words for Avx2Words {
    const N: usize = 8;

    #[inline(always)]
    fn splat(value: u32) -> Avx2Words {
        Avx2Words(unsafe { _mm256_set1_epi32(value.cast_signed()) })
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Avx2Words {
        let from = &from[..8];
        Avx2Words(unsafe { _mm256_loadu_si256(from.as_ptr().cast()) })
    }
    #[inline(always)]
    fn plus(self, other: Avx2Words) -> Avx2Words {
        Avx2Words(unsafe { _mm256_add_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn xor(self, other: Avx2Words) -> Avx2Words {
        Avx2Words(unsafe { _mm256_xor_si256(self.0, other.0) })
    }
    #[inline(always)]
    fn rotate_left<const BY: i32, const BACK: i32>(self) -> Avx2Words {
        unsafe {
            let (left, right) = (_mm256_slli_epi32::<BY>(self.0), _mm256_srli_epi32::<BACK>(self.0));
            Avx2Words(_mm256_or_si256(left, right))
        }
    }
    #[inline(always)]
    fn order() -> &'static [u32] {
        &ORDER
    }
    #[inline(always)]
    fn store_pairs(low: Avx2Words, high: Avx2Words, to: &mut [u64]) {
        let (first, second) = to[..8].split_at_mut(4);
        unsafe {
            _mm256_storeu_si256(first.as_mut_ptr().cast(), _mm256_unpacklo_epi32(low.0, high.0));
            _mm256_storeu_si256(second.as_mut_ptr().cast(), _mm256_unpackhi_epi32(low.0, high.0));
        }
    }
}
