//! `frontier.svg`, `solver.svg`, `interval.svg` and the same as PNG: error against time and against instructions, both
//! logarithmic.
//!
//! Every kind of point has a marker of its own, dark enough to be told apart in grey, and one of the colours that people who
//! see no red or green still tell apart (M. Okabe, K. Ito, *Color Universal Design*, 2008). Points on the frontier are large,
//! joined, numbered, and have error bars both ways; a number stands where it covers no other number and no marker.

use std::io::Write;

use super::drawing::{Anchor, Colour, Drawing, width_of};
use super::frontier::{FrontierDocument, FrontierRecord};
use super::frontier_axes::{Axis, Panel};

/// Okabe and Ito's colours, the darkest first, without the yellow that a white page swallows.
const COLOURS: [Colour; 7] =
    [[0, 0, 0], [0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0]];
const GREY: Colour = [120, 120, 120];
/// Lines of the key below the panels.
const LINE: f64 = 16.0;
const PANEL: [f64; 2] = [470.0, 400.0];
/// Errors below this are rounding: they are drawn at the lower end.
const ROUNDING: f64 = 1e-17;
/// Most numbered points; more would cover each other.
const MOST_NUMBERS: usize = 24;

/// Which points are drawn, what they are grouped by and what the error is called.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PictureOf {
    /// Frontier.
    pub frontier: &'static str,
    /// Name of the error's axis.
    pub error: &'static str,
}

/// The pictures there are.
pub(crate) const PICTURES: [PictureOf; 3] = [
    PictureOf { frontier: "discretisation", error: "error of S and R together" },
    PictureOf { frontier: "solver", error: "error of the coefficients" },
    PictureOf { frontier: "interval", error: "error of the ends / half width" },
];

/// Draws one frontier as SVG or, with `png`, as PNG. `false`: there is nothing to draw.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_picture(
    document: &FrontierDocument,
    which: PictureOf,
    png: bool,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let drawing = draw(document, which);
    if png { drawing.write_png(out) } else { drawing.write_svg(out) }
}

/// Whether this frontier has points.
pub(crate) fn has_picture(document: &FrontierDocument, which: PictureOf) -> bool {
    document.points.iter().any(|record| record.frontier == which.frontier && place(record).is_some())
}

/// Time and error of a record.
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

fn draw(document: &FrontierDocument, which: PictureOf) -> Drawing {
    let all: Vec<&FrontierRecord> =
        document.points.iter().filter(|record| record.frontier == which.frontier && place(record).is_some()).collect();
    let mut groups: Vec<String> = all.iter().map(|record| group(record)).collect();
    groups.sort();
    groups.dedup();
    let mut numbered: Vec<&FrontierRecord> = all.iter().filter(|record| record.on_frontier).copied().collect();
    let time = |record: &FrontierRecord| record.seconds.map_or(f64::INFINITY, |time| time.median);
    numbered.sort_by(|a, b| time(a).total_cmp(&time(b)));
    numbered.truncate(MOST_NUMBERS);
    let counted = all.iter().any(|record| record.instructions.is_some());
    let panels = if counted { 2.0 } else { 1.0 };
    let rows = numbered.len().div_ceil(2) as f64 + groups.len().div_ceil(5) as f64;
    let mut drawing = Drawing::new((panels * PANEL[0]).max(2.0 * PANEL[0]), 40.0 + PANEL[1] + LINE * (rows + 3.0));
    let title = format!("{}: {}, {} points", document.scene, which.frontier, all.len());
    drawing.word([14.0, 18.0], title, 15.0, Anchor::Start);
    let points = Points { all, numbered, groups, which };
    points.panel(&mut drawing, 0.0, "seconds on one thread", |record| {
        record.seconds.map(|time| [time.median, time.lo, time.hi])
    });
    if counted {
        points
            .panel(&mut drawing, PANEL[0], "instructions", |record| record.instructions.map(|count| [count as f64; 3]));
    }
    points.key(&mut drawing, 40.0 + PANEL[1] + LINE);
    drawing
}

/// What both panels and the key are about.
struct Points<'a> {
    all: Vec<&'a FrontierRecord>,
    /// Those on the frontier, from the cheapest on.
    numbered: Vec<&'a FrontierRecord>,
    /// Names of the kinds of markers.
    groups: Vec<String>,
    which: PictureOf,
}

