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
pub use order::{Rank, median, order_statistic, quantile, upper_median, weighted_quantile};
pub use robust::{HUBER, Loss, MAD_TO_SD, RAYLEIGH_TO_SD, huber_weight, mad, mad_about_median};
pub use variance_component::VarianceComponent;

/// Population standard deviation; 0 of an empty list.
pub fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
}
