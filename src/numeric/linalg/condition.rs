//! Hager and Higham's estimate of `|B^-1|_1` from a few solves with `B` and `B'`.
//!
//! N. J. Higham, *FORTRAN codes for estimating the one-norm*, ACM TOMS 14 (1988), Algorithm 2.1. It is a lower
//! bound, nearly always within a factor of 3.

/// At most this many refinements; the estimate settles after 2 or 3.
const MAX_STEPS: usize = 5;

/// Lower bound of `|B^-1|_1` for `B` of the given order, from `solve` (`v <- B^-1 v`) and `solve_transposed`.
pub fn inverse_norm1_estimate(
    order: usize,
    mut solve: impl FnMut(&mut [f64]),
    mut solve_transposed: impl FnMut(&mut [f64]),
) -> f64 {
    if order == 0 {
        return 0.0;
    }
    let mut v = vec![1.0 / order as f64; order];
    solve(&mut v);
    let mut estimate: f64 = v.iter().map(|w| w.abs()).sum();
    let mut signs: Vec<f64> = v.iter().map(|w| 1.0_f64.copysign(*w)).collect();
    for step in 0..MAX_STEPS {
        let mut x = signs.clone();
        solve_transposed(&mut x);
        let (mut best, mut largest) = (0, -1.0);
        for (j, w) in x.iter().enumerate() {
            if w.abs() > largest {
                (best, largest) = (j, w.abs());
            }
        }
        let inner: f64 = x.iter().sum::<f64>() / order as f64;
        if step > 0 && largest <= inner.abs() {
            break;
        }
        v.fill(0.0);
        v[best] = 1.0;
        solve(&mut v);
        let grown: f64 = v.iter().map(|w| w.abs()).sum();
        let new_signs: Vec<f64> = v.iter().map(|w| 1.0_f64.copysign(*w)).collect();
        if grown <= estimate || new_signs == signs {
            estimate = estimate.max(grown);
            break;
        }
        (estimate, signs) = (grown, new_signs);
    }
    // Higham's safeguard: an alternating vector finds matrices in which the steps above cancel
    for (i, w) in v.iter_mut().enumerate() {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        *w = sign * (1.0 + i as f64 / (order.max(2) - 1) as f64);
    }
    solve(&mut v);
    let safeguard = 2.0 * v.iter().map(|w| w.abs()).sum::<f64>() / (3.0 * order as f64);
    estimate.max(safeguard)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_and_triangular_matrices() {
        let d = [1.0, 2.0, 1e-6, 4.0];
        let solve = |v: &mut [f64]| v.iter_mut().zip(d).for_each(|(w, d)| *w /= d);
        let estimate = inverse_norm1_estimate(4, solve, solve);
        assert!((estimate - 1e6).abs() < 1e-3);
        // [1 10; 0 1]^-1 = [1 -10; 0 1]
        let estimate = inverse_norm1_estimate(2, |v| v[0] -= 10.0 * v[1], |v: &mut [f64]| v[1] -= 10.0 * v[0]);
        assert!((estimate - 11.0).abs() < 1e-12);
    }
}
