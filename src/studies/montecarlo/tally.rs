//! All that is kept of one quantity over the replicates: exact sums, and its values or their counts.
//!
//! ```text
//! mean = c + sum (v - c)/n        sd^2 = (sum (v - c)^2 - (sum (v - c))^2/n)/(n - 1)        c: the noise-free value
//! ```
//!
//! The sums are exact and the counts are whole numbers, so the same replicates give the same bits in any order and any
//! split. Differences from c leave nothing to cancel where the noise is a billionth of the value.

use super::exact_sum::ExactSum;
use super::histogram::{Bins, Histogram};
use super::options::{KEPT, PILOT};
use super::order_statistics::{Counted, Ranked, Sorted};

/// How the values are kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Store {
    /// Every value.
    Values(Vec<f64>),
    /// Counts in fixed bins.
    Counts(Box<Histogram>),
}

/// One quantity over the replicates seen so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// c, the noise-free value; 0 where that is undefined.
    pub reference: f64,
    /// Replicates in which the quantity is defined.
    pub count: u64,
    /// Replicates in which it is not.
    pub undefined: u64,
    /// `sum (v - c)`.
    pub sum: ExactSum,
    /// `sum (v - c)^2`.
    pub squares: ExactSum,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
    /// The values.
    pub store: Store,
}

/// Why two tallies cannot be joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherBins;

impl Tally {
    /// Nothing seen yet; counts where `bins` are given, values otherwise.
    pub fn new(reference: f64, bins: Option<Bins>) -> Tally {
        let store = match bins {
            Some(bins) => Store::Counts(Box::new(Histogram::new(bins))),
            None => Store::Values(Vec::new()),
        };
        let reference = if reference.is_finite() { reference } else { 0.0 };
        Tally {
            reference,
            count: 0,
            undefined: 0,
            sum: ExactSum::default(),
            squares: ExactSum::default(),
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            store,
        }
    }

    /// Takes values in; NaN stands for undefined.
    pub fn extend(&mut self, values: &[f64]) {
        for &value in values {
            if !value.is_finite() {
                self.undefined += 1;
                continue;
            }
            self.count += 1;
            let off = value - self.reference;
            self.sum.add(off);
            self.squares.add(off * off);
            self.least = self.least.min(value);
            self.most = self.most.max(value);
            match &mut self.store {
                // minus zero would sort before zero and make the bits depend on the sort
                Store::Values(kept) => kept.push(value + 0.0),
                Store::Counts(histogram) => histogram.add(value),
            }
        }
    }

    /// Counts the values from now on where so many more are too many to keep; the bins stand where a pilot puts them.
    pub fn make_room(&mut self, more: u64) {
        let Store::Values(values) = &self.store else { return };
        if values.len() as u64 + more <= KEPT {
            return;
        }
        let mut pilot = values[..PILOT.min(values.len())].to_vec();
        pilot.sort_unstable_by(f64::total_cmp);
        let mut histogram = Histogram::new(Bins::of(&pilot));
        values.iter().for_each(|value| histogram.add(*value));
        self.store = Store::Counts(Box::new(histogram));
    }

    /// Joins the same quantity of other replicates.
    ///
    /// # Errors
    /// When one holds values and the other counts, or counts in other bins.
    pub fn merge(&mut self, other: &Tally) -> Result<(), OtherBins> {
        match (&mut self.store, &other.store) {
            (Store::Values(own), Store::Values(more)) => own.extend_from_slice(more),
            (Store::Counts(own), Store::Counts(more)) => {
                if !own.merge(more) {
                    return Err(OtherBins);
                }
            }
            _ => return Err(OtherBins),
        }
        self.count += other.count;
        self.undefined += other.undefined;
        self.sum.merge(&other.sum);
        self.squares.merge(&other.squares);
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
        Ok(())
    }

    /// Mean; `None` without values.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.reference + self.sum.value() / self.count as f64)
    }

    /// Sample sd; `None` with fewer than two values.
    pub fn sd(&self) -> Option<f64> {
        (self.count > 1).then(|| {
            let (n, sum) = (self.count as f64, self.sum.value());
            ((self.squares.value() - sum * sum / n).max(0.0) / (n - 1.0)).sqrt()
        })
    }

    /// The values in order, by rank.
    pub fn ranked(&self) -> Ranked<'_> {
        match &self.store {
            Store::Values(values) => {
                let mut sorted = values.clone();
                sorted.sort_unstable_by(f64::total_cmp);
                Ranked::Sorted(Sorted::new(sorted))
            }
            Store::Counts(histogram) => Ranked::Counted(Counted::new(histogram, [self.least, self.most])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(n: usize) -> Vec<f64> {
        (0..n).map(|k| if k % 97 == 5 { f64::NAN } else { 0.5 + 1e-9 * (k as f64 * 1.7).sin() }).collect()
    }

    #[test]
    fn any_split_in_any_order_gives_the_same_bits() {
        let all = values(5000);
        for bins in [None, Some(Bins { centre: 0.5, spread: 2.0_f64.powi(-30) })] {
            let of = |parts: &[&[f64]]| {
                let mut whole = Tally::new(0.5, bins);
                for part in parts {
                    let mut own = Tally::new(0.5, bins);
                    own.extend(part);
                    whole.merge(&own).unwrap();
                }
                whole
            };
            let (a, b) = (of(&[&all]), of(&[&all[3000..], &all[..17], &all[17..3000]]));
            assert_eq!(a.mean(), b.mean());
            assert_eq!(a.sd(), b.sd());
            assert_eq!((a.count, a.undefined), (b.count, b.undefined));
            for share in [0.025, 0.5, 0.975] {
                assert_eq!(a.ranked().quantile(share), b.ranked().quantile(share));
            }
        }
        assert_eq!(Tally::new(0.0, None).merge(&Tally::new(0.0, Some(Bins::of(&[1.0, 2.0])))), Err(OtherBins));
    }

    #[test]
    fn a_small_sd_keeps_its_digits() {
        let mut tally = Tally::new(0.5, None);
        tally.extend(&values(9700));
        let kept: Vec<f64> = values(9700).into_iter().filter(|v| v.is_finite()).collect();
        let mean = kept.iter().map(|v| v - 0.5).sum::<f64>() / kept.len() as f64;
        let squares: f64 = kept.iter().map(|v| (v - 0.5 - mean).powi(2)).sum();
        let expected = (squares / (kept.len() - 1) as f64).sqrt();
        assert!((tally.sd().unwrap() / expected - 1.0).abs() < 1e-12);
    }
}
