//! The figures of a sweep: S and R against the last key with error bars, as in Figures 5 and 6 of the paper.
//!
//! ```text
//! dot: mean over the replicates        bar: interval that holds the level's share of them        line: truth
//! ```
//!
//! One colour for each value of the keys before the last (Okabe and Ito's, 2008: told apart by everybody).

use super::axis::Axis;
use super::chart::{Chart, ROOM, Style};
use super::frame::GREY;
use super::frame::Rect;
use crate::report::drawing::{Colour, Drawing};
use crate::report::pictures::short;
use crate::report::study::QuantityPart;
use crate::report::sweep::SweepPoint;
use crate::report::table::significant;

const COLOURS: [Colour; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [90, 90, 90]];

/// What is swept over.
type Part = fn(&SweepPoint) -> &QuantityPart;

/// The two quantities of a sweep.
pub(in crate::report) const SWEPT: [(&str, Part); 2] =
    [("S, shape index", |p| &p.shape_index), ("R, curvedness", |p| &p.curvedness)];

/// Points that differ in the last key alone.
pub(in crate::report) struct Series<'a> {
    points: &'a [SweepPoint],
    /// Values of the keys before the last, in words.
    pub words: String,
    pub colour: Colour,
}

/// The values of the keys before the last.
fn before(point: &SweepPoint) -> Option<&[f64]> {
    point.at.split_last().map(|(_, rest)| rest)
}

/// The series of a sweep, in the order of their points.
pub(in crate::report) fn series<'a>(keys: &[&str], points: &'a [SweepPoint]) -> Vec<Series<'a>> {
    let last_word = |key: &str| key.rsplit('.').next().unwrap_or(key).to_string();
    let all = points.chunk_by(|a, b| before(a) == before(b)).enumerate();
    all.map(|(k, points)| {
        let values = points.first().and_then(before).unwrap_or_default();
        let words = keys.iter().zip(values).map(|(key, v)| format!("{} {}", last_word(key), short(*v)));
        Series { points, words: words.collect::<Vec<_>>().join(", "), colour: COLOURS[k % COLOURS.len()] }
    })
    .collect()
}

/// Draws one quantity over the last key; `false` where it is undefined everywhere.
pub(in crate::report) fn sweep_panel(
    (drawing, rect): (&mut Drawing, Rect),
    (name, part): (&str, Part),
    key: &str,
    all: &[Series],
) -> bool {
    let points = || all.iter().flat_map(|series| series.points);
    let values = points().flat_map(|p| [part(p).mean, part(p).lo, part(p).hi, part(p).truth]).flatten();
    let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    if values.is_empty() {
        return false;
    }
    let across = || points().filter_map(|point| point.at.last().copied());
    let (lo, hi) = across().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
    // ten times and more is read on a logarithmic axis
    let x = if lo > 0.0 && hi / lo > 9.0 { Axis::logarithmic(across()) } else { Axis::holding(across()) };
    let mut chart = Chart::new(drawing, rect, [x, Axis::holding(values.into_iter())], [key, name], ROOM);
    for (k, series) in all.iter().enumerate() {
        // several series stand side by side where they have the same key
        chart.aside = 3.0 * (k as f64 - 0.5 * (all.len() as f64 - 1.0)).clamp(-4.0, 4.0);
        let style = if all.len() > 1 { Style::own(series.colour) } else { Style::MAIN };
        let places = || series.points.iter().filter_map(|p| Some((*p.at.last()?, part(p))));
        let truth: Vec<[f64; 2]> = places().filter_map(|(x, q)| Some([x, q.truth?])).collect();
        chart.line(Style { colour: GREY, ..Style::TRUTH }, &truth);
        for (x, quantity) in places() {
            let interval = quantity.lo.zip(quantity.hi);
            if let Some((lo, hi)) = interval {
                chart.whisker(style, [[x, lo], [x, hi]], true);
            }
            let Some(mean) = quantity.mean else { continue };
            let number = |v: f64| significant(v, 4);
            let between = interval.map(|(lo, hi)| format!("\n{} to {}", number(lo), number(hi)));
            let words = format!("{key} {}\nmean {}{}", number(x), number(mean), between.unwrap_or_default());
            chart.dot(style, [x, mean], 3.2, words);
        }
    }
    true
}
