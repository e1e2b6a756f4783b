//! S, R and their uncertainties over the patch as figures, each with its scale; the data of the page make them answer a
//! pointer.

use std::fmt::Write as _;

use crate::report::surface_view::SurfaceView;
use palpate_geometry::curvature::ShapeClass;

use super::super::colour::{Field, along, hex};
use super::chart::{even_ticks, shown, tick_words};
use super::html::text;
use super::raster::data_url;

/// Pixels of the viewing box, and of the map along the patch's longer side.
const WIDTH: f64 = 440.0;
const SIDE: f64 = 264.0;
const LEFT: f64 = 52.0;
const TOP: f64 = 10.0;
/// The scale's bar.
const BAR: [f64; 2] = [WIDTH - 112.0, 12.0];
const STEPS: usize = 40;
/// Contacts that are dotted: more would hide the map.
const DOTS: usize = 2000;

/// Where a map lies in the viewing box.
struct Frame {
    /// Left, top, width, height.
    inside: [f64; 4],
    /// Outer edges of the cells along both directions.
    ends: [[f64; 2]; 2],
}

impl Frame {
    fn new(view: &SurfaceView) -> Frame {
        let ends = [0, 1].map(|k| edges(&view.places[k]));
        let [across, up] = ends.map(|[lo, hi]| hi - lo);
        let longer = across.max(up);
        // a sliver would leave no room for its labels
        let [width, height] = [across, up].map(|side| (SIDE * side / longer).max(0.25 * SIDE));
        Frame { inside: [LEFT, TOP, width, height], ends }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, width, height] = self.inside;
        let share = |k: usize, v: f64| (v - self.ends[k][0]) / (self.ends[k][1] - self.ends[k][0]);
        [left + width * share(0, x), top + height * (1.0 - share(1, y))]
    }
}

/// Outer edges of the cells around grid points.
fn edges(axis: &[f64]) -> [f64; 2] {
    match axis {
        [] => [0.0, 1.0],
        [only] => [only - 0.5, only + 0.5],
        [first, second, ..] => {
            let half = 0.5 * (second - first);
            [first - half, axis[axis.len() - 1] + half]
        }
    }
}

/// One map with its caption and the names of its axes; `first` holds the contacts' dots, which the others use again.
///
/// # Errors
/// What the system says of memory.
pub(super) fn figure(
    view: &SurfaceView,
    field: &Field,
    caption: &str,
    names: &[String; 2],
    first: bool,
) -> std::io::Result<String> {
    let frame = Frame::new(view);
    let [left, top, width, height] = frame.inside;
    let ([n, m], tall) = ([view.places[0].len(), view.places[1].len()], height.max(0.6 * SIDE) + TOP + 44.0);
    // rows from the top are y from the largest on
    let picture = data_url(n, m, |i, row| field.colour(i * m + (m - 1 - row)))?;
    let mut out = format!(
        "<figure class=\"map\" data-field=\"{}\"><figcaption>{caption}</figcaption>\n\
         <svg class=\"chart\" viewBox=\"0 0 {WIDTH} {tall:.0}\" role=\"img\" aria-label=\"{}\" tabindex=\"0\" \
         data-inside=\"{left} {top} {width:.2} {height:.2}\">\n\
         <rect class=\"unknown\" x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\"/>\n\
         <image href=\"{picture}\" x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\" preserveAspectRatio=\"none\"/>\n",
        field.key,
        text(&format!("Map of {} over the patch", field.name)),
    );
    dots(view, &frame, first, &mut out);
    axes(names, &frame, &mut out);
    scale(field, tall, &mut out);
    out.push_str("<g class=\"cross\" visibility=\"hidden\"><circle r=\"7\"/><circle r=\"5.5\"/></g></svg></figure>\n");
    Ok(out)
}

