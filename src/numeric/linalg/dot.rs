//! Inner products of slices, each with its own fixed order of sums.

/// `a . b`, summed from the first product to the last, as far as both reach.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a . b` in `N` sums side by side, and that of the rest beyond the last multiple of `N`: one long sum has to wait for each
/// addition, because reordering it changes its rounding. The caller adds the sums up in its own order.
#[inline]
pub(crate) fn partial_dots<const N: usize>(a: &[f64], b: &[f64]) -> ([f64; N], f64) {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<N>(), b.as_chunks::<N>());
    let mut sums = [0.0; N];
    for (x, y) in a.iter().zip(b) {
        (0..N).for_each(|k| sums[k] += x[k] * y[k]);
    }
    (sums, dot(a_rest, b_rest))
}
