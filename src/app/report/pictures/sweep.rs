//! `sweep`: S and R against the last key of a sweep with error bars, as in Figures 5 and 6 of the paper.
//!
//! ```text
//! dot: mean over the replicates        bar: interval that holds the level's share of them        line: truth
//! ```
//!
//! One colour for each value of the keys before the last (Okabe and Ito's, 2008: told apart by everybody).

use std::io::Write;

use crate::report::drawing::{Anchor, Colour, Drawing};
use crate::report::percent::percent;
use crate::report::study::QuantityPart;
use crate::report::sweep::SweepPoint;

use super::PictureFormat;
use super::scale::{Axis, BLACK, GREY, LARGE, MIDDLE, SMALL, fitting, foot, picture, short, ticks};
use super::write_drawing;

/// Edges of the two panels.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 486.0;
const PANELS: [[f64; 2]; 2] = [[34.0, 204.0], [222.0, 392.0]];
const COLOURS: [Colour; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [90, 90, 90]];

type Part = fn(&SweepPoint) -> &QuantityPart;

/// Draws a sweep; `level` is that of the bars.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_picture(
    title: &str,
    keys: &[&str],
    points: &[SweepPoint],
    level: f64,
    format: PictureFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write_drawing(&sweep(title, keys, points, level), format, out)
}

fn sweep(title: &str, keys: &[&str], points: &[SweepPoint], level: f64) -> Drawing {
    let lines = lines(points);
    let named = if lines.len() > 1 { 16.0 } else { 0.0 };
    let mut drawing = picture(446.0 + named);
    drawing.word([8.0, 14.0], fitting(title, 70), LARGE, Anchor::Start);
    let xs: Vec<f64> = points.iter().filter_map(|point| point.at.last().copied()).collect();
    let (x0, x1) = xs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
    // ten times and more is read on a logarithmic axis
    let logarithmic = x0 > 0.0 && x1 / x0 > 9.0;
    let place = move |x: f64| if logarithmic { x.log10() } else { x };
    let room = if x1 > x0 { 0.04 * (place(x1) - place(x0)) } else { 0.5 };
    let x = Axis { lo: place(x0) - room, hi: place(x1) + room, from: LEFT, to: RIGHT };
    let parts: [(&str, Part); 2] = [("S, shape index", |p| &p.shape_index), ("R, curvedness", |p| &p.curvedness)];
    for ((name, part), bounds) in parts.into_iter().zip(PANELS) {
        panel(&mut drawing, name, part, bounds, points, &|v| x.at(place(v)));
    }
    key_axis(&mut drawing, &x, logarithmic);
    let key = keys.last().copied().unwrap_or("");
    drawing.word([0.5 * (LEFT + RIGHT), PANELS[1][1] + 28.0], fitting(key, 60), MIDDLE, Anchor::Middle);
    if lines.len() > 1 {
        legend(&mut drawing, keys, &lines);
    }
    let words = format!("dots: mean; bars: {} of the replicates; lines: truth", percent(level));
    foot(&mut drawing, &[words]);
    drawing
}

/// One quantity: its frame, its axis, its lines.
fn panel(
    drawing: &mut Drawing,
    name: &str,
    part: Part,
    [top, bottom]: [f64; 2],
    points: &[SweepPoint],
    x: &dyn Fn(f64) -> f64,
) {
    let ends = points.iter().flat_map(|p| [part(p).mean, part(p).lo, part(p).hi, part(p).truth]).flatten();
    let (lo, hi) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let bounds = [[LEFT, top], [RIGHT, top], [RIGHT, bottom], [LEFT, bottom], [LEFT, top]];
    drawing.line(&bounds, 1.0, BLACK);
    drawing.upward_word([11.0, 0.5 * (top + bottom)], name, MIDDLE);
    if !(lo.is_finite() && hi.is_finite()) {
        drawing.word([0.5 * (LEFT + RIGHT), 0.5 * (top + bottom)], "undefined everywhere", SMALL, Anchor::Middle);
        return;
    }
    let margin = 0.07 * (hi - lo).max(1e-3 * hi.abs()).max(1e-12);
    let y = Axis { lo: lo - margin, hi: hi + margin, from: bottom, to: top };
    for (value, word) in y.ticks(6) {
        drawing.line(&[[LEFT - 4.0, y.at(value)], [LEFT, y.at(value)]], 1.0, BLACK);
        drawing.word([LEFT - 6.0, y.at(value)], word, SMALL, Anchor::End);
    }
    let lines = lines(points);
    for (k, line) in lines.iter().enumerate() {
        // several lines stand side by side where they have the same key
        let aside = 3.0 * (k as f64 - 0.5 * (lines.len() as f64 - 1.0)).clamp(-4.0, 4.0);
        draw_line(drawing, line, part, &|v| x(v) + aside, &y, COLOURS[k % COLOURS.len()]);
    }
}