fn dots(view: &SurfaceView, frame: &Frame, first: bool, out: &mut String) {
    let Some(contacts) = &view.contacts else { return };
    let size = if contacts.places.len() > 300 { "many" } else { "few" };
    let used = format!(
        "<use href=\"#contact-dots\" class=\"halo {size}\"/><use href=\"#contact-dots\" class=\"dots {size}\"/>\n"
    );
    if !first {
        out.push_str(&used);
        return;
    }
    let step = contacts.places.len().div_ceil(DOTS).max(1);
    let [left, top, width, height] = frame.inside;
    let mut path = String::new();
    for place in contacts.places.iter().step_by(step) {
        let [x, y] = frame.place(*place);
        if (left - 2.0..=left + width + 2.0).contains(&x) && (top - 2.0..=top + height + 2.0).contains(&y) {
            let _ = write!(path, "M{x:.1} {y:.1}h0");
        }
    }
    let _ = writeln!(out, "<defs><path id=\"contact-dots\" d=\"{path}\"/></defs>");
    out.push_str(&used);
}

/// How many of the contacts are dotted, where not all.
pub(super) fn thinned(view: &SurfaceView) -> Option<String> {
    let contacts = view.contacts.as_ref()?;
    let step = contacts.places.len().div_ceil(DOTS).max(1);
    let drawn = contacts.places.len().div_ceil(step);
    (drawn < contacts.all).then(|| format!("Dots: {drawn} of the {} contacts, evenly chosen.", contacts.all))
}

fn axes(names: &[String; 2], frame: &Frame, out: &mut String) {
    let [left, top, width, height] = frame.inside;
    let bottom = top + height;
    let _ =
        writeln!(out, "<rect class=\"frame\" x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\"/>");
    let across = even_ticks(frame.ends[0][0], frame.ends[0][1]);
    for tick in &across {
        let x = frame.place([*tick, 0.0])[0];
        let words = tick_words(*tick, &across);
        let _ = writeln!(
            out,
            "<line class=\"tick\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{bottom:.1}\" y2=\"{:.1}\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{words}</text>",
            bottom + 4.0,
            bottom + 17.0
        );
    }
    let up = even_ticks(frame.ends[1][0], frame.ends[1][1]);
    for tick in &up {
        let y = frame.place([0.0, *tick])[1];
        let words = tick_words(*tick, &up);
        let _ = writeln!(
            out,
            "<line class=\"tick\" x1=\"{:.1}\" x2=\"{left:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{words}</text>",
            left - 4.0,
            left - 7.0,
            y + 4.0
        );
    }
    let _ = writeln!(
        out,
        "<text class=\"name\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
         <text class=\"name\" transform=\"translate(12 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        left + 0.5 * width,
        bottom + 35.0,
        text(&names[0]),
        top + 0.5 * height,
        text(&names[1])
    );
}

/// The colours from end to end, with the classes on the scale of S and numbers on all others.
fn scale(field: &Field, tall: f64, out: &mut String) {
    let ([x, wide], [lo, hi]) = (BAR, field.ends);
    let (top, bottom) = (TOP + 4.0, (tall - 44.0).max(TOP + 120.0));
    let step = (bottom - top) / STEPS as f64;
    for k in 0..STEPS {
        let fill = hex(along(field.stops, (k as f64 + 0.5) / STEPS as f64));
        let y = bottom - (k + 1) as f64 * step;
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"{y:.1}\" width=\"{wide}\" height=\"{:.1}\" fill=\"{fill}\"/>",
            step + 0.5
        );
    }
    let mut label = |value: f64, words: &str| {
        let y = bottom - (value - lo) / (hi - lo) * (bottom - top);
        let _ = writeln!(out, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + wide + 6.0, y + 4.0, text(words));
    };
    if field.key == "S" {
        for (k, class) in ShapeClass::CURVED.into_iter().enumerate() {
            let value = (k as f64 - 4.0) / 4.0;
            let number = if k % 4 == 0 { format!("{value:.0} ") } else { String::new() };
            label(value, &format!("{number}{}", class.name()));
        }
        return;
    }
    let ticks = even_ticks(lo, hi);
    if ticks.len() < 2 {
        [lo, hi].into_iter().for_each(|end| label(end, &shown(end)));
    } else {
        ticks.iter().for_each(|tick| label(*tick, &tick_words(*tick, &ticks)));
    }
}
