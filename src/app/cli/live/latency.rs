//! How long answers took: their quantiles, in memory that does not grow.
//!
//! ```text
//! bin = floor(100 log10(t / 1 us))      each 2.3 % wide, 1 us to 1000 s
//! ```

use std::time::Duration;

/// Bins of a factor of ten.
const BINS_A_DECADE: f64 = 100.0;

/// Factors of ten from the shortest time to the longest.
const DECADES: usize = 9;

/// Shortest time that is told from others, seconds.
const SHORTEST: f64 = 1e-6;

/// Times by their logarithm.
#[derive(Debug)]
pub(super) struct LatencyHistogram {
    bins: Vec<u64>,
    count: u64,
    sum: f64,
}

impl LatencyHistogram {
    /// Of no answers.
    pub(super) fn new() -> LatencyHistogram {
        LatencyHistogram { bins: vec![0; DECADES * BINS_A_DECADE as usize], count: 0, sum: 0.0 }
    }

    /// One answer more.
    pub(super) fn add(&mut self, took: Duration) {
        let seconds = took.as_secs_f64();
        let bin = (BINS_A_DECADE * (seconds / SHORTEST).max(1.0).log10()) as usize;
        let last = self.bins.len() - 1;
        self.bins[bin.min(last)] += 1;
        self.count += 1;
        self.sum += seconds;
    }

    /// Number of answers.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Answers in a second of work.
    pub(super) fn rate(&self) -> f64 {
        if self.sum > 0.0 { self.count as f64 / self.sum } else { 0.0 }
    }

    /// The time in milliseconds that a share of the answers took at most; 0 without answers.
    pub(super) fn quantile_ms(&self, share: f64) -> f64 {
        let wanted = (share * self.count as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        let bin = self.bins.iter().position(|n| {
            seen += n;
            seen >= wanted
        });
        bin.map_or(0.0, |bin| 1e3 * SHORTEST * 10.0_f64.powf((bin as f64 + 1.0) / BINS_A_DECADE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_times() {
        let mut times = LatencyHistogram::new();
        assert_eq!((times.quantile_ms(0.5), times.rate()), (0.0, 0.0));
        (1..=100).for_each(|ms| times.add(Duration::from_millis(ms)));
        for share in [0.5, 0.99] {
            let found = times.quantile_ms(share);
            assert!((found / (100.0 * share) - 1.0).abs() < 0.03, "{share}: {found}");
        }
        assert_eq!(times.count(), 100);
        assert!((times.rate() - 100.0 / 5.05).abs() < 1e-9);
        times.add(Duration::from_secs(1_000_000));
        assert!(times.quantile_ms(1.0) >= 1e6);
    }
}
