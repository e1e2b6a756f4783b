//! The figure of a frontier: error against time or instructions, both logarithmic.
//!
//! Every kind of point has a marker of its own, dark enough to be told apart in grey, and one of the colours that people who
//! see no red or green still tell apart (M. Okabe, K. Ito, *Color Universal Design*, 2008). Points on the frontier are large,
//! joined, numbered, and have error bars both ways; a number stands where it covers no other number and no marker.

use super::axis::Axis;
use super::chart::{Chart, Style, marker};
use super::frame::GREY;
use super::frame::Rect;
use crate::report::drawing::{Anchor, Colour, Drawing};
use crate::report::frontier::{FrontierDocument, FrontierRecord};
use crate::report::table::significant;

/// Okabe and Ito's colours, the darkest first, without the yellow that a white page swallows.
const COLOURS: [Colour; 7] =
    [[0, 0, 0], [0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];
/// Errors below this are rounding: they are drawn at the lower end.
const ROUNDING: f64 = 1e-17;
/// Most numbered points; more would cover each other.
const MOST_NUMBERS: usize = 24;
/// Lines of the key.
pub(in crate::report) const LINE: f64 = 16.0;
/// Pixels at a panel's left.
const ROOM: f64 = 67.0;

/// A kind of frontier.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrontierKind {
    /// Its name in the document and of its picture.
    pub frontier: &'static str,
    /// What is compared.
    pub title: &'static str,
    /// Name of the error's axis.
    pub error: &'static str,
}

/// The kinds there are.
pub(crate) const KINDS: [FrontierKind; 3] = [
    FrontierKind { frontier: "discretisation", title: "Ways of fitting", error: "error of S and R together" },
    FrontierKind { frontier: "solver", title: "Ways of solving the equations", error: "error of the coefficients" },
    FrontierKind { frontier: "interval", title: "Ways to an interval", error: "error of the ends / half width" },
];

/// Time and error of a point that has both.
fn place(record: &FrontierRecord) -> Option<[f64; 2]> {
    let error = record.error.filter(|_| record.failed.is_none())?;
    Some([record.seconds?.median, error.max(ROUNDING)])
}

/// What a point's marker says.
fn group(record: &FrontierRecord) -> String {
    match &record.frontier[..] {
        "solver" if record.method.starts_with("pcg") => "conjugate gradients".into(),
        "solver" => record.method.clone(),
        "interval" if record.method.starts_with("Monte Carlo") => "Monte Carlo".into(),
        "interval" => record.method.clone(),
        _ if record.surface == "parametric" => "parametric".into(),
        _ if record.degree[0] == record.degree[1] => format!("degree {}", record.degree[0]),
        _ => format!("degree {},{}", record.degree[0], record.degree[1]),
    }
}

/// What it costs: median and both ends of its interval.
pub(in crate::report) type Cost = fn(&FrontierRecord) -> Option<[f64; 3]>;

/// Seconds on one thread.
pub(in crate::report) const TIME: (&str, Cost) =
    ("seconds on one thread", |record| record.seconds.map(|time| [time.median, time.lo, time.hi]));
/// Instructions.
pub(in crate::report) const INSTRUCTIONS: (&str, Cost) =
    ("instructions", |record| record.instructions.map(|count| [count as f64; 3]));

/// The points of one frontier.
pub(in crate::report) struct FrontierFigure<'a> {
    pub all: Vec<&'a FrontierRecord>,
    /// Those on the frontier, from the cheapest on.
    pub on: Vec<&'a FrontierRecord>,
    /// Names of the kinds of markers.
    pub groups: Vec<String>,
    kind: FrontierKind,
}

