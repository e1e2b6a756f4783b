//! Counts in fixed bins where there are too many replicates to keep: flat memory, and merging that is exact.
//!
//! ```text
//! y = (v - centre)/spread      bin(y) by sign, exponent and the upper 15 bits of the fraction; |y| < 1: steps of 2^-15
//! ```
//!
//! Centre and spread are those of the pilot, the first replicates of the scene and seed, so that every part of a study has
//! the same bins. A value is known to 2^-15 of the spread, or of its distance from the centre where that is larger.

/// Bits of a bin within its octave.
const BITS: u32 = 15;
/// Octaves beyond one spread: values further than 65,536 spreads away are counted at the end.
const OCTAVES: usize = 16;
/// Bins on either side of the centre.
const SIDE: usize = (OCTAVES + 1) << BITS;

/// Where the bins stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bins {
    /// The pilot's median.
    pub centre: f64,
    /// Half the pilot's interquartile range over 0.6745; a power of two.
    pub spread: f64,
}

impl Bins {
    /// From the pilot's values, ascending. A pilot that does not vary gets bins of its own rounding.
    pub fn of(sorted: &[f64]) -> Bins {
        let at = |share: f64| sorted.get((share * (sorted.len() as f64 - 1.0)) as usize).copied().unwrap_or(0.0);
        let centre = at(0.5);
        let spread = 0.5 * (at(0.75) - at(0.25)) / 0.674_5;
        let least = (centre.abs() * f64::EPSILON).max(f64::MIN_POSITIVE * 2.0_f64.powi(60));
        Bins { centre, spread: spread.max(least).log2().round().exp2() }
    }

    /// Number of bins.
    pub const COUNT: usize = 2 * SIDE;

    /// The bin of a value.
    #[inline]
    pub fn bin(&self, value: f64) -> usize {
        let y = (value - self.centre) / self.spread;
        let size = y.abs();
        // 1 + |y| in [1, 2) has a step of 2^-15 in its upper bits; above, |y| itself has the exponent
        let above = if size < 1.0 { 1.0 + size } else { 2.0 * size };
        let k = ((above.to_bits() >> (52 - BITS)) as usize).wrapping_sub(1023 << BITS).min(SIDE - 1);
        if y < 0.0 { SIDE - 1 - k } else { SIDE + k }
    }

    /// Ends of a bin, the lower and the upper one.
    pub fn ends(&self, bin: usize) -> [f64; 2] {
        let edge = |k: usize| {
            let y = f64::from_bits(((k + (1023 << BITS)) as u64) << (52 - BITS));
            let size = if k < 1 << BITS { y - 1.0 } else { 0.5 * y };
            size * self.spread
        };
        if bin >= SIDE {
            [self.centre + edge(bin - SIDE), self.centre + edge(bin - SIDE + 1)]
        } else {
            let k = SIDE - 1 - bin;
            [self.centre - edge(k + 1), self.centre - edge(k)]
        }
    }
}

/// Counts over the bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Where the bins stand.
    pub bins: Bins,
    counts: Vec<u64>,
}

impl Histogram {
    /// No counts yet.
    pub fn new(bins: Bins) -> Histogram {
        Histogram { bins, counts: vec![0; Bins::COUNT] }
    }

    /// Counts a value.
    #[inline]
    pub fn add(&mut self, value: f64) {
        self.counts[self.bins.bin(value)] += 1;
    }

    /// Adds the counts of the same bins; `false`, and nothing is done, for others.
    #[must_use]
    pub fn merge(&mut self, other: &Histogram) -> bool {
        let same = self.bins == other.bins;
        if same {
            self.counts.iter_mut().zip(&other.counts).for_each(|(own, more)| *own += more);
        }
        same
    }

    /// Bins with counts, ascending.
    pub fn filled(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        self.counts.iter().copied().enumerate().filter(|(_, count)| *count > 0)
    }

    /// Counts `more` values into one bin; `false` where there is no such bin.
    #[must_use]
    pub fn put(&mut self, bin: usize, more: u64) -> bool {
        let home = self.counts.get_mut(bin);
        home.map(|count| *count += more).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_lies_in_its_bin_and_bins_are_narrow() {
        for (centre, spread) in [(0.0, 1.0), (0.5, 2.0_f64.powi(-20)), (-3.0, 2.0_f64.powi(12))] {
            let bins = Bins { centre, spread };
            for k in -4000..4000 {
                let y = (f64::from(k) * 0.003).sinh() * 0.37;
                let value = centre + spread * y;
                let [lo, hi] = bins.ends(bins.bin(value));
                let rounding = 4.0 * f64::EPSILON * (centre.abs() + value.abs());
                assert!(lo - rounding <= value && value <= hi + rounding, "{value} in [{lo}, {hi}]");
                assert!(hi - lo <= spread * y.abs().max(1.0) * 2.0_f64.powi(-15) * 1.001 + rounding);
            }
            assert_eq!(bins.bin(f64::MAX), Bins::COUNT - 1);
            assert_eq!(bins.bin(f64::MIN), 0);
        }
        let ends: Vec<_> = (SIDE - 3..SIDE + 3).map(|b| Bins { centre: 0.0, spread: 1.0 }.ends(b)).collect();
        assert!(ends.windows(2).all(|w| w[0][1] == w[1][0]), "{ends:?}");
    }
}
