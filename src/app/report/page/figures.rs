//! S, R and their uncertainties over the patch as figures, each with its scale; the data of the page make them answer a
//! pointer.

use std::fmt::Write as _;

use crate::report::charts::{Axis, Frame, frame};
use crate::report::colour::Field;
use crate::report::drawing::Drawing;
use crate::report::pictures::{number_bar, shape_bar};
use crate::report::surface_view::SurfaceView;

use super::html::text;
use super::raster::data_url;

/// Pixels of the viewing box, and of the map along the patch's longer side.
const WIDTH: f64 = 440.0;
const SIDE: f64 = 264.0;
const LEFT: f64 = 52.0;
const TOP: f64 = 10.0;
/// The scale's bar.
const BAR: f64 = WIDTH - 112.0;
/// Contacts that are dotted: more would hide the map.
const DOTS: usize = 2000;

/// Where a map lies in the viewing box.
struct Inside {
    /// Left, top, width, height.
    inside: [f64; 4],
    /// Outer edges of the cells along both directions.
    ends: [[f64; 2]; 2],
}

impl Inside {
    fn new(view: &SurfaceView) -> Inside {
        let ends = [0, 1].map(|k| edges(&view.places[k]));
        let [across, up] = ends.map(|[lo, hi]| hi - lo);
        let longer = across.max(up);
        // a sliver would leave no room for its labels
        let [width, height] = [across, up].map(|side| (SIDE * side / longer).max(0.25 * SIDE));
        Inside { inside: [LEFT, TOP, width, height], ends }
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
    let map = Inside::new(view);
    let [left, top, width, height] = map.inside;
    let ([n, m], tall) = ([view.places[0].len(), view.places[1].len()], height.max(0.6 * SIDE) + TOP + 44.0);
    // rows from the top are y from the largest on
    let picture = data_url(n, m, |i, row| field.colour(i * m + (m - 1 - row)))?;
    let mut around = Drawing::new(WIDTH, tall);
    axes(names, &map, &mut around);
    let (bar, high) = ([BAR, TOP + 4.0], (tall - 48.0 - TOP).max(116.0));
    match field.key {
        "S" => shape_bar(&mut around, bar, high),
        _ => drop(number_bar(&mut around, bar, high, field.ends, field.stops)),
    }
    let mut out = format!(
        "<figure class=\"map\" data-field=\"{}\"><figcaption>{caption}</figcaption>\n\
         <svg class=\"chart\" viewBox=\"0 0 {WIDTH} {tall:.0}\" role=\"img\" aria-label=\"{}\" tabindex=\"0\" \
         data-inside=\"{left} {top} {width:.2} {height:.2}\">\n\
         <rect class=\"unknown\" x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\"/>\n\
         <image href=\"{picture}\" x=\"{left}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height:.1}\" preserveAspectRatio=\"none\"/>\n",
        field.key,
        text(&format!("Map of {} over the patch", field.name)),
    );
    dots(view, &map, first, &mut out);
    out.push_str(&around.elements());
    out.push_str("<g class=\"cross\" visibility=\"hidden\"><circle r=\"7\"/><circle r=\"5.5\"/></g></svg></figure>\n");
    Ok(out)
}

/// Box, numbers and names around the map.
fn axes(names: &[String; 2], map: &Inside, drawing: &mut Drawing) {
    let [left, top, width, height] = map.inside;
    let x = Axis::linear(map.ends[0], [left, left + width]);
    let y = Axis::linear(map.ends[1], [top + height, top]);
    let around = Frame { names: [&names[0], &names[1]], most: [(width / 40.0) as usize, 6], numbers: true, room: LEFT };
    frame(drawing, &x, &y, &around);
}

fn dots(view: &SurfaceView, frame: &Inside, first: bool, out: &mut String) {
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
