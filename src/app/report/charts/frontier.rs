//! The figure of a frontier: error against time or instructions, both in decades.
//!
//! ```text
//! error | o quick                      a line across is a digit; the line falls in steps through what nothing beats
//!       |   `---. o                    few points are large and have words: those that are shown first
//!       |        `------o recognised   small grey ones are all others
//! ```

use super::axis::Axis;
use super::chart::{Chart, Style};
use super::frame::Rect;
use crate::report::drawing::Drawing;
use crate::report::frontier::{BesidePart, FrontierDocument, FrontierRecord, is_unbeaten};
use crate::report::frontier_words::{judged_by_contacts, tag};
use crate::report::table::significant;

/// Errors below this are rounding: they are drawn at the lower end.
const ROUNDING: f64 = 1e-17;
/// Lines of words below a panel.
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

/// Name of the axis where the truth is unknown.
const UNSEEN: &str = "error of the height left out";

/// Time and error of a point that has both.
fn place(record: &FrontierRecord) -> Option<[f64; 2]> {
    let error = record.error.filter(|_| record.failed.is_none())?;
    Some([record.seconds?.least, error.max(ROUNDING)])
}

/// What it costs.
pub(in crate::report) type Cost = fn(&FrontierRecord) -> Option<f64>;

/// Time on one thread.
pub(in crate::report) const TIME: (&str, Cost) =
    ("microseconds on one thread", |record| record.seconds.map(|time| 1e6 * time.least));
/// Instructions.
pub(in crate::report) const INSTRUCTIONS: (&str, Cost) =
    ("instructions", |record| record.instructions.map(|count| count as f64));

/// The points of one frontier.
pub(in crate::report) struct FrontierFigure<'a> {
    pub all: Vec<&'a FrontierRecord>,
    /// Those on the frontier, from the cheapest on.
    pub on: Vec<&'a FrontierRecord>,
    /// Those that have words.
    labelled: Vec<&'a FrontierRecord>,
    /// What other programs do, where this is about ways of fitting.
    beside: &'a [BesidePart],
    kind: FrontierKind,
    error: &'static str,
}

impl<'a> FrontierFigure<'a> {
    /// Of a document; `None` where this frontier has no points.
    pub(in crate::report) fn new(document: &'a FrontierDocument, kind: FrontierKind) -> Option<FrontierFigure<'a>> {
        let of_kind = |record: &&FrontierRecord| record.frontier == kind.frontier && place(record).is_some();
        let all: Vec<&FrontierRecord> = document.points.iter().filter(of_kind).collect();
        let mut on: Vec<&FrontierRecord> = all.iter().filter(|record| record.on_frontier).copied().collect();
        let time = |record: &FrontierRecord| record.seconds.map_or(f64::INFINITY, |time| time.least);
        on.sort_by(|a, b| time(a).total_cmp(&time(b)));
        let ways = kind.frontier == "discretisation";
        let labelled = match ways {
            true => document.shortlist.iter().filter_map(|k| document.points.get(*k)).filter(of_kind).collect(),
            false => all.clone(),
        };
        let beside = if ways { &document.beside[..] } else { &[] };
        let error = if ways && judged_by_contacts(document) { UNSEEN } else { kind.error };
        (!all.is_empty()).then_some(FrontierFigure { all, on, labelled, beside, kind, error })
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
        let at = |record: &FrontierRecord| Some([cost(record)?, place(record)?[1]]);
        let places: Vec<[f64; 2]> = self.all.iter().filter_map(|record| at(record)).collect();
        // nobody counted the others' instructions
        let beside = if name == TIME.0 { self.beside } else { &[] };
        let others: Vec<[f64; 2]> = beside.iter().map(place_beside).collect();
        let axes = [0, 1].map(|k| Axis::whole_decades(places.iter().chain(&others).map(move |place| place[k])));
        let mut chart = Chart::new(drawing, rect, axes, [name, self.error], ROOM);
        for record in self.all.iter().filter(|record| !self.is_labelled(record)) {
            let Some(place) = at(record) else { continue };
            chart.dot(Style::QUIET, place, 2.0, self.words(record));
            chart.keep_off(place, 1.5);
        }
        for (part, place) in beside.iter().zip(&others) {
            chart.dot(Style::MEAN, *place, 3.5, words_beside(part));
            chart.keep_off(*place, 4.5);
        }
        let line = stairs(places);
        chart.line(Style::MAIN, &line);
        chart.keep_off_line(&line);
        for record in &self.labelled {
            let Some(place) = at(record) else { continue };
            let style = if record.surface == "recognised" { Style::MAIN } else { Style::SECOND };
            chart.dot(style, place, 5.0, self.words(record));
            chart.keep_off(place, 6.0);
        }
        for record in &self.labelled {
            at(record).into_iter().for_each(|place| chart.word(place, &tag(record)));
        }
        for (part, place) in beside.iter().zip(&others).filter(|(part, _)| is_unbeaten(part, beside)) {
            chart.word(*place, &part.program);
        }
    }

    fn is_labelled(&self, record: &FrontierRecord) -> bool {
        self.labelled.iter().any(|other| std::ptr::eq(*other, record))
    }

    /// What a point says when it is pointed at.
    fn words(&self, point: &FrontierRecord) -> String {
        let mut lines = vec![self.name(point)];
        if let Some(seconds) = point.seconds {
            lines.push(format!("time {} (half of the rounds up to {})", time(seconds.least), time(seconds.median)));
        }
        lines.push(format!("error {}", number(point.error)));
        if point.error_S.is_some() || point.error_R.is_some() {
            lines.push(format!("error of S {}, of R {}", number(point.error_S), number(point.error_R)));
        }
        lines.extend(point.digits.map(|digits| format!("{} right digits", significant(digits, 3))));
        lines.extend(point.multiply_adds.map(|count| format!("{count} multiply-adds")));
        lines.extend(point.instructions.map(|count| format!("{count} instructions")));
        if point.on_frontier {
            lines.push("on the frontier".into());
        }
        lines.join("\n")
    }
}

/// Microseconds and error.
fn place_beside(part: &BesidePart) -> [f64; 2] {
    [1e6 * part.seconds, part.error.max(ROUNDING)]
}

/// What a point of another program says when it is pointed at.
fn words_beside(part: &BesidePart) -> String {
    let (s, r) = (number(part.error_S), number(part.error_R));
    let error = significant(part.error, 3);
    format!("{}: {}\ntime {}\nerror {error}\nerror of S {s}, of R {r}", part.program, part.label, time(part.seconds))
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
