//! Eight lanes of AVX-512.
//!
//! SAFETY of every block below: the intrinsics need AVX-512 F and DQ. This type has no name outside this folder; kernels are
//! compiled for it by `dispatch` alone, in a function that carries both and is called only with the proof
//! ([`super::detected`]) that the processor has them. Loads and stores go through slices cut to their length before.

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::Lanes;
use super::words::{Words, quartered};

/// One 512-bit register.
#[derive(Clone, Copy)]
pub(in crate::simd) struct Avx512(__m512d);

/// `e p` with `1/sqrt(x) = y (1 + e p)`, for `t = x y`. y is good to 2^-14, so `e = 1 - x y^2` is below 2^-13, and the series
/// in e up to its third power is good to 2^-54. This takes six operations on the two multipliers, where the divider would
/// take 24 cycles for eight roots.
#[inline(always)]
fn root_correction(y: __m512d, t: __m512d) -> __m512d {
    unsafe {
        let e = _mm512_fnmadd_pd(t, y, _mm512_set1_pd(1.0));
        let p = _mm512_fmadd_pd(e, _mm512_set1_pd(0.3125), _mm512_set1_pd(0.375));
        let p = _mm512_fmadd_pd(e, p, _mm512_set1_pd(0.5));
        _mm512_mul_pd(e, p)
    }
}

impl Add for Avx512 {
    type Output = Avx512;
    #[inline(always)]
    fn add(self, other: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_add_pd(self.0, other.0) })
    }
}

impl Sub for Avx512 {
    type Output = Avx512;
    #[inline(always)]
    fn sub(self, other: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_sub_pd(self.0, other.0) })
    }
}

impl Mul for Avx512 {
    type Output = Avx512;
    #[inline(always)]
    fn mul(self, other: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_mul_pd(self.0, other.0) })
    }
}

impl Lanes for Avx512 {
    const N: usize = 8;
    type Mask = __mmask8;
    type Bits = __m512i;
    type Words = Avx512Words;

    #[inline(always)]
    fn splat(value: f64) -> Avx512 {
        Avx512(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Avx512 {
        let from = &from[..8];
        Avx512(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..8];
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn mul_add(self, b: Avx512, c: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Avx512, c: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn div(self, by: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_div_pd(self.0, by.0) })
    }
    #[inline(always)]
    fn max(self, other: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Avx512 {
        Avx512(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Avx512 {
        unsafe {
            let y = _mm512_rsqrt14_pd(self.0);
            let t = _mm512_mul_pd(self.0, y);
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_setzero_pd());
            Avx512(_mm512_maskz_fmadd_pd(positive, root_correction(y, t), t, t))
        }
    }
    #[inline(always)]
    fn sqrt_ratio(self, by: Avx512) -> Avx512 {
        unsafe {
            let x = _mm512_mul_pd(self.0, by.0);
            let y = _mm512_rsqrt14_pd(x);
            let t = _mm512_mul_pd(x, y);
            let start = _mm512_mul_pd(self.0, y);
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(x, _mm512_setzero_pd());
            Avx512(_mm512_maskz_fmadd_pd(positive, root_correction(y, t), start, start))
        }
    }
    #[inline(always)]
    fn less(self, other: Avx512) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, yes: Avx512, no: Avx512) -> Avx512 {
        Avx512(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn with_sign_of(self, sign: Avx512) -> Avx512 {
        unsafe {
            let bit = _mm512_set1_epi64(i64::MIN);
            let (a, b) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(sign.0));
            // bitwise `bit ? b : a`
            Avx512(_mm512_castsi512_pd(_mm512_ternarylogic_epi64::<0xCA>(bit, b, a)))
        }
    }
    #[inline(always)]
    fn to_bits(self) -> __m512i {
        unsafe { _mm512_castpd_si512(self.0) }
    }
    #[inline(always)]
    fn from_bits(bits: __m512i) -> Avx512 {
        Avx512(unsafe { _mm512_castsi512_pd(bits) })
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> __m512i {
        let from = &from[..8];
        unsafe { _mm512_loadu_si512(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> __m512i {
        unsafe { _mm512_set1_epi64(value.cast_signed()) }
    }
    #[inline(always)]
    fn and(a: __m512i, b: __m512i) -> __m512i {
        unsafe { _mm512_and_si512(a, b) }
    }
    #[inline(always)]
    fn xor(a: __m512i, b: __m512i) -> __m512i {
        unsafe { _mm512_xor_si512(a, b) }
    }
    #[inline(always)]
    fn plus(a: __m512i, b: __m512i) -> __m512i {
        unsafe { _mm512_add_epi64(a, b) }
    }
    #[inline(always)]
    fn shift_right<const BY: u32>(a: __m512i) -> __m512i {
        unsafe { _mm512_srli_epi64::<BY>(a) }
    }
    #[inline(always)]
    fn shift_left<const BY: u32>(a: __m512i) -> __m512i {
        unsafe { _mm512_slli_epi64::<BY>(a) }
    }
    #[inline(always)]
    fn from_integer(a: __m512i) -> Avx512 {
        Avx512(unsafe { _mm512_cvtepu64_pd(a) })
    }
}

/// Sixteen words in one 512-bit register.
#[derive(Clone, Copy)]
pub(in crate::simd) struct Avx512Words(__m512i);

const ORDER: [u32; 16] = quartered();

impl Words for Avx512Words {
    const N: usize = 16;

    #[inline(always)]
    fn splat(value: u32) -> Avx512Words {
        Avx512Words(unsafe { _mm512_set1_epi32(value.cast_signed()) })
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Avx512Words {
        let from = &from[..16];
        Avx512Words(unsafe { _mm512_loadu_si512(from.as_ptr().cast()) })
    }
    #[inline(always)]
    fn plus(self, other: Avx512Words) -> Avx512Words {
        Avx512Words(unsafe { _mm512_add_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn xor(self, other: Avx512Words) -> Avx512Words {
        Avx512Words(unsafe { _mm512_xor_si512(self.0, other.0) })
    }
    #[inline(always)]
    fn rotate_left<const BY: i32, const BACK: i32>(self) -> Avx512Words {
        Avx512Words(unsafe { _mm512_rol_epi32::<BY>(self.0) })
    }
    #[inline(always)]
    fn order() -> &'static [u32] {
        &ORDER
    }
    #[inline(always)]
    fn store_pairs(low: Avx512Words, high: Avx512Words, to: &mut [u64]) {
        let (first, second) = to[..16].split_at_mut(8);
        unsafe {
            _mm512_storeu_si512(first.as_mut_ptr().cast(), _mm512_unpacklo_epi32(low.0, high.0));
            _mm512_storeu_si512(second.as_mut_ptr().cast(), _mm512_unpackhi_epi32(low.0, high.0));
        }
    }
}
