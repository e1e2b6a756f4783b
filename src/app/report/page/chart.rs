//! A chart as SVG inside the page: two axes, and marks whose values show when pointed at.
//!
//! Colours come from the style sheet, so that a chart follows light and dark; a mark's `<title>` is read out by screen readers
//! and shown by browsers without JavaScript, too.

use std::fmt::Write as _;

use super::html::text;
use crate::report::table::significant;

/// Pixels of the viewing box; a phone shows it a little smaller, a desktop a little larger.
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 270.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 46.0;
/// About as many ticks an axis has.
const TICKS: f64 = 5.0;

/// One axis.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    name: String,
    ends: [f64; 2],
    logarithmic: bool,
}

impl Axis {
    /// An axis that holds all `values`, with a little room; equal values get room on both sides.
    pub(super) fn holding(name: &str, values: impl Iterator<Item = f64>) -> Axis {
        let [lo, hi] = range(values.filter(|v| v.is_finite())).unwrap_or([0.0, 1.0]);
        let room = if hi > lo { 0.04 * (hi - lo) } else { 0.5 * hi.abs().max(1e-300) };
        Axis { name: name.into(), ends: [lo - room, hi + room], logarithmic: false }
    }

    /// An axis from exactly `lo` to `hi`.
    pub(super) fn over(name: &str, [lo, hi]: [f64; 2]) -> Axis {
        let ends = if hi > lo { [lo, hi] } else { [lo - 0.5, lo + 0.5] };
        Axis { name: name.into(), ends, logarithmic: false }
    }

    /// A logarithmic axis that holds all values above zero.
    pub(super) fn logarithmic(name: &str, values: impl Iterator<Item = f64>) -> Axis {
        let [lo, hi] = range(values.filter(|v| *v > 0.0 && v.is_finite())).unwrap_or([0.1, 10.0]);
        let room = (hi / lo).powf(0.06).max(1.3);
        Axis { name: name.into(), ends: [lo / room, hi * room], logarithmic: true }
    }

    /// Two axes of one scale that hold all places, for what is seen from above.
    pub(super) fn level([x, y]: [&str; 2], places: &[[f64; 2]]) -> [Axis; 2] {
        let room = [WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM];
        let ends = [0, 1].map(|k| range(places.iter().map(|p| p[k]).filter(|v| v.is_finite())).unwrap_or([0.0, 1.0]));
        let unit = (0..2).map(|k| 1.1 * (ends[k][1] - ends[k][0]) / room[k]).fold(0.0, f64::max);
        let unit = if unit > 0.0 { unit } else { 1.0 / room[1] };
        [(0, x), (1, y)].map(|(k, name)| {
            let (middle, half) = (0.5 * (ends[k][0] + ends[k][1]), 0.5 * unit * room[k]);
            Axis::over(name, [middle - half, middle + half])
        })
    }

    /// Where a value stands, 0 to 1; a little outside where it lies outside.
    fn share(&self, value: f64) -> f64 {
        let [lo, hi] = self.ends;
        let share = if self.logarithmic {
            (value.max(f64::MIN_POSITIVE) / lo).ln() / (hi / lo).ln()
        } else {
            (value - lo) / (hi - lo)
        };
        share.clamp(-0.02, 1.02)
    }

    /// Values with a tick.
    fn ticks(&self) -> Vec<f64> {
        let [lo, hi] = self.ends;
        if !self.logarithmic {
            return even_ticks(lo, hi);
        }
        if hi < 8.0 * lo {
            return even_ticks(lo, hi);
        }
        let (first, last) = (lo.log10().ceil() as i32, hi.log10().floor() as i32);
        let decades = last - first + 1;
        let step = (decades / 6 + 1).max(1) as usize;
        let steps: &[f64] = if decades <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = (first - 1..=last).step_by(step).flat_map(|d| steps.iter().map(move |s| s * 10.0_f64.powi(d)));
        all.filter(|v| (lo..=hi).contains(v)).collect()
    }
}

fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    (lo <= hi).then_some([lo, hi])
}

/// Round values between two ends: multiples of 1, 2 or 5 times a power of ten.
pub(super) fn even_ticks(lo: f64, hi: f64) -> Vec<f64> {
    let raw = (hi - lo) / TICKS;
    if !(raw.is_finite() && raw > 0.0) {
        return Vec::new();
    }
    let power = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|s| s * power).find(|s| *s >= raw).unwrap_or(10.0 * power);
    let first = (lo / step).ceil();
    let count = ((hi / step).floor() - first).clamp(-1.0, 20.0) as i64 + 1;
    (0..count).map(|k| (first + k as f64) * step).collect()
}