fn key_axis(drawing: &mut Drawing, x: &Axis, logarithmic: bool) {
    let values: Vec<(f64, String)> = if logarithmic {
        let decades = x.lo.floor() as i32..=x.hi.ceil() as i32;
        let dense = x.hi - x.lo < 2.5;
        let digits: &[f64] = if dense { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = decades.flat_map(|k| digits.iter().map(move |d| d * 10.0_f64.powi(k)));
        all.map(|v| (v.log10(), short(v))).filter(|(v, _)| (x.lo..=x.hi).contains(v)).collect()
    } else {
        ticks(x.lo, x.hi, 8)
    };
    for (value, word) in values {
        for [_, bottom] in PANELS {
            drawing.line(&[[x.at(value), bottom], [x.at(value), bottom + 4.0]], 1.0, BLACK);
        }
        drawing.word([x.at(value), PANELS[1][1] + 12.0], word, SMALL, Anchor::Middle);
    }
}

fn draw_line(drawing: &mut Drawing, line: &[SweepPoint], part: Part, x: &dyn Fn(f64) -> f64, y: &Axis, colour: Colour) {
    let places = || line.iter().filter_map(|p| Some((x(*p.at.last()?), part(p))));
    let truth: Vec<[f64; 2]> = places().filter_map(|(x, q)| Some([x, y.at(q.truth?)])).collect();
    drawing.line(&truth, 1.0, GREY);
    for (at, quantity) in places() {
        if let (Some(lo), Some(hi)) = (quantity.lo, quantity.hi) {
            let [low, high] = [lo, hi].map(|v| y.at(v));
            drawing.line(&[[at, low], [at, high]], 1.2, colour);
            for end in [low, high] {
                drawing.line(&[[at - 3.5, end], [at + 3.5, end]], 1.2, colour);
            }
        }
    }
    let dots = places().filter_map(|(x, q)| Some([x, y.at(q.mean?)])).collect();
    drawing.dots(dots, 3.0, colour);
}

/// What the colours are, in one line.
fn legend(drawing: &mut Drawing, keys: &[&str], lines: &[&[SweepPoint]]) {
    let mut left = LEFT;
    let y = drawing.size[1] - 16.0;
    let last = keys.len().saturating_sub(1);
    for (k, line) in lines.iter().enumerate() {
        let values = line.first().map(|p| &p.at[..]).unwrap_or_default();
        let last_word = |key: &str| key.rsplit('.').next().unwrap_or(key).to_string();
        let words = keys.iter().take(last).zip(values).map(|(key, v)| format!("{} {}", last_word(key), short(*v)));
        let words = words.collect::<Vec<_>>().join(", ");
        let width = 22.0 + 6.2 * words.chars().count() as f64;
        if left + width > RIGHT {
            drawing.word([left, y], format!("and {} more", lines.len() - k), SMALL, Anchor::Start);
            return;
        }
        drawing.dots(vec![[left + 4.0, y]], 3.0, COLOURS[k % COLOURS.len()]);
        drawing.word([left + 11.0, y], words, SMALL, Anchor::Start);
        left += width;
    }
}

/// Points that differ in the last key alone.
fn lines(points: &[SweepPoint]) -> Vec<&[SweepPoint]> {
    points.chunk_by(|a, b| a.at.split_last().map(|(_, rest)| rest) == b.at.split_last().map(|(_, rest)| rest)).collect()
}
