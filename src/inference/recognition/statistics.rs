//! Middle and scatter of numbers, and from where on Huber's weights fall.
//!
//! ```text
//! median m     as many values below m as above        sd^2 = (1/n) sum (x_i - mean)^2
//! ```

/// Huber's constant: 95 % efficiency for gaussian errors.
pub(super) const HUBER: f64 = 1.345;

/// The median, by selection; 0 of an empty list.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let n = values.len();
    if n == 0 {
        return 0.0;
    }
    let (below, middle, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    let middle = *middle;
    if n % 2 == 1 { middle } else { 0.5 * (middle + below.iter().copied().fold(f64::NEG_INFINITY, f64::max)) }
}

/// Population standard deviation.
pub(super) fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
}
