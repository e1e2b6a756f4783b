//! Middle and scatter of numbers: order statistics, scales that outliers do not move, losses that give them less weight.
//!
//! ```text
//! median m     as many values below m as above        sd^2 = (1/n) sum (x_i - mean)^2
//! ```

mod exponential;
mod order;
mod robust;
mod variance_component;

pub use exponential::ExponentialCorrelation;
pub use order::{
    ENOUGH_FOR_RANKS, Rank, evenly_among, median, order_statistic, quantile, upper_median, weighted_quantile,
};
pub use robust::{HUBER, Loss, MAD_TO_SD, RAYLEIGH_TO_SD, huber_weight, mad, mad_about_median};
pub use variance_component::VarianceComponent;

/// ln((e^a + e^b) / 2), as of two cases that are as probable beforehand; minus infinity where both are.
pub fn log_mean_exp(a: f64, b: f64) -> f64 {
    let most = a.max(b);
    if most == f64::NEG_INFINITY { most } else { most + (-(a - b).abs()).exp().ln_1p() - std::f64::consts::LN_2 }
}

/// Fourth moment over the square of the second, both about 0; infinite where all values are 0.
pub fn kurtosis_about_zero(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let [second, fourth] = [2, 4].map(|power| values.iter().map(|v| v.powi(power)).sum::<f64>() / count);
    if second > 0.0 { fourth / (second * second) } else { f64::INFINITY }
}

/// Population standard deviation; 0 of an empty list.
pub fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kurtosis_of_two_values_is_1_and_of_nothing_infinite() {
        assert_eq!(kurtosis_about_zero(&[2.0, -2.0, 2.0]), 1.0);
        assert_eq!(kurtosis_about_zero(&[1.0, -1.0, 0.0, 0.0]), 2.0);
        assert_eq!(kurtosis_about_zero(&[0.0, 0.0]), f64::INFINITY);
        assert_eq!(kurtosis_about_zero(&[]), f64::INFINITY);
    }

    #[test]
    fn a_log_mean_is_that_of_the_mean() {
        assert!((log_mean_exp(2.0_f64.ln(), 4.0_f64.ln()) - 3.0_f64.ln()).abs() < 1e-15);
        // neither overflows, nor is what is impossible twice anything else
        assert!((log_mean_exp(2000.0, 2000.0) - 2000.0).abs() < 1e-12);
        assert_eq!(log_mean_exp(f64::NEG_INFINITY, f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert!((log_mean_exp(0.0, f64::NEG_INFINITY) + std::f64::consts::LN_2).abs() < 1e-15);
    }
}
