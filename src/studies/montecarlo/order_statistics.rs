//! Order statistics, coverage intervals and how far off their ends are.
//!
//! ```text
//! q = p M rounded;   [y_(r), y_(r+q)],  r = (M - q)/2 rounded: probabilistically symmetric
//!                                       r of least y_(r+q) - y_(r): shortest                    JCGM 101:2008, 7.7
//! rank of a quantile a is binomial: sd k = sqrt(M a (1 - a));   standard error = (y_(r+k) - y_(r-k))/2
//! ```

use super::histogram::Histogram;
use palpate_geometry::shape::Interval;

/// Values by rank, from 1.
#[derive(Clone, Debug)]
pub enum Ranked<'a> {
    /// All of them.
    Sorted(Sorted),
    /// Counts.
    Counted(Counted<'a>),
}

/// Values in ascending order.
#[derive(Clone, Debug)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Of ascending values.
    pub fn new(ascending: Vec<f64>) -> Sorted {
        Sorted(ascending)
    }
}

/// Counts in bins with what lies below each.
#[derive(Clone, Debug)]
pub struct Counted<'a> {
    histogram: &'a Histogram,
    /// Filled bins: number, values below it, values in it.
    filled: Vec<(usize, u64, u64)>,
    ends: [f64; 2],
    total: u64,
}

impl Counted<'_> {
    /// Of these counts, whose values lie in `ends`.
    pub fn new(histogram: &Histogram, ends: [f64; 2]) -> Counted<'_> {
        let mut total = 0;
        let mut filled = Vec::new();
        for (bin, count) in histogram.filled() {
            filled.push((bin, total, count));
            total += count;
        }
        Counted { histogram, filled, ends, total }
    }

    fn in_bin(&self, (bin, below, count): (usize, u64, u64), rank: f64) -> f64 {
        let [lo, hi] = self.histogram.bins.ends(bin);
        // values of a bin are taken to lie evenly in it
        let share = ((rank - below as f64 - 0.5) / count as f64).clamp(0.0, 1.0);
        (lo + share * (hi - lo)).clamp(self.ends[0], self.ends[1])
    }

    fn at(&self, rank: f64) -> f64 {
        let k = self.filled.partition_point(|(_, below, count)| ((below + count) as f64) < rank);
        self.filled.get(k.min(self.filled.len().saturating_sub(1))).map_or(f64::NAN, |bin| self.in_bin(*bin, rank))
    }
}

/// An interval with the standard errors of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// The interval.
    pub interval: Interval,
    /// Standard errors of its lower and upper end, from the spread of their ranks.
    pub standard_error: [f64; 2],
}

impl Ranked<'_> {
    /// Number of values.
    pub fn len(&self) -> u64 {
        match self {
            Ranked::Sorted(sorted) => sorted.0.len() as u64,
            Ranked::Counted(counted) => counted.total,
        }
    }

    /// No values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of this rank, 1 to the number of values; ranks beyond are the ends'.
    pub fn at(&self, rank: f64) -> f64 {
        let rank = rank.clamp(1.0, self.len().max(1) as f64);
        match self {
            Ranked::Sorted(sorted) => {
                let below = rank.floor();
                let (a, b) =
                    (sorted.0[below as usize - 1], sorted.0[(rank.ceil() as usize - 1).min(sorted.0.len() - 1)]);
                a + (rank - below) * (b - a)
            }
            Ranked::Counted(counted) => counted.at(rank),
        }
    }

    /// The quantile of a share in (0, 1), the value of rank `share M + 1/2`; `None` without values.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        (!self.is_empty()).then(|| self.at(share * self.len() as f64 + 0.5))
    }

    /// Standard error of the value at `rank`.
    pub(super) fn standard_error(&self, rank: f64) -> f64 {
        let m = self.len() as f64;
        let share = ((rank - 0.5) / m).clamp(0.5 / m, 1.0 - 0.5 / m);
        let k = (m * share * (1.0 - share)).sqrt();
        0.5 * (self.at(rank + k) - self.at(rank - k))
    }

    /// The probabilistically symmetric interval; `None` with fewer than two values.
    pub fn symmetric(&self, level: f64) -> Option<Coverage> {
        let m = self.len();
        if m < 2 {
            return None;
        }
        Some(self.corrected(level, [0.0; 2], [0.0; 2]))
    }

    /// The symmetric interval, its ranks moved by `ranks` and its standard errors shrunk by `sqrt(1 - beta^2)`; two values or more.
    pub fn corrected(&self, level: f64, ranks: [f64; 2], beta: [f64; 2]) -> Coverage {
        let [r, top] = symmetric_ranks(level, self.len());
        // the spread is that of the plain ranks: over the few that a good control leaves it would be known badly
        self.coverage([r + ranks[0], top + ranks[1]], beta.map(|beta| (1.0 - beta * beta).max(0.0).sqrt()))
    }

    /// The shortest interval; the first of several. Its ends' standard errors are those of order statistics at its ranks:
    /// that the ranks themselves were chosen adds to them where the density hardly falls off at the ends.
    pub fn shortest(&self, level: f64) -> Option<Coverage> {
        let m = self.len();
        if m < 2 {
            return None;
        }
        let q = covered(level, m);
        let mut best = (f64::INFINITY, 1.0);
        match self {
            Ranked::Sorted(Sorted(values)) => {
                for r in 0..(m - q) as usize {
                    let length = values[r + q as usize] - values[r];
                    if length < best.0 {
                        best = (length, r as f64 + 1.0);
                    }
                }
            }
            Ranked::Counted(counted) => {
                for (_, below, _) in counted.filled.iter().filter(|(_, below, _)| *below + 1 + q <= m) {
                    let r = *below as f64 + 1.0;
                    let length = counted.at(r + q as f64) - counted.at(r);
                    if length < best.0 {
                        best = (length, r);
                    }
                }
            }
        }
        Some(self.coverage([best.1, best.1 + q as f64], [1.0; 2]))
    }

    fn coverage(&self, [r, top]: [f64; 2], by: [f64; 2]) -> Coverage {
        Coverage {
            interval: Interval { lo: self.at(r), hi: self.at(top) },
            standard_error: [by[0] * self.standard_error(r), by[1] * self.standard_error(top)],
        }
    }
}