/// A tick's number: no more digits than the step needs.
pub(super) fn tick_words(value: f64, all: &[f64]) -> String {
    let step = all.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min);
    let size = all.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if !step.is_finite() || size == 0.0 || !(1e-4..1e6).contains(&size) {
        return if value.abs() < 1e-9 * size {
            "0".into()
        } else {
            format!("{value:.2e}").replace(".00e", "e").replace("0e", "e")
        };
    }
    let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let words = format!("{value:.decimals$}");
    if words.trim_start_matches(['-', '0', '.']).is_empty() { "0".into() } else { words }
}

/// Marks on two axes.
pub(super) struct Chart {
    x: Axis,
    y: Axis,
    label: String,
    marks: String,
}

impl Chart {
    /// An empty chart; `label` says in a sentence what it shows.
    pub(super) fn new(label: &str, x: Axis, y: Axis) -> Chart {
        Chart { x, y, label: label.into(), marks: String::new() }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let across = LEFT + self.x.share(x) * (WIDTH - LEFT - RIGHT);
        let down = HEIGHT - BOTTOM - self.y.share(y) * (HEIGHT - TOP - BOTTOM);
        [across, down]
    }

    /// A line through points.
    pub(super) fn line(&mut self, class: &str, points: &[[f64; 2]]) {
        let places: Vec<String> =
            points.iter().map(|p| self.place(*p)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(self.marks, "<polyline class=\"line {class}\" points=\"{}\"/>", places.join(" "));
    }

    /// An area between two lines over the same x: `[x, lower, upper]`.
    pub(super) fn band(&mut self, class: &str, points: &[[f64; 3]]) {
        let upper = points.iter().map(|[x, _, hi]| [*x, *hi]);
        let lower = points.iter().rev().map(|[x, lo, _]| [*x, *lo]);
        let places = upper.chain(lower).map(|p| self.place(p)).map(|[x, y]| format!("{x:.1},{y:.1}"));
        let places: Vec<String> = places.collect();
        let _ = writeln!(self.marks, "<polygon class=\"band {class}\" points=\"{}\"/>", places.join(" "));
    }

    /// A point with its words.
    pub(super) fn dot(&mut self, class: &str, at: [f64; 2], radius: f64, words: &str) {
        let [x, y] = self.place(at);
        let words = text(words);
        let _ = writeln!(
            self.marks,
            "<circle class=\"dot {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" tabindex=\"-1\"><title>{words}</title></circle>"
        );
    }

    /// A bar of a histogram from `lo` to `hi`, of this height.
    pub(super) fn bar(&mut self, class: &str, [lo, hi]: [f64; 2], height: f64, words: &str) {
        let ([left, top], [right, bottom]) = (self.place([lo, height]), self.place([hi, 0.0]));
        let (width, tall) = ((right - left - 0.6).max(0.4), (bottom - top).max(0.0));
        let words = text(words);
        let _ = writeln!(
            self.marks,
            "<rect class=\"bar {class}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{tall:.1}\" tabindex=\"-1\">\
             <title>{words}</title></rect>"
        );
    }

    /// A stripe over the whole height between two values of x.
    pub(super) fn stripe(&mut self, class: &str, [lo, hi]: [f64; 2]) {
        let (left, right) = (self.place([lo, 0.0])[0], self.place([hi, 0.0])[0]);
        let (width, tall) = ((right - left).max(1.0), HEIGHT - TOP - BOTTOM);
        let _ = writeln!(
            self.marks,
            "<rect class=\"stripe {class}\" x=\"{left:.1}\" y=\"{TOP}\" width=\"{width:.1}\" height=\"{tall}\"/>"
        );
    }

    /// An upright line at a value of x.
    pub(super) fn upright(&mut self, class: &str, x: f64) {
        let (at, bottom) = (self.place([x, 0.0])[0], HEIGHT - BOTTOM);
        let _ = writeln!(
            self.marks,
            "<line class=\"{class}\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>"
        );
    }

    /// An error bar from `lo` to `hi` in y, or in x where `across`.
    pub(super) fn whisker(&mut self, class: &str, ends: [[f64; 2]; 2]) {
        let [[a, b], [c, d]] = ends.map(|p| self.place(p));
        let _ = writeln!(
            self.marks,
            "<line class=\"whisker {class}\" x1=\"{a:.1}\" y1=\"{b:.1}\" x2=\"{c:.1}\" y2=\"{d:.1}\"/>"
        );
    }

    /// The SVG.
    pub(super) fn svg(&self) -> String {
        let mut out = format!(
            "<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">\n",
            text(&self.label)
        );
        self.ticks(&mut out);
        out.push_str(&self.marks);
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        let middle = 0.5 * (LEFT + right);
        let _ = writeln!(
            out,
            "<line class=\"axis\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/>\
             <text class=\"name\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text class=\"name\" transform=\"translate(12 {}) rotate(-90)\" text-anchor=\"middle\">{}</text></svg>",
            HEIGHT - 8.0,
            text(&self.x.name),
            0.5 * (TOP + bottom),
            text(&self.y.name)
        );
        out
    }

    /// Ticks with their numbers along both axes.
    fn ticks(&self, out: &mut String) {
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        let across = self.x.ticks();
        for tick in &across {
            let x = self.place([*tick, 0.0])[0];
            let words = self.words(*tick, &across, self.x.logarithmic);
            let _ = writeln!(
                out,
                "<line class=\"tick\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{bottom}\" y2=\"{}\"/>\
                 <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{words}</text>",
                bottom + 4.0,
                bottom + 17.0
            );
        }
        let up = self.y.ticks();
        for tick in &up {
            let y = self.place([0.0, *tick])[1];
            let words = self.words(*tick, &up, self.y.logarithmic);
            let _ = writeln!(
                out,
                "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{words}</text>",
                LEFT - 6.0,
                y + 4.0
            );
        }
    }

    fn words(&self, tick: f64, all: &[f64], logarithmic: bool) -> String {
        if logarithmic {
            let round = format!("{tick:.1e}").parse().unwrap_or(tick);
            return if (1e-3..1e4).contains(&tick) { format!("{round}") } else { format!("{round:e}") };
        }
        tick_words(tick, all)
    }
}

/// A number in words for pointing at.
pub(super) fn shown(value: f64) -> String {
    significant(value, 4)
}

/// A number with so many digits that two significant ones of `width` show.
pub(super) fn precise(value: f64, width: f64) -> String {
    let size = value.abs().max(width.abs());
    if width == 0.0 || !width.is_finite() || !(1e-4..1e6).contains(&size) {
        return shown(value);
    }
    // an interval far narrower than anything that is measured is one number
    let width = width.abs().max(1e-6 * value.abs());
    let decimals = (1.0 - width.log10().floor()).clamp(0.0, 12.0) as usize;
    let least = if value == 0.0 { 0 } else { (2.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize };
    let words = format!("{value:.*}", decimals.max(least.min(4)));
    if words.trim_start_matches(['-', '0', '.']).is_empty() { "0".into() } else { words }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_their_numbers_short() {
        let ticks = even_ticks(-0.013, 0.104);
        assert!((3..=7).contains(&ticks.len()), "{ticks:?}");
        let words: Vec<String> = ticks.iter().map(|t| tick_words(*t, &ticks)).collect();
        assert!(words.contains(&"0".to_string()) && words.iter().all(|w| w.len() <= 5), "{words:?}");
        assert!(even_ticks(1.0, 1.0).is_empty());
        let logarithmic = Axis::logarithmic("t", [1e-6, 1e-2].into_iter()).ticks();
        assert!(logarithmic.len() >= 4, "{logarithmic:?}");
    }

    #[test]
    fn ends_of_a_narrow_interval_differ() {
        assert_eq!([precise(0.499_98, 4e-5), precise(0.500_02, 4e-5)], ["0.499980", "0.500020"]);
        assert_eq!(precise(6.599_999_999_84, 1e-9), "6.6000000");
        assert_eq!([precise(-0.4, 0.1), precise(0.0, 0.1), precise(96.84, 3.0)], ["-0.400", "0", "96.8"]);
    }

    #[test]
    fn marks_stand_inside_and_words_are_escaped() {
        let mut chart = Chart::new("a <b>", Axis::over("x", [0.0, 1.0]), Axis::holding("y", [2.0, 3.0].into_iter()));
        chart.dot("a", [1.0, 3.0], 3.0, "<i>");
        let svg = chart.svg();
        assert!(svg.contains("&lt;i&gt;") && !svg.contains("<i>") && svg.contains("a &lt;b&gt;"));
        assert!(svg.contains("cx=\"428.0\""), "{svg}");
    }
}
