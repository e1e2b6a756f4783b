//! Order statistics by selection: medians and quantiles without sorting.
//!
//! ```text
//! x_(0) <= x_(1) <= ... <= x_(n-1)        median = x_(k), n = 2k + 1;  (x_(k-1) + x_(k))/2, n = 2k
//! ```
//!
//! `statrs::statistics::Data` interpolates between ranks (R. J. Hyndman and Y. Fan, *Am. Stat.* 50 (1996) 361, definition 8).
//! Quantiles here are values of the sample, so that a recorded answer is a number that was observed.

/// Which rank a share p of n values stands for. All are values of the sample and agree as n grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// `floor(p n)`, at most the last.
    Floor,
    /// `ceil(p n) - 1`: the smallest value that a share p of the values does not exceed.
    Reached,
    /// `floor(p (n - 1))`.
    FloorOfSteps,
    /// `round(p (n - 1))`.
    NearestStep,
}

impl Rank {
    /// The rank among `count` values, from 0; 0 where there is none.
    pub fn of(self, share: f64, count: usize) -> usize {
        let last = count.saturating_sub(1);
        let rank = match self {
            Rank::Floor => (share * count as f64) as usize,
            Rank::Reached => ((share * count as f64).ceil() as usize).saturating_sub(1),
            Rank::FloorOfSteps => (share * last as f64) as usize,
            Rank::NearestStep => (share * last as f64).round() as usize,
        };
        rank.min(last)
    }
}

/// Values of which the share below any one is known to a hundredth: its standard deviation is half of one over their root at most.
pub const ENOUGH_FOR_RANKS: usize = 8192;

/// `most` of the numbers below `count`, evenly among all; all of them where there are no more.
///
/// ```
/// use palpate_numeric::statistics::evenly_among;
///
/// assert_eq!(evenly_among(10, 4).collect::<Vec<usize>>(), [0, 2, 5, 7]);
/// assert_eq!(evenly_among(3, 4).collect::<Vec<usize>>(), [0, 1, 2]);
/// ```
pub fn evenly_among(count: usize, most: usize) -> impl ExactSizeIterator<Item = usize> + Clone {
    let taken = count.min(most);
    (0..taken).map(move |k| k * count / taken)
}

/// `x_(rank)`; `None` where there are not so many values. The values are reordered.
pub fn order_statistic(mut values: impl AsMut<[f64]>, rank: usize) -> Option<f64> {
    let values = values.as_mut();
    (rank < values.len()).then(|| *values.select_nth_unstable_by(rank, f64::total_cmp).1)
}

/// The value of the sample at a share of it; `None` of an empty list. The values are reordered.
pub fn quantile(mut values: impl AsMut<[f64]>, share: f64, rank: Rank) -> Option<f64> {
    let values = values.as_mut();
    let rank = rank.of(share, values.len());
    order_statistic(values, rank)
}

/// The median, the mean of the two middle values of an even number; `None` of an empty list. The values are reordered.
pub fn median(mut values: impl AsMut<[f64]>) -> Option<f64> {
    let values = values.as_mut();
    let n = values.len();
    if n == 0 {
        return None;
    }
    let (below, middle, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    let middle = *middle;
    let lower = || below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(if n % 2 == 1 { middle } else { 0.5 * (middle + lower()) })
}

/// The upper of the two middle values of an even number, else the median; `None` of an empty list. The values are reordered.
pub fn upper_median(mut values: impl AsMut<[f64]>) -> Option<f64> {
    let values = values.as_mut();
    let middle = values.len() / 2;
    order_statistic(values, middle)
}

/// The least value at which the weights of the values up to it reach a share of all, of `[value, weight]` in ascending order;
/// `None` of an empty list.
pub fn weighted_quantile(ordered: &[(f64, f64)], share: f64) -> Option<f64> {
    let sum: f64 = ordered.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let reached = ordered.iter().find(|(_, weight)| {
        below += weight;
        below >= share * sum
    });
    reached.or(ordered.last()).map(|(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_lie_in_the_middle() {
        assert_eq!((median([3.0, 1.0, 2.0]), median([4.0, 1.0, 2.0, 3.0])), (Some(2.0), Some(2.5)));
        assert_eq!((upper_median([3.0, 1.0, 2.0]), upper_median([4.0, 1.0, 2.0, 3.0])), (Some(2.0), Some(3.0)));
        assert_eq!((median(Vec::new()), upper_median(Vec::new())), (None, None));
    }

    #[test]
    fn every_rank_is_a_value_of_the_sample() {
        let all: Vec<f64> = (1..=10).rev().map(f64::from).collect();
        let at = |share, rank| quantile(all.clone(), share, rank).unwrap();
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|p| at(p, Rank::Floor)), [1.0, 3.0, 6.0, 10.0]);
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|p| at(p, Rank::Reached)), [1.0, 3.0, 5.0, 10.0]);
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|p| at(p, Rank::FloorOfSteps)), [1.0, 3.0, 5.0, 10.0]);
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|p| at(p, Rank::NearestStep)), [1.0, 3.0, 6.0, 10.0]);
        assert_eq!((quantile(Vec::new(), 0.5, Rank::Reached), order_statistic([1.0], 1)), (None, None));
    }

    #[test]
    fn weights_count_like_repetitions() {
        let ordered = [(1.0, 1.0), (2.0, 2.0), (5.0, 1.0)];
        assert_eq!(
            [0.25, 0.3, 0.75, 0.8, 1.0].map(|p| weighted_quantile(&ordered, p).unwrap()),
            [1.0, 2.0, 2.0, 5.0, 5.0]
        );
        assert_eq!(weighted_quantile(&[], 0.5), None);
    }
}
