//! Axes: where values stand, and the round ones that have words.

/// Most words along a logarithmic axis.
const MOST_DECADES: i32 = 8;

/// An axis: values from `lo` to `hi` on pixels from `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Axis {
    pub lo: f64,
    pub hi: f64,
    pub from: f64,
    pub to: f64,
    pub logarithmic: bool,
}

impl Axis {
    /// From `lo` to `hi`.
    pub(in crate::report) fn linear([lo, hi]: [f64; 2], [from, to]: [f64; 2]) -> Axis {
        Axis { lo, hi, from, to, logarithmic: false }
    }

    /// From exactly `lo` to `hi`, to be placed.
    pub(in crate::report) fn over([lo, hi]: [f64; 2]) -> Axis {
        let [lo, hi] = if hi > lo { [lo, hi] } else { [lo - 0.5, lo + 0.5] };
        Axis::linear([lo, hi], [0.0, 1.0])
    }

    /// Of all values, with a little room; equal values get room on both sides.
    pub(in crate::report) fn holding(values: impl Iterator<Item = f64>) -> Axis {
        let [lo, hi] = range(values).unwrap_or([0.0, 1.0]);
        let room = if hi > lo { 0.05 * (hi - lo) } else { 0.5 * hi.abs().max(1e-300) };
        Axis::over([lo - room, hi + room])
    }

    /// Logarithmic, of all values above zero.
    pub(in crate::report) fn logarithmic(values: impl Iterator<Item = f64>) -> Axis {
        let [lo, hi] = range(values.filter(|v| *v > 0.0)).unwrap_or([0.1, 10.0]);
        let room = 10.0_f64.powf(0.06 * (hi / lo).log10().max(1.0));
        Axis { logarithmic: true, ..Axis::over([lo / room, hi * room]) }
    }

    /// Logarithmic over whole decades, two of them or more, so that each line across is a decade.
    pub(in crate::report) fn whole_decades(values: impl Iterator<Item = f64>) -> Axis {
        let [lo, hi] = range(values.filter(|v| *v > 0.0)).unwrap_or([0.1, 10.0]);
        // what lies at an end keeps a little room
        let (first, last) = ((0.9 * lo).log10().floor() as i32, (1.1 * hi).log10().ceil() as i32);
        let ends = [first.min(last - 2), last].map(|power| 10.0_f64.powi(power));
        Axis { logarithmic: true, ..Axis::over(ends) }
    }

    /// Two axes of one scale that hold all places, for what is seen from above; `sides` are the panel's.
    pub(in crate::report) fn level(places: &[[f64; 2]], sides: [f64; 2]) -> [Axis; 2] {
        let ends = [0, 1].map(|k| range(places.iter().map(|p| p[k])).unwrap_or([0.0, 1.0]));
        let unit = (0..2).map(|k| 1.1 * (ends[k][1] - ends[k][0]) / sides[k]).fold(0.0, f64::max);
        let unit = if unit > 0.0 { unit } else { 1.0 / sides[1] };
        [0, 1].map(|k| {
            let (middle, half) = (0.5 * (ends[k][0] + ends[k][1]), 0.5 * unit * sides[k]);
            Axis::over([middle - half, middle + half])
        })
    }

    /// The same values on other pixels.
    pub(in crate::report) fn placed(self, from: f64, to: f64) -> Axis {
        Axis { from, to, ..self }
    }

    /// The pixel of a value.
    pub(in crate::report) fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * self.share(value)
    }

    /// Where a value stands between the ends, 0 to 1.
    pub(in crate::report) fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            return (value.max(f64::MIN_POSITIVE) / self.lo).ln() / (self.hi / self.lo).ln();
        }
        (value - self.lo) / (self.hi - self.lo)
    }

    /// Round values at most so many, with their words.
    pub(in crate::report) fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        if self.logarithmic {
            return decades(self.lo, self.hi).into_iter().map(|v| (v, decade_words(v))).collect();
        }
        ticks(self.lo, self.hi, most)
    }
}

fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.filter(|v| v.is_finite());
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    (lo <= hi).then_some([lo, hi])
}

/// Values with words on a logarithmic axis: decades; where there are few, 1, 2 and 5 of each; where these are few too, all
/// whole ones.
fn decades(lo: f64, hi: f64) -> Vec<f64> {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let step = 1 + (last - first) / MOST_DECADES;
    let within = |v: &f64| (lo..=hi).contains(v);
    let coarse: Vec<f64> = (first..=last).filter(|k| k % step == 0).map(|k| 10.0_f64.powi(k)).filter(within).collect();
    if coarse.len() > 2 {
        return coarse;
    }
    let of = |digits: &[f64]| -> Vec<f64> {
        let all = (first..=last).flat_map(|k| digits.iter().map(move |m| m * 10.0_f64.powi(k)));
        all.filter(within).collect()
    };
    let fine = of(&[1.0, 2.0, 5.0]);
    if fine.len() > 2 { fine } else { of(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]) }
}

/// `1e-5`, `20`, `0.02`.
fn decade_words(value: f64) -> String {
    if (0.01..1e4).contains(&value) {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    format!("{value:.0e}")
}

/// Multiples of 1, 2 or 5 times a power of ten from `lo` to `hi`, at most `most` of them, with their words.
pub(in crate::report) fn ticks(lo: f64, hi: f64, most: usize) -> Vec<(f64, String)> {
    let span = hi - lo;
    if !(span > 0.0 && span.is_finite()) || most == 0 {
        return Vec::new();
    }
    let mut power = (span / most as f64).log10().floor() as i32;
    let mut digit = 0;
    let step = loop {
        let step = [1.0, 2.0, 5.0][digit] * 10.0_f64.powi(power);
        // a last place that rounding would lose still counts
        let count = ((hi + 1e-9 * span) / step).floor() - ((lo - 1e-9 * span) / step).ceil() + 1.0;
        if count <= most as f64 {
            break step;
        }
        digit = (digit + 1) % 3;
        power += i32::from(digit == 0);
    };
    let places = (-power).max(0) as usize;
    let first = ((lo - 1e-9 * span) / step).ceil() as i64;
    let last = ((hi + 1e-9 * span) / step).floor() as i64;
    let word = |value: f64| {
        if value == 0.0 && !(1e-4..1e6).contains(&step) {
            "0".into()
        } else if value != 0.0 && !(1e-4..1e6).contains(&value.abs().max(step)) {
            format!("{value:.1e}")
        } else {
            format!("{value:.places$}")
        }
    };
    (first..=last).map(|k| (k as f64 * step, word(k as f64 * step))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let words = |lo, hi, most| ticks(lo, hi, most).into_iter().map(|(_, w)| w).collect::<Vec<_>>();
        assert_eq!(words(-1.0, 1.0, 5), ["-1.0", "-0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(words(0.0, 0.0712, 5), ["0.00", "0.02", "0.04", "0.06"]);
        assert_eq!(words(-6.0, 6.0, 4), ["-5", "0", "5"]);
        assert!(words(1.0, 1.0, 5).is_empty() && words(f64::NAN, 1.0, 5).is_empty());
    }

    #[test]
    fn logarithmic_axes_have_words_over_one_decade_and_over_twenty() {
        let ticks = |values: [f64; 2]| Axis::logarithmic(values.into_iter()).ticks(5);
        assert!((3..=9).contains(&ticks([1e-5, 4e-5]).len()));
        assert!((3..=9).contains(&ticks([1e-17, 1e3]).len()));
        assert!(ticks([1e-6, 1e-2]).len() >= 4);
        let whole = Axis::whole_decades([2e-4, 0.03].into_iter());
        assert_eq!(whole.ticks(9).len(), 4);
        assert!((whole.lo - 1e-4).abs() < 1e-18 && (whole.hi - 0.1).abs() < 1e-15);
        assert_eq!([1e-5, 20.0, 0.02].map(decade_words), ["1e-5", "20", "0.02"]);
    }
}