impl Points<'_> {
    /// The frontier over one kind of cost: median and both ends of its interval.
    fn panel(&self, drawing: &mut Drawing, left: f64, name: &str, cost: impl Fn(&FrontierRecord) -> Option<[f64; 3]>) {
        let Points { all, numbered, groups, which } = self;
        let costs: Vec<f64> = all.iter().filter_map(|record| cost(record)).flat_map(|c| c.to_vec()).collect();
        let errors = all.iter().filter_map(|record| place(record).map(|at| at[1]));
        let bars = numbered.iter().filter_map(|record| record.error_interval).flatten().map(|end| end.max(ROUNDING));
        let (Some(x), Some(y)) = (Axis::over(costs.into_iter()), Axis::over(errors.chain(bars))) else { return };
        let mut panel = Panel::new([left + 74.0, 44.0], [PANEL[0] - 96.0, PANEL[1] - 60.0], x, y);
        panel.frame(drawing, name, which.error);
        let at = |record: &FrontierRecord| Some([cost(record)?[0], place(record)?[1]]);
        for record in all.iter().filter(|record| !numbered.iter().any(|n| std::ptr::eq(*n, **record))) {
            let Some(place) = at(record) else { continue };
            let kind = groups.iter().position(|name| *name == group(record)).unwrap_or(0);
            marker(drawing, panel.place(place), kind, 2.6, true);
        }
        // of a solver each case has a frontier of its own, and a line through all would mean nothing
        if which.frontier != "solver" {
            let mut stairs: Vec<[f64; 2]> = numbered.iter().filter_map(|record| at(record)).collect();
            stairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
            panel.stairs(drawing, &stairs, GREY);
        }
        for record in numbered {
            let (Some(place), Some([_, lo, hi])) = (at(record), cost(record)) else { continue };
            let ends = record.error_interval.unwrap_or([place[1]; 2]).map(|end| end.max(ROUNDING));
            panel.bars(drawing, place, [lo, hi], ends, GREY);
        }
        for record in numbered {
            let Some(place) = at(record) else { continue };
            let kind = groups.iter().position(|name| *name == group(record)).unwrap_or(0);
            marker(drawing, panel.place(place), kind, 5.0, false);
            panel.taken(place, 6.0);
        }
        for (number, record) in numbered.iter().enumerate() {
            if let Some(place) = at(record) {
                panel.number(drawing, place, &(number + 1).to_string());
            }
        }
    }

    /// Groups with their markers, and what the numbers mean.
    fn key(&self, drawing: &mut Drawing, top: f64) {
        let Points { numbered, groups, which, .. } = self;
        let width = drawing.size[0];
        for (k, name) in groups.iter().enumerate() {
            let at = [24.0 + (width - 40.0) / 5.0 * (k % 5) as f64, top + LINE * (k / 5) as f64];
            marker(drawing, at, k, 5.0, false);
            drawing.word([at[0] + 10.0, at[1]], name, 11.0, Anchor::Start);
        }
        let top = top + LINE * (groups.len().div_ceil(5) as f64 + 0.5);
        let rows = numbered.len().div_ceil(2);
        let column = 0.5 * (width - 28.0);
        for (k, record) in numbered.iter().enumerate() {
            let at = [14.0 + column * (k / rows.max(1)) as f64, top + LINE * (k % rows.max(1)) as f64];
            let name = if which.frontier == "solver" {
                format!("{}: {}", record.case, record.label)
            } else {
                record.label.clone()
            };
            let mut text = format!("{} {name}", k + 1);
            while width_of(&text, 10.0) > column - 6.0 && text.pop().is_some() {}
            drawing.word(at, text, 10.0, Anchor::Start);
        }
    }
}

/// Circle, square, triangle, diamond, cross, star, pentagon and on from the beginning with other colours.
fn marker(drawing: &mut Drawing, [x, y]: [f64; 2], kind: usize, radius: f64, faint: bool) {
    let colour = COLOURS[kind % COLOURS.len()];
    let fill = if faint { colour.map(|c| c / 2 + 127) } else { colour };
    let rim = if faint { fill } else { [0; 3] };
    let around = |corners: usize, turn: f64, inner: f64| -> Vec<[f64; 2]> {
        let angle = |k: usize| std::f64::consts::TAU * (k as f64 + turn) / corners as f64;
        let reach = |k: usize| if k % 2 == 1 { radius * inner } else { radius };
        (0..corners).map(|k| [x + reach(k) * angle(k).sin(), y - reach(k) * angle(k).cos()]).collect()
    };
    let points = match kind % 7 {
        0 => around(16, 0.0, 1.0),
        1 => around(4, 0.5, 1.0),
        2 => around(3, 0.0, 1.0),
        3 => around(4, 0.0, 1.0),
        4 => around(8, 0.5, 0.4),
        5 => around(10, 0.0, 0.45),
        _ => around(3, 1.5, 1.0),
    };
    drawing.area(&points, fill, rim);
}
