//! Marks on two axes, drawn as they come.

use super::axis::Axis;
use super::frame::{Frame, Rect, SMALL, frame, grid};
use super::numbers::Numbers;
use crate::report::colour::mix;
use crate::report::drawing::{Anchor, Colour, Drawing, Hook};

/// How a mark looks: its colour in files, its class on the page.
#[derive(Clone, Copy, Debug)]
pub(in crate::report) struct Style {
    pub class: &'static str,
    pub colour: Colour,
    pub own_colour: bool,
}

impl Style {
    /// What the chart is about.
    pub(in crate::report) const MAIN: Style = Style::new("", [0, 114, 178]);
    /// What stands beside it.
    pub(in crate::report) const SECOND: Style = Style::new("second", [213, 94, 0]);
    pub(in crate::report) const QUIET: Style = Style::new("quiet", [150; 3]);
    pub(in crate::report) const MEAN: Style = Style::new("mean", [0; 3]);
    pub(in crate::report) const TRUTH: Style = Style::new("truth", [213, 94, 0]);
    pub(in crate::report) const ZERO: Style = Style::new("zero", [120; 3]);
    pub(in crate::report) const GOAL: Style = Style::new("goal", [120; 3]);

    const fn new(class: &'static str, colour: Colour) -> Style {
        Style { class, colour, own_colour: false }
    }

    /// From light (0) to dark (1) in files, for what has an order.
    pub(super) fn darker(self, part: f64) -> Style {
        let colour = if part < 0.5 {
            mix(mix(self.colour, [255; 3], 0.5), self.colour, 2.0 * part)
        } else {
            mix(self.colour, mix(self.colour, [0; 3], 0.6), 2.0 * part - 1.0)
        };
        Style { colour, ..self }
    }

    /// A colour of its own, on the page as well.
    pub(super) const fn own(colour: Colour) -> Style {
        Style { class: "", colour, own_colour: true }
    }

    /// The hook of a mark of this kind.
    fn hook(self, kind: &str, words: Option<String>) -> Hook {
        let class = format!("{kind} {}", self.class);
        Hook { class: class.trim_end().into(), words, own_colour: self.own_colour, file_only: false }
    }
}

/// Pixels that a chart needs at its left, for numbers and a name.
pub(in crate::report) const ROOM: f64 = 62.0;
/// Pale behind marks: an interval.
const PALE: Colour = [225, 234, 245];
/// Half the width of a whisker's end.
const CAP: f64 = 3.5;

/// A panel with its axes, and what is drawn in it.
#[derive(Debug)]
pub(in crate::report) struct Chart<'a> {
    drawing: &'a mut Drawing,
    x: Axis,
    y: Axis,
    numbers: Numbers,
    /// Pixels by which marks stand beside their place, so that several series stand side by side.
    pub(in crate::report) aside: f64,
}