/// Ranks r and r + q of the probabilistically symmetric interval of two values or more: JCGM 101, 7.7.2.
pub(super) fn symmetric_ranks(level: f64, m: u64) -> [f64; 2] {
    let q = covered(level, m);
    let r = ((m - q) as f64 / 2.0 + 0.5).floor().max(1.0);
    [r, r + q as f64]
}

/// q of JCGM 101, 7.7.2, at most M - 1.
fn covered(level: f64, m: u64) -> u64 {
    ((level * m as f64 + 0.5).floor() as u64).clamp(1, m - 1)
}

#[cfg(test)]
mod tests {
    use super::super::histogram::Bins;
    use super::*;

    #[test]
    fn ranks_are_those_of_the_guide() {
        let sorted = Ranked::Sorted(Sorted::new((1..=1000).map(f64::from).collect()));
        let found = sorted.symmetric(0.95).unwrap().interval;
        assert_eq!((found.lo, found.hi), (25.0, 975.0));
        assert_eq!(sorted.quantile(0.5), Some(500.5));
        let skew = Ranked::Sorted(Sorted::new((1..=1000).map(|k| f64::from(k * k)).collect()));
        assert_eq!(skew.shortest(0.95).unwrap().interval.lo, 1.0);
        let se = sorted.symmetric(0.95).unwrap().standard_error[0];
        assert!((se - (1000.0_f64 * 0.0245 * 0.9755).sqrt()).abs() < 0.1, "{se}");
    }

    #[test]
    fn counts_agree_with_values_to_the_width_of_a_bin() {
        let mut values: Vec<f64> =
            (0..100_000).map(|k| (((f64::from(k) + 0.5) * 0.618_033_988_7).fract() - 0.5).powi(3)).collect();
        let mut histogram = Histogram::new(Bins { centre: 0.0, spread: 0.03125 });
        values.iter().for_each(|v| histogram.add(*v));
        values.sort_unstable_by(f64::total_cmp);
        let ends = [values[0], values[99_999]];
        let (exact, counted) = (Ranked::Sorted(Sorted::new(values)), Ranked::Counted(Counted::new(&histogram, ends)));
        let near = |a: Coverage, b: Coverage| {
            (a.interval.lo - b.interval.lo).abs() < 2e-5 && (a.interval.hi - b.interval.hi).abs() < 2e-5
        };
        assert!(near(exact.symmetric(0.95).unwrap(), counted.symmetric(0.95).unwrap()));
        let (a, b) = (exact.shortest(0.9).unwrap().interval, counted.shortest(0.9).unwrap().interval);
        assert!((a.hi - a.lo - (b.hi - b.lo)).abs() < 2e-5);
    }
}
