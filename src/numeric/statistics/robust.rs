//! Scales by medians, and the losses of Huber and Tukey.
//!
//! ```text
//! s = MAD_TO_SD median |d|  (in one dimension),  RAYLEIGH_TO_SD median |d|  (of vectors in a plane);    t = d/s
//! Huber  w = min(1, HUBER/|t|)            Tukey  w = (1 - (t/TUKEY)^2)^2, 0 beyond TUKEY
//! ```
//!
//! P. J. Huber, *Robust Statistics*, 1981; A. Beaton and J. Tukey, *Technometrics* 16 (1974) 147. Both constants give 95 % of
//! least squares' efficiency under gaussian errors.

use super::order::median;

/// Standard deviation of a gaussian over the median of its magnitude.
pub const MAD_TO_SD: f64 = 1.4826;

/// Standard deviation of two independent gaussians of one scale over the median length of the vector of both.
pub const RAYLEIGH_TO_SD: f64 = 1.0 / 1.177_41;

/// Scales beyond which Huber's weights fall.
pub const HUBER: f64 = 1.345;

/// Scales beyond which Tukey's weights vanish.
const TUKEY: f64 = 4.685;

/// `MAD_TO_SD median |d|`, the standard deviation by the median deviation from 0; 0 of an empty list.
pub fn mad(deviations: impl IntoIterator<Item = f64>) -> f64 {
    MAD_TO_SD * median(deviations.into_iter().map(f64::abs).collect::<Vec<_>>()).unwrap_or(0.0)
}

/// `MAD_TO_SD median |d - median d|`; 0 of an empty list.
pub fn mad_about_median(values: &[f64]) -> f64 {
    let middle = median(values.to_vec()).unwrap_or(0.0);
    mad(values.iter().map(|v| v - middle))
}

/// Huber's weight of a deviation in the unit of `scale`.
#[inline]
pub fn huber_weight(deviation: f64, scale: f64) -> f64 {
    (HUBER * scale / deviation.abs()).min(1.0)
}

/// A loss that grows less than the square, by the weights of its reweighted least squares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    Huber,
    Tukey,
}

impl Loss {
    /// Square root of the weight at a residual of `t >= 0` scales: what a row of equations is multiplied by.
    pub fn root_weight(self, t: f64) -> f64 {
        match self {
            Loss::Huber => self.weight_and_slope(t)[0].sqrt(),
            Loss::Tukey => (1.0 - (t / TUKEY).powi(2)).max(0.0),
        }
    }

    /// Weight, and derivative of `psi = weight t`, at a residual of `t >= 0` scales.
    pub fn weight_and_slope(self, t: f64) -> [f64; 2] {
        match self {
            Loss::Huber if t <= HUBER => [1.0, 1.0],
            Loss::Huber => [HUBER / t, 0.0],
            Loss::Tukey if t < TUKEY => {
                let square = (t / TUKEY).powi(2);
                [(1.0 - square).powi(2), (1.0 - square) * (1.0 - 5.0 * square)]
            }
            Loss::Tukey => [0.0, 0.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_do_not_feel_an_outlier() {
        assert_eq!(mad([-1.0, 2.0, 1e9]), 2.0 * MAD_TO_SD);
        assert_eq!(mad_about_median(&[9.0, 10.0, 12.0, 1e9, 11.0]), MAD_TO_SD);
        assert_eq!((mad([]), mad_about_median(&[])), (0.0, 0.0));
    }

    #[test]
    fn weights_are_psi_over_t_and_their_slopes_its_derivative() {
        for loss in [Loss::Huber, Loss::Tukey] {
            for t in [0.0, 0.3, 1.3, 2.0, 4.6, 5.0] {
                let [weight, slope] = loss.weight_and_slope(t);
                let psi = |t: f64| loss.weight_and_slope(t)[0] * t;
                assert!(((psi(t + 1e-6) - psi(t - 1e-6)) / 2e-6 - slope).abs() < 1e-8 || t == 0.0, "{loss:?} {t}");
                assert!((loss.root_weight(t).powi(2) - weight).abs() < 1e-15, "{loss:?} {t}");
            }
        }
        assert_eq!([0.0, 1.0, 2.0].map(|d| huber_weight(d, 1.0)), [1.0, 1.0, 0.5 * HUBER]);
    }
}