impl<'a> Chart<'a> {
    /// An empty panel with its frame; `room` pixels are at its left.
    pub(in crate::report) fn new(
        drawing: &'a mut Drawing,
        rect: Rect,
        axes: [Axis; 2],
        names: [&str; 2],
        room: f64,
    ) -> Chart<'a> {
        let [[left, right], [top, bottom]] = rect;
        let [x, y] = [axes[0].placed(left, right), axes[1].placed(bottom, top)];
        let most = [((right - left) / 52.0) as usize, (((bottom - top) / 32.0) as usize).max(4)];
        grid(drawing, &x, &y, most);
        frame(drawing, &x, &y, &Frame { names, most, numbers: true, room });
        Chart { drawing, x, y, numbers: Numbers::new(rect), aside: 0.0 }
    }

    /// Pixels of a point; a little outside of the panel where it lies outside.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let near = |axis: &Axis, v: f64| axis.from + (axis.to - axis.from) * axis.share(v).clamp(-0.02, 1.02);
        [near(&self.x, x) + self.aside, near(&self.y, y)]
    }

    /// A line through points.
    pub(in crate::report) fn line(&mut self, style: Style, points: &[[f64; 2]]) {
        let points: Vec<[f64; 2]> = points.iter().map(|p| self.place(*p)).collect();
        self.drawing.line(&points, 1.6, style.colour);
        self.drawing.hook(style.hook("line", None));
    }

    /// A point with its words.
    pub(in crate::report) fn dot(&mut self, style: Style, at: [f64; 2], radius: f64, words: String) {
        let at = self.place(at);
        self.drawing.dots(vec![at], radius, style.colour);
        self.drawing.hook(style.hook("dot", Some(words)));
    }

    /// A bar of a histogram from `lo` to `hi`, of this height.
    pub(in crate::report) fn bar(&mut self, [lo, hi]: [f64; 2], height: f64, words: String) {
        let ([left, top], [right, bottom]) = (self.place([lo, height]), self.place([hi, 0.0]));
        let right = (right - 0.6).max(left + 0.4);
        let colour = Style::MAIN.colour;
        self.drawing.area(&[[left, top], [right, top], [right, bottom], [left, bottom]], colour, colour);
        self.drawing.hook(Style::MAIN.hook("bar", Some(words)));
    }

    /// A stripe over the whole height between two values of x.
    pub(in crate::report) fn stripe(&mut self, [lo, hi]: [f64; 2]) {
        let (left, right) = (self.place([lo, 0.0])[0], self.place([hi, 0.0])[0]);
        let (right, top, bottom) = (right.max(left + 1.0), self.y.to, self.y.from);
        self.drawing.area(&[[left, top], [right, top], [right, bottom], [left, bottom]], PALE, PALE);
        self.drawing.on_page("stripe");
    }

    /// An upright line at a value of x.
    pub(in crate::report) fn upright(&mut self, style: Style, x: f64) {
        let at = self.place([x, 0.0])[0];
        self.drawing.line(&[[at, self.y.to], [at, self.y.from]], 2.0, style.colour);
        self.drawing.on_page(style.class);
    }

    /// An error bar between two points, with ends where it is `capped`.
    pub(in crate::report) fn whisker(&mut self, style: Style, ends: [[f64; 2]; 2], capped: bool) {
        let [[a, b], [c, d]] = ends.map(|p| self.place(p));
        let line = if capped {
            vec![[a - CAP, b], [a + CAP, b], [a, b], [c, d], [c - CAP, d], [c + CAP, d]]
        } else {
            vec![[a, b], [c, d]]
        };
        self.drawing.line(&line, 1.2, style.colour);
        self.drawing.hook(style.hook("whisker", None));
    }

    /// Numbers keep off a mark of this radius.
    pub(in crate::report) fn keep_off(&mut self, at: [f64; 2], radius: f64) {
        self.numbers.keep_off(self.place(at), radius);
    }

    /// Words beside a point, where they cover nothing.
    pub(in crate::report) fn word(&mut self, at: [f64; 2], text: &str) {
        let at = self.place(at);
        self.numbers.word(self.drawing, at, text);
    }

    /// Words keep off a line.
    pub(in crate::report) fn keep_off_line(&mut self, points: &[[f64; 2]]) {
        const APART: f64 = 8.0;
        let points: Vec<[f64; 2]> = points.iter().map(|p| self.place(*p)).collect();
        for (from, to) in points.iter().zip(points.iter().skip(1)) {
            let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / APART).ceil().max(1.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                self.numbers.keep_off([0, 1].map(|k| from[k] + share * (to[k] - from[k])), 2.0);
            }
        }
    }

    /// A number beside a point, where it covers nothing; the page has words instead.
    pub(in crate::report) fn number(&mut self, at: [f64; 2], text: &str) {
        let at = self.place(at);
        self.numbers.add(self.drawing, at, text);
    }
}

/// One line of what marks mean, each with a dot of its colour; `left` and `right` are its ends.
pub(in crate::report) fn legend(drawing: &mut Drawing, [left, right]: [f64; 2], y: f64, marks: &[(Colour, String)]) {
    let mut at = left;
    for (k, (colour, words)) in marks.iter().enumerate() {
        let width = 22.0 + 6.2 * words.chars().count() as f64;
        if at + width > right {
            drawing.word([at, y], format!("and {} more", marks.len() - k), SMALL, Anchor::Start);
            return;
        }
        drawing.dots(vec![[at + 4.0, y]], 3.0, *colour);
        drawing.word([at + 11.0, y], words.as_str(), SMALL, Anchor::Start);
        at += width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_stand_inside_and_words_are_escaped_on_the_page_alone() {
        let mut drawing = Drawing::new(440.0, 270.0);
        let axes = [Axis::over([0.0, 1.0]), Axis::holding([2.0, 3.0].into_iter())];
        let mut chart = Chart::new(&mut drawing, [[62.0, 428.0], [12.0, 224.0]], axes, ["x", "y"], 62.0);
        chart.dot(Style::MAIN, [1.0, 3.0], 3.0, "<i>".into());
        chart.number([1.0, 3.0], "8");
        let page = drawing.inline("chart", "a <b>", "");
        assert!(page.contains("&lt;i&gt;") && !page.contains("<i>") && page.contains("a &lt;b&gt;"));
        assert!(page.contains("cx=\"428.0\"") && !page.contains(">8<"), "{page}");
        let mut file = Vec::new();
        drawing.write_svg(&mut file).unwrap();
        let file = String::from_utf8(file).unwrap();
        assert!(!file.contains("class") && !file.contains("title") && file.contains(">8<"), "{file}");
    }
}
