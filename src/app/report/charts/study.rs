//! The figures of a study: how S and R scatter, with interval, mean and truth; shares of the classes and of the effects.

use super::chart::Style;
use super::frame::Rect;
use super::histogram::{BARS, Histogram};
use super::shares::Share;
use crate::report::drawing::Drawing;
use crate::report::study::{EffectPart, QuantityPart, StudyDocument};
use crate::report::table::significant;
use palpate_studies::montecarlo::Ranked;

/// Share of the replicates that is left out on either side of a histogram: one wild replicate would squeeze all others into
/// a bar.
pub(in crate::report) const CUT: f64 = 0.001;

/// How one quantity scatters.
pub(in crate::report) struct Scatter<'a> {
    histogram: Histogram,
    part: &'a QuantityPart,
}

impl<'a> Scatter<'a> {
    /// Of ranked values; `None` where there are none.
    pub(in crate::report) fn new(part: &'a QuantityPart, ranked: &Ranked<'_>) -> Option<Scatter<'a>> {
        Some(Scatter { histogram: of_ranked(ranked)?, part })
    }

    /// Draws it; `name` is the axis's.
    pub(in crate::report) fn draw(&self, drawing: &mut Drawing, rect: Rect, name: &str) {
        let mean = self.part.mean.map(|mean| (Style::MEAN, mean));
        let truth = self.part.truth.map(|truth| (Style::TRUTH, truth));
        let uprights: Vec<(Style, f64)> = mean.into_iter().chain(truth).collect();
        let interval = self.part.lo.zip(self.part.hi).map(|(lo, hi)| [lo, hi]);
        self.histogram.draw((drawing, rect), [name, "measurements"], interval, &uprights);
    }

    /// Where the truth lies, if too far off to be drawn.
    pub(in crate::report) fn far(&self) -> Option<String> {
        let truth = self.part.truth.filter(|truth| !self.histogram.is_near(*truth))?;
        Some(format!("The truth, {}, lies far outside of this picture.", significant(truth, 4)))
    }
}

/// Counts of ranked values.
fn of_ranked(ranked: &Ranked<'_>) -> Option<Histogram> {
    let (lo, hi) = (ranked.quantile(CUT)?, ranked.quantile(1.0 - CUT)?);
    let [lo, hi] = if lo < hi { [lo, hi] } else { [lo - 0.5, lo + 0.5] };
    // the number below a value, by halving: ranks rise with values
    let below = |value: f64| {
        let (mut a, mut b) = (0_u64, ranked.len());
        while a < b {
            let middle = a + (b - a) / 2;
            if ranked.at(middle as f64 + 1.0) < value { a = middle + 1 } else { b = middle }
        }
        a as f64
    };
    let edge = |k: usize| lo + (hi - lo) * k as f64 / BARS as f64;
    Some(Histogram { ends: [lo, hi], counts: (0..BARS).map(|k| below(edge(k + 1)) - below(edge(k))).collect() })
}

/// The classes that the measurements show, the commonest first.
pub(in crate::report) fn class_shares(document: &StudyDocument) -> Vec<Share> {
    let mut rows: Vec<&(String, f64)> = document.class.0.iter().filter(|(_, share)| *share > 0.0).collect();
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    let words = |share: f64| format!("{} %", significant(100.0 * share, 3));
    rows.into_iter().map(|(name, share)| (name.clone(), *share, words(*share))).collect()
}

/// A share with its interval.
type ShareWithEnds = (Option<f64>, Option<[f64; 2]>);

/// What each effect brings to the variance of S, and of R.
pub(in crate::report) fn effect_shares(document: &StudyDocument) -> [Vec<Share>; 2] {
    let words = |share: Option<f64>, interval: Option<[f64; 2]>| match (share, interval) {
        (Some(share), Some([lo, hi])) => format!("{share:.3} ({lo:.3} to {hi:.3})"),
        (Some(share), None) => format!("{share:.3}"),
        _ => "-".into(),
    };
    let of = |pick: fn(&EffectPart) -> ShareWithEnds| {
        let rows = document.effects.iter().map(|effect| {
            let (share, interval) = pick(effect);
            (effect.name.replace('_', " "), share.unwrap_or(0.0), words(share, interval))
        });
        rows.collect()
    };
    [of(|effect| (effect.share_S, effect.interval_S)), of(|effect| (effect.share_R, effect.interval_R))]
}
