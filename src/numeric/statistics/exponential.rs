//! The exponential correlation of errors along a way, that of the process of Ornstein and Uhlenbeck.
//!
//! ```text
//! c(r) = exp(-r/l) = rho^(r/h)         l the length, rho the correlation over a step h
//! ```
//!
//! Errors with it are Markovian along a line: each depends on the past by its neighbour alone. G. E. Uhlenbeck and
//! L. S. Ornstein, *Phys. Rev.* 36 (1930) 823.

/// By what the correlation is given; both are kept, because a power and an exponential differ in their last bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExponentialCorrelation {
    /// The length over which it falls to 1/e.
    Length(f64),
    /// The correlation over a distance of 1; 0 where neighbours share nothing.
    Step(f64),
}

impl ExponentialCorrelation {
    /// Correlation over a distance.
    #[inline]
    pub fn at(self, distance: f64) -> f64 {
        match self {
            ExponentialCorrelation::Length(length) => (-distance / length).exp(),
            ExponentialCorrelation::Step(0.0) => 0.0,
            ExponentialCorrelation::Step(rho) => rho.powf(distance),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_to_give_it_agree() {
        let (length, step) = (ExponentialCorrelation::Length(2.0), ExponentialCorrelation::Step((-0.5_f64).exp()));
        for distance in [0.0, 0.3, 1.0, 7.0] {
            assert!((length.at(distance) - step.at(distance)).abs() < 1e-15);
        }
        assert_eq!(ExponentialCorrelation::Step(0.0).at(0.0), 0.0);
    }
}
