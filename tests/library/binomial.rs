//! Tests of coverage that say what passing them is worth.
//!
//! ```text
//! held ~ B(n, c)         passes where held >= least, the largest count with P(B(n, promised) >= least) >= 0.99        size
//! c = wrong:             P(B(n, wrong) < least) >= 0.95, or n is too small and the test fails for that                power
//! q = mean of ((mean - truth) / u)^2         chi2_.005(n) / (n high^2) <= q <= chi2_.995(n) / (n low^2)
//! ```
//!
//! A program that keeps its promise passes 99 times in 100, and one that is as wrong as stated fails 19 times in 20. Seeds are fixed,
//! so that what has passed passes again. Intervals that are too wide hold the truth too, which is why q has bounds on both sides:
//! u is `low` to `high` times as large as the errors, and a u of half `low` or of twice `high` fails.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// What the intervals promise.
const PROMISED: f64 = 0.95;

/// How often what keeps its promise passes.
const SIZE: f64 = 0.99;

/// How often what is as wrong as stated fails.
const POWER: f64 = 0.95;

/// P(fewer than `least` of `count`), where each is right with this probability.
fn fewer(least: u64, count: u64, share: f64) -> f64 {
    if least == 0 { 0.0 } else { Binomial::new(share, count).unwrap().cdf(least - 1) }
}

/// The largest count that what keeps its promise reaches nearly always.
fn least(count: u64, promised: f64) -> u64 {
    (0..=count).rev().find(|&least| 1.0 - fewer(least, count, promised) >= SIZE).unwrap_or(0)
}

/// Fails where fewer of `count` are right than a share of `promised` would give once in a hundred; `count` must be large enough to
/// tell it from a share of `wrong`.
#[track_caller]
pub(crate) fn assert_share(right: u64, count: u64, [promised, wrong]: [f64; 2], what: &str) {
    let least = least(count, promised);
    let power = fewer(least, count, wrong);
    assert!(power >= POWER, "{what}: {count} do not tell {promised} from {wrong}: {power:.3}");
    assert!(right >= least, "{what}: {right} of {count}, and {promised} would give {least} or more");
    println!("{what}: {right} of {count}, at least {least}; a share of {wrong} fails with probability {power:.3}");
}

/// How often intervals hold the truth, and how large errors are beside their u.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    count: u64,
    held: u64,
    measured: u64,
    squares: f64,
}

impl Coverage {
    /// One answer beside the truth.
    pub(crate) fn answer(&mut self, [mean, u]: [f64; 2], interval: [f64; 2], truth: f64) {
        self.count += 1;
        self.measured += 1;
        self.held += u64::from(interval[0] <= truth && truth <= interval[1]);
        self.squares += ((mean - truth) / u).powi(2);
    }

    /// A question without an answer, whose interval holds nothing.
    pub(crate) fn refusal(&mut self) {
        self.count += 1;
    }

    /// The intervals hold the truth as often as they promise, and not as seldom as `wrong`; u is this many times the errors.
    #[track_caller]
    pub(crate) fn assert(&self, wrong: f64, [low, high]: [f64; 2], what: &str) {
        assert_share(self.held, self.count, [PROMISED, wrong], what);
        let (count, law) = (self.measured as f64, ChiSquared::new(self.measured as f64).unwrap());
        let [least, most] = [0.5 * (1.0 - SIZE), 0.5 * (1.0 + SIZE)].map(|p| law.inverse_cdf(p));
        let power = law.cdf(4.0 * least).min(1.0 - law.cdf(0.25 * most));
        assert!(power >= POWER, "{what}: {count} do not tell u from half or twice that: {power:.3}");
        let (square, bounds) = (self.squares / count, [least / (count * high * high), most / (count * low * low)]);
        println!("{what}: errors over u have a mean square of {square:.3}, within {bounds:.3?}");
        assert!((bounds[0]..=bounds[1]).contains(&square), "{what}: mean square {square:.3} of errors over u");
    }
}

#[test]
fn size_and_power_are_those_of_the_binomial_law() {
    // P(B(2, 0.5) < 2) = 3/4
    assert!((fewer(2, 2, 0.5) - 0.75).abs() < 1e-12 && fewer(0, 2, 0.5) == 0.0);
    // 69 is the least count that tells 95 % from 80 %, 33 from 70 %
    for (count, wrong) in [(69, 0.8), (33, 0.7)] {
        let power = |count| fewer(least(count, PROMISED), count, wrong);
        assert!(power(count) >= POWER && power(count - 1) < POWER, "{count}");
    }
}

#[test]
fn wrong_coverage_and_wrong_u_are_caught() {
    // errors at the quantiles of the normal law, with a u that is `f` times their size
    let fails = |f: f64, held: usize| {
        let mut coverage = Coverage::default();
        for k in 0..69 {
            let z = statrs::distribution::Normal::standard().inverse_cdf((k as f64 + 0.5) / 69.0);
            coverage.answer([z, f], if k < held { [-9.0, 9.0] } else { [8.0, 9.0] }, 0.0);
        }
        std::panic::catch_unwind(|| coverage.assert(0.8, [1.0, 1.0], "a trial")).is_err()
    };
    assert!(!fails(1.0, 66) && fails(1.0, 60));
    assert!(fails(2.0, 66) && fails(0.5, 66));
}