impl<'a> FrontierFigure<'a> {
    /// Of a document; `None` where this frontier has no points.
    pub(in crate::report) fn new(document: &'a FrontierDocument, kind: FrontierKind) -> Option<FrontierFigure<'a>> {
        let of_kind = |record: &&FrontierRecord| record.frontier == kind.frontier && place(record).is_some();
        let all: Vec<&FrontierRecord> = document.points.iter().filter(of_kind).collect();
        let mut groups: Vec<String> = all.iter().map(|record| group(record)).collect();
        groups.sort();
        groups.dedup();
        let mut on: Vec<&FrontierRecord> = all.iter().filter(|record| record.on_frontier).copied().collect();
        let time = |record: &FrontierRecord| record.seconds.map_or(f64::INFINITY, |time| time.median);
        on.sort_by(|a, b| time(a).total_cmp(&time(b)));
        (!all.is_empty()).then_some(FrontierFigure { all, on, groups, kind })
    }

    /// Points with a number.
    pub(in crate::report) fn numbered(&self) -> &[&'a FrontierRecord] {
        &self.on[..self.on.len().min(MOST_NUMBERS)]
    }

    /// A point's name.
    pub(in crate::report) fn name(&self, record: &FrontierRecord) -> String {
        match self.kind.frontier {
            "solver" => format!("{}: {}", record.case, record.label),
            _ => record.label.clone(),
        }
    }

    /// Draws the frontier over one kind of cost.
    pub(in crate::report) fn draw(&self, drawing: &mut Drawing, rect: Rect, (name, cost): (&str, Cost)) {
        let costs = self.all.iter().filter_map(|record| cost(record)).flatten();
        let errors = self.all.iter().filter_map(|record| place(record).map(|at| at[1]));
        let ends = self.on.iter().filter_map(|record| record.error_interval).flatten().map(|end| end.max(ROUNDING));
        let axes = [Axis::logarithmic(costs), Axis::logarithmic(errors.chain(ends))];
        let mut chart = Chart::new(drawing, rect, axes, [name, self.kind.error], ROOM);
        let at = |record: &FrontierRecord| Some([cost(record)?[0], place(record)?[1]]);
        for record in self.all.iter().filter(|record| !record.on_frontier) {
            let Some(place) = at(record) else { continue };
            chart.marker(self.style(record, Style::QUIET), place, self.marker(record), 2.8, self.words(record));
        }
        // of a solver each case has a frontier of its own, and a line through all would mean nothing
        if self.kind.frontier != "solver" {
            chart
                .line(Style { colour: GREY, ..Style::SECOND }, &stairs(self.on.iter().filter_map(|r| at(r)).collect()));
        }
        for record in &self.on {
            let (Some([x, y]), Some([_, lo, hi])) = (at(record), cost(record)) else { continue };
            let ends = record.error_interval.unwrap_or([y; 2]).map(|end| end.max(ROUNDING));
            let grey = Style { colour: GREY, ..Style::SECOND };
            chart.whisker(grey, [[lo, y], [hi, y]], false);
            chart.whisker(grey, [[x, ends[0]], [x, ends[1]]], false);
        }
        for record in &self.on {
            let Some(place) = at(record) else { continue };
            chart.marker(self.style(record, Style::SECOND), place, self.marker(record), 5.0, self.words(record));
            chart.keep_off(place, 6.0);
        }
        for (number, record) in self.numbered().iter().enumerate() {
            if let Some(place) = at(record) {
                chart.number(place, &(number + 1).to_string());
            }
        }
    }

    fn marker(&self, record: &FrontierRecord) -> usize {
        self.groups.iter().position(|name| *name == group(record)).unwrap_or(0)
    }

    /// The colour of a point's kind; faint where another point is better.
    fn style(&self, record: &FrontierRecord, style: Style) -> Style {
        let colour = COLOURS[self.marker(record) % COLOURS.len()];
        Style { colour: if record.on_frontier { colour } else { colour.map(|c| c / 2 + 127) }, ..style }
    }

    /// The kinds with their markers, up to five in a line; how far down they reach. The page has their shapes alone, as its
    /// colours say what is on the frontier.
    pub(in crate::report) fn key(&self, drawing: &mut Drawing, top: f64) -> f64 {
        let columns = ((drawing.size[0] / 110.0) as usize).clamp(1, 5);
        let column = (drawing.size[0] - 40.0) / columns as f64;
        for (k, name) in self.groups.iter().enumerate() {
            let at = [24.0 + column * (k % columns) as f64, top + LINE * (k / columns) as f64];
            marker(drawing, at, k, 5.0, COLOURS[k % COLOURS.len()]);
            drawing.on_page("kind");
            drawing.word([at[0] + 10.0, at[1]], name, 11.0, Anchor::Start);
        }
        top + LINE * self.groups.len().div_ceil(columns) as f64
    }

    /// What a point says when it is pointed at.
    fn words(&self, point: &FrontierRecord) -> String {
        let mut lines = vec![self.name(point)];
        if let Some(seconds) = point.seconds {
            lines.push(format!("time {} ({} to {})", time(seconds.median), time(seconds.lo), time(seconds.hi)));
        }
        lines.push(format!("error {}", number(point.error)));
        if point.error_S.is_some() || point.error_R.is_some() {
            lines.push(format!("error of S {}, of R {}", number(point.error_S), number(point.error_R)));
        }
        lines.extend(point.digits.map(|digits| format!("{} right digits", significant(digits, 3))));
        lines.extend(point.instructions.map(|count| format!("{count} instructions")));
        if point.on_frontier {
            lines.push("on the frontier".into());
        }
        lines.join("\n")
    }
}

/// A time in the unit that fits.
pub(in crate::report) fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} us", significant(1e6 * s, 3)),
        s if s < 1.0 => format!("{} ms", significant(1e3 * s, 3)),
        s => format!("{} s", significant(s, 3)),
    }
}

/// A number, or a dash.
pub(in crate::report) fn number(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| significant(v, 3))
}

/// What the cheapest so far reaches: level until a better one, then down.
fn stairs(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    let mut least = f64::INFINITY;
    for [x, y] in points.into_iter().filter(|p| p[1].is_finite()) {
        if y < least {
            out.extend(out.last().map(|last| [x, last[1]]));
            out.push([x, y]);
            least = y;
        }
    }
    out
}
