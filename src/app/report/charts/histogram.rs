//! How many values fall where, with the interval, the mean and the truth on it.

use super::axis::Axis;
use super::chart::{Chart, ROOM, Style};
use super::frame::Rect;
use crate::report::drawing::Drawing;
use crate::report::table::significant;

/// Bars of a histogram.
pub(in crate::report) const BARS: usize = 48;

/// Counts between evenly spaced edges.
#[derive(Clone, Debug)]
pub(in crate::report) struct Histogram {
    /// Ends of the first and the last bar.
    pub ends: [f64; 2],
    /// Values in each bar.
    pub counts: Vec<f64>,
}

impl Histogram {
    /// Of values at hand; `None` of none. Values that are all alike get one wide bar.
    pub(in crate::report) fn of(values: &[f64]) -> Option<Histogram> {
        let (lo, hi) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        if lo > hi {
            return None;
        }
        let [lo, hi] = if hi > lo { [lo, hi] } else { [lo - 0.5, lo + 0.5] };
        // fewer values want wider bars
        let bars = ((values.len() as f64).sqrt() * 2.0).ceil().clamp(5.0, BARS as f64) as usize;
        let mut counts = vec![0.0; bars];
        for value in values {
            let at = ((value - lo) / (hi - lo) * bars as f64) as usize;
            counts[at.min(bars - 1)] += 1.0;
        }
        Some(Histogram { ends: [lo, hi], counts })
    }

    /// Whether a value may stand beside the bars: one far away would squeeze them all into a stroke.
    pub(in crate::report) fn is_near(&self, value: f64) -> bool {
        let [lo, hi] = self.ends;
        (lo - 0.75 * (hi - lo)..=hi + 0.75 * (hi - lo)).contains(&value)
    }

    /// Ends of bar `k`.
    fn edges(&self, k: usize) -> [f64; 2] {
        let [lo, hi] = self.ends;
        [k, k + 1].map(|k| lo + (hi - lo) * k as f64 / self.counts.len() as f64)
    }

    /// Draws it: `what` is counted along an axis of this name; `stripe` and `uprights` stand behind and before the bars.
    pub(in crate::report) fn draw(
        &self,
        (drawing, rect): (&mut Drawing, Rect),
        [name, what]: [&str; 2],
        stripe: Option<[f64; 2]>,
        uprights: &[(Style, f64)],
    ) {
        let most = self.counts.iter().fold(1.0_f64, |m, c| m.max(*c));
        let [lo, hi] = self.ends;
        let marked = uprights.iter().map(|(_, value)| *value).filter(|value| self.is_near(*value));
        let (lo, hi) = marked.fold((lo, hi), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let axes = [Axis::holding([lo, hi].into_iter()), Axis::over([0.0, 1.06 * most])];
        let mut chart = Chart::new(drawing, rect, axes, [name, &format!("number of {what}")], ROOM);
        if let Some([a, b]) = stripe {
            chart.stripe([a.max(lo), b.min(hi)]);
        }
        for (k, count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
            let [a, b] = self.edges(k);
            chart.bar([a, b], *count, format!("{count} {what} from {} to {}", significant(a, 4), significant(b, 4)));
        }
        for (style, value) in uprights.iter().filter(|(_, value)| self.is_near(*value)) {
            chart.upright(*style, *value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_counted_once() {
        let values: Vec<f64> = (0..500).map(|k| (k as f64 * 0.37).sin()).collect();
        let found = Histogram::of(&values).unwrap();
        assert_eq!(found.counts.iter().sum::<f64>(), 500.0);
        assert_eq!(Histogram::of(&[2.0, 2.0]).unwrap().counts.iter().sum::<f64>(), 2.0);
        assert!(Histogram::of(&[]).is_none());
    }
}
