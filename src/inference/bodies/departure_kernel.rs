//! How alike the values of a departure are at two places.
//!
//! ```text
//! gaussian   k(r) = exp(-r^2 / 2 l^2)                        bends as evenly as it can
//! Matern     k(r) = (1 + a + a^2 / 3) exp(-a),  a = sqrt(3) r / l      Matern's of order 5/2: curvature changes from place to place
//! slopes     of both have the variance 1 / l^2
//! ```
//!
//! C. Rasmussen and C. Williams, *Gaussian Processes for Machine Learning*, section 4.2.

/// How evenly a departure bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KernelFamily {
    Gaussian,
    Matern,
}

/// A family and a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DepartureKernel {
    pub(super) family: KernelFamily,
    pub(super) length: f64,
    /// Lengths by which the places that carry the departure are apart.
    pub(super) apart: f64,
}

impl DepartureKernel {
    pub(super) fn gaussian(length: f64, apart: f64) -> DepartureKernel {
        DepartureKernel { family: KernelFamily::Gaussian, length, apart }
    }

    /// The value k at a squared distance, k' / r and (k' / r)' / r.
    pub(super) fn at(self, square: f64) -> [f64; 3] {
        let over = 1.0 / (self.length * self.length);
        match self.family {
            KernelFamily::Gaussian => {
                let value = (-0.5 * square * over).exp();
                [value, -value * over, value * over * over]
            }
            KernelFamily::Matern => {
                let a = (3.0 * square * over).sqrt();
                let value = (-a).exp();
                [(1.0 + a + a * a / 3.0) * value, -(1.0 + a) * over * value, 3.0 * over * over * value]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_values() {
        for family in [KernelFamily::Gaussian, KernelFamily::Matern] {
            let known = DepartureKernel { family, length: 0.7, apart: 0.4 };
            for r in [0.1_f64, 0.4, 1.3, 2.5] {
                let step = 1e-5;
                let over_r = |k: usize| {
                    let at = |r: f64| known.at(r * r)[k];
                    (at(r + step) - at(r - step)) / (2.0 * step * r)
                };
                let found = known.at(r * r);
                assert!((found[1] - over_r(0)).abs() < 1e-8, "{family:?} {r}: {found:?}");
                assert!((found[2] - over_r(1)).abs() < 1e-8, "{family:?} {r}: {found:?}");
            }
        }
    }

    #[test]
    fn slopes_of_both_have_the_same_variance() {
        let at_none = |family| DepartureKernel { family, length: 0.7, apart: 0.4 }.at(0.0)[1];
        assert!((at_none(KernelFamily::Gaussian) - at_none(KernelFamily::Matern)).abs() < 1e-12);
    }
}
