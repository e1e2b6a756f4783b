//! When a study has the digits asked for.
//!
//! ```text
//! u = c 10^l, c of n digits;   delta = 10^l / 2                                   JCGM 101:2008, 7.9.2
//! adaptive   after h batches of M: 2 s/sqrt(h) <= delta for mean, u, lower, upper end                7.9.4
//! Stein      s of 10 batches; h = max(10, floor(s^2 t^2/delta^2) + 1), t = t(9; 0.975); the largest h of all
//! ```
//!
//! Each of S and R has its own delta; both rules wait for the last of them.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::options::Tolerance;
use super::order_statistics::{Ranked, Sorted};

/// Mean, sd, lower and upper end of S and of R over one batch of the stopping rule.
pub type BatchEstimate = [[f64; 4]; 2];

/// Batches of the first stage.
const FIRST: u64 = 10;

/// Least replicates of a batch with a control: ten batches are the least that a study can do, and with a control ten of the
/// Guide's would be more than two digits take.
const CONTROLLED: f64 = 4096.0;

/// Replicates of a batch: JCGM 101, 7.9.4 b, raised to a multiple of 1024. With the linear law as a control the Guide's
/// 10,000 become `CONTROLLED`.
pub fn batch_size(level: f64, controlled: bool) -> u64 {
    let least = (100.0 / (1.0 - level)).ceil().max(if controlled { CONTROLLED } else { 10_000.0 });
    (least as u64).next_multiple_of(1024)
}

/// `delta` for a standard uncertainty; `None` where that is zero.
pub fn numerical_tolerance(u: f64, digits: u32) -> Option<f64> {
    if !(u > 0.0 && u.is_finite()) {
        return None;
    }
    let digits = digits as i32;
    let mut exponent = u.log10().floor() as i32 - (digits - 1);
    // 0.0996 to two digits is 0.10: one more digit before the point
    if (u / 10.0_f64.powi(exponent)).round() >= 10.0_f64.powi(digits) {
        exponent += 1;
    }
    Some(0.5 * 10.0_f64.powi(exponent))
}

/// Estimates of one batch from its values of S and R.
pub fn batch_estimate(columns: &[Vec<f64>], level: f64) -> BatchEstimate {
    let of = |column: Option<&Vec<f64>>| {
        let mut values: Vec<f64> = column.map_or(Vec::new(), |c| c.iter().copied().filter(|v| v.is_finite()).collect());
        let n = values.len() as f64;
        if values.len() < 2 {
            return [f64::NAN; 4];
        }
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        values.sort_unstable_by(f64::total_cmp);
        let ends = Ranked::Sorted(Sorted::new(values)).symmetric(level).map(|c| c.interval);
        [mean, (squares / (n - 1.0)).sqrt(), ends.map_or(f64::NAN, |i| i.lo), ends.map_or(f64::NAN, |i| i.hi)]
    };
    [of(columns.first()), of(columns.get(1))]
}

/// Batches that the rule wants in all, from those seen; at most what was seen: enough.
pub fn batches_wanted(tolerance: Tolerance, batches: &[BatchEstimate]) -> u64 {
    let seen = batches.len() as u64;
    let least = match tolerance {
        Tolerance::Stein(_) => FIRST,
        Tolerance::Adaptive(_) => 2,
    };
    if seen < least {
        return least;
    }
    let used = match tolerance {
        Tolerance::Stein(_) => &batches[..FIRST as usize],
        Tolerance::Adaptive(_) => batches,
    };
    let wanted = (0..2).map(|quantity| wanted_by(tolerance, used, quantity)).max().unwrap_or(seen);
    match tolerance {
        Tolerance::Stein(_) => wanted.max(FIRST),
        // one more batch, and another look
        Tolerance::Adaptive(_) if wanted > seen => seen + 1,
        Tolerance::Adaptive(_) => seen,
    }
}

fn wanted_by(tolerance: Tolerance, used: &[BatchEstimate], quantity: usize) -> u64 {
    let h = used.len() as f64;
    let column = |k: usize| used.iter().map(move |batch| batch[quantity][k]);
    let variance = |k: usize| {
        let mean = column(k).sum::<f64>() / h;
        column(k).map(|v| (v - mean) * (v - mean)).sum::<f64>() / (h - 1.0)
    };
    let Some(delta) = numerical_tolerance(column(1).sum::<f64>() / h, tolerance.digits()) else { return 0 };
    let factor = match tolerance {
        Tolerance::Stein(_) => StudentsT::new(0.0, 1.0, h - 1.0).map_or(4.0, |t| t.inverse_cdf(0.975).powi(2)),
        Tolerance::Adaptive(_) => 4.0,
    };
    // JCGM asks for all four, mean, u and both ends; an end is the least certain, and a NaN asks for nothing
    (0..4).map(|k| (variance(k) * factor / (delta * delta)).floor() as u64 + 1).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::EffectDraws;

    #[test]
    fn tolerances_are_those_of_the_guide() {
        // JCGM 101, 7.9.2: u = 0.35 mg to two digits: 35 x 10^-2, delta 0.005; 0.35 K to one digit: 4 x 10^-1, 0.05
        for (u, digits, delta) in [(0.35, 2, 0.005), (0.35, 1, 0.05), (0.0996, 2, 0.005), (32.0, 2, 0.5)] {
            let found = numerical_tolerance(u, digits).unwrap();
            assert!((found / delta - 1.0).abs() < 1e-12, "{u} {digits}: {found}");
        }
        assert_eq!(numerical_tolerance(0.0, 2), None);
        assert_eq!(batch_size(0.95, false), 10_240);
        assert_eq!(batch_size(0.9999, false), 1_000_448);
        assert_eq!(batch_size(0.95, true), 4096);
    }

    /// Both rules on a normal law whose endpoint is known: how often the stated error holds. Stein's must reach 95 %.
    #[test]
    fn the_two_stages_keep_their_promise() {
        const BATCH: usize = 512;
        let run = |tolerance: Tolerance, seed: u64| {
            let draws = EffectDraws::new(seed, "stopping");
            let mut batches: Vec<BatchEstimate> = Vec::new();
            let mut ends = Vec::new();
            loop {
                // u = 1.7, delta = 0.05
                let mut values = vec![0.0; BATCH];
                draws.gaussians(0, (batches.len() * BATCH) as u64, 1, &mut values);
                values.iter_mut().for_each(|v| *v *= 1.7);
                let estimate = batch_estimate(&[values.clone(), vec![0.0; BATCH]], 0.9);
                ends.push(estimate[0][3]);
                batches.push(estimate);
                if batches_wanted(tolerance, &batches) <= batches.len() as u64 {
                    break;
                }
            }
            let end = ends.iter().sum::<f64>() / ends.len() as f64;
            ((end - 1.7 * 1.644_853_6).abs() <= 0.05, batches.len())
        };
        let held = |tolerance| (0..200).filter(|seed| run(tolerance, *seed).0).count();
        let (stein, adaptive) = (held(Tolerance::Stein(2)), held(Tolerance::Adaptive(2)));
        assert!(stein >= 185, "Stein held in {stein} of 200");
        assert!(stein > adaptive, "adaptive held in {adaptive} of 200");
    }
}
