//! The kernel `src/numeric/simd/gram_rows.rs` once more, by pulp.

use pulp::{Simd, WithSimd};

/// Rows of G in a tile. With two sets of lanes there are eight sums, enough to hide the latency of multiply-adds.
const TALL: usize = 4;

struct GramRows<'a> {
    stride: usize,
    rows: &'a [f64],
    out: &'a mut [f64],
}

impl GramRows<'_> {
    #[inline(always)]
    fn tile<S: Simd, const SETS: usize>(&mut self, simd: S, [i, j]: [usize; 2]) {
        let stride = self.stride;
        let zero = simd.splat_f64s(0.0);
        let mut sums = [[zero; SETS]; TALL];
        for (a, line) in sums.iter_mut().enumerate() {
            let (from, _) = S::as_simd_f64s(&self.out[(i + a) * stride + j..][..SETS * S::F64_LANES]);
            line.copy_from_slice(from);
        }
        for row in self.rows.chunks_exact(stride) {
            let (right, _) = S::as_simd_f64s(&row[j..j + SETS * S::F64_LANES]);
            for (line, left) in sums.iter_mut().zip(&row[i..i + TALL]) {
                let left = simd.splat_f64s(*left);
                for (sum, r) in line.iter_mut().zip(right) {
                    *sum = simd.mul_add_e_f64s(left, *r, *sum);
                }
            }
        }
        for (a, line) in sums.iter().enumerate() {
            let (to, _) = S::as_mut_simd_f64s(&mut self.out[(i + a) * stride + j..][..SETS * S::F64_LANES]);
            to.copy_from_slice(line);
        }
    }
}

impl WithSimd for GramRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for i in (0..self.stride).step_by(TALL) {
            let mut j = 0;
            while j < i + TALL {
                if j + 2 * S::F64_LANES <= self.stride {
                    self.tile::<S, 2>(simd, [i, j]);
                    j += 2 * S::F64_LANES;
                } else {
                    self.tile::<S, 1>(simd, [i, j]);
                    j += S::F64_LANES;
                }
            }
        }
    }
}

/// Adds `J' J` to the lower triangle of `out`, by the set of this name.
///
/// # Panics
/// Where the processor has no such set, or `wide` was not compiled.
pub fn gram_rows(set: &str, stride: usize, rows: &[f64], out: &mut [f64]) {
    let work = GramRows { stride, rows, out };
    match set {
        #[cfg(feature = "wide")]
        "avx512" => Simd::vectorize(pulp::x86::V4::try_new().expect("AVX-512"), work),
        "avx2" => Simd::vectorize(pulp::x86::V3::try_new().expect("AVX2"), work),
        "portable" => Simd::vectorize(pulp::Scalar::new(), work),
        other => panic!("{other} is not compiled"),
    }
}
