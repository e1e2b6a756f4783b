//! Numbers as people say them.

use super::super::table::{decimals, significant};

/// Significant digits of values; both ends of an interval are cut at the same decimal.
pub(super) const DIGITS: i32 = 4;

/// Magnitudes that are shown in fixed form.
const FIXED: std::ops::Range<f64> = 1e-6..1e7;

/// A probability in whole per cent.
pub(crate) fn chance(probability: f64) -> String {
    match (100.0 * probability).round() {
        p if p >= 100.0 => "more than 99 %".into(),
        p if p < 1.0 => "less than 1 %".into(),
        p => format!("{p} %"),
    }
}

/// A share in whole per cent.
pub(super) fn of_hundred(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// Formats values as many decimals long as `mean` needs; all with an exponent where `mean` is very small or large.
pub(super) fn like(mean: f64, places: Option<usize>) -> impl Fn(f64) -> String {
    let places = places.unwrap_or_else(|| decimals(mean, DIGITS));
    let fixed = mean == 0.0 || FIXED.contains(&mean.abs());
    move |value| if fixed { format!("{value:.places$}") } else { significant(value, DIGITS) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_are_said_in_whole_per_cent() {
        assert_eq!([0.999, 0.982, 0.5, 0.001].map(chance), ["more than 99 %", "98 %", "50 %", "less than 1 %"]);
    }
}
