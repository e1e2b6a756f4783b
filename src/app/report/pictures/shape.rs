//! `shape`: S and R over the patch, and their standard uncertainties below where they are known point by point.
//!
//! ```text
//! S    blue (cup) - pale (saddle) - red (cap), the borders of the classes as lines, fading to grey where R is small
//! R    viridis, from 0 to the largest, a line at every number of the scale          u(S), u(R)    likewise, from 0
//! ```
//!
//! The maps are pixels, linear between the points of the grid; outline, lines, contacts and words are drawn. Cells drawn one
//! by one would make 0.4 to 1.7 MB.

use crate::report::charts::{Axis, BLACK, Frame, GREY, MIDDLE, frame};
use crate::report::colour::{Colour, DIVERGING, FADE, FAINT, VIRIDIS, along, mix};
use crate::report::drawing::{Anchor, Drawing};
use crate::report::png::Raster;
use crate::report::surface_view::{ContactsView, SurfaceView};

use super::contour::contours;
use super::dots::{evenly, radius};
use super::scale::{LARGE, fitting, foot, number_bar, picture, shape_bar, with_unit};

/// Sides of a map: its width, and the most that its height may be.
const SIDE: f64 = 142.0;
const TALLEST: f64 = 230.0;
/// Least height of a row: the scale of S has nine names.
const LEAST_HEIGHT: f64 = 118.0;
/// Left edges of the two columns.
const COLUMNS: [f64; 2] = [46.0, 290.0];
/// Pixels of a map along its longer side: with four maps a picture stays below 200 kB.
const PIXELS: f64 = 160.0;
/// Colours of a scale: steps of 1 % are not seen.
const COLOURS: f64 = 100.0;
/// Dots of a panel: some 30 bytes each in a PNG.
const MOST_DOTS: usize = 1_000;
/// Pieces of lines of one map: where S is rounding its lines would cover the map.
const MOST_PIECES: usize = 3_000;
/// Radius of a dot that has room, pixels, and how many dots get a pale rim, which doubles them.
const LARGEST_DOT: f64 = 1.7;
const RIMMED: usize = 400;
/// Part of a map's side up to which contacts beyond its edge are drawn.
const MARGIN: f64 = 0.05;
/// Where nothing is known.
const UNKNOWN: Colour = [232; 3];

/// One map.
struct Map<'a> {
    caption: String,
    values: &'a [f64],
    colour: Box<dyn Fn(f64, f64) -> Colour + 'a>,
    /// Ends of the scale; none of S.
    ends: Option<[f64; 2]>,
}

/// Draws the maps.
pub(super) fn shape(view: &SurfaceView, title: &str, unit: Option<&str>) -> Drawing {
    let maps = maps(view, unit);
    let [width, height] = sides(view);
    let row = height.max(LEAST_HEIGHT) + 62.0;
    let rows = maps.len().div_ceil(2);
    let mut drawing = picture(32.0 + row * rows as f64);
    drawing.word([8.0, 14.0], fitting(title, 70), LARGE, Anchor::Start);
    let mut words = Vec::new();
    for (k, map) in maps.iter().enumerate() {
        let (left, top) = (COLUMNS[k % 2], 48.0 + row * (k / 2) as f64);
        let panel = Panel::new(view, [left, top], [width, height]);
        drawing.word([left, top - 10.0], map.caption.as_str(), MIDDLE, Anchor::Start);
        drawing.image([left, top], [width, height], panel.raster(map));
        panel.outline(&mut drawing);
        let names = view.axes.map(|name| with_unit(name, unit, 1));
        let second = if k % 2 == 0 { names[1].as_str() } else { "" };
        let bar = [left + width + 8.0, top];
        let levels = match map.ends {
            None => {
                shape_bar(&mut drawing, bar, height.max(LEAST_HEIGHT));
                (0..8).map(|k| 0.25 * f64::from(k) - 0.875).collect()
            }
            Some(ends) => number_bar(&mut drawing, bar, height.max(LEAST_HEIGHT), ends, &VIRIDIS),
        };
        panel.levels(&mut drawing, map, &levels);
        if let Some(contacts) = view.contacts.as_ref().filter(|_| k < 2) {
            words = panel.contacts(&mut drawing, contacts);
        }
        let most = [(width / 26.0) as usize, 5];
        let around = Frame { names: [&names[0], second], most, numbers: k % 2 == 0, room: left };
        frame(&mut drawing, &panel.x, &panel.y, &around);
    }
    if view.curvedness.iter().any(|r| r.is_nan()) {
        words.push("grey: not surrounded by contacts".into());
    }
    if view.axes == ["u", "v"] {
        words.push("u, v: the patch's own two directions".into());
    }
    if view.flat.is_some() {
        words.push("S is undefined: the patch is flat".into());
    }
    if rows > 1 {
        let which = if view.flat.is_some() { "u(R)" } else { "u(S), u(R)" };
        words.push(format!("{which}: {}", view.uncertainty_words));
    }
    foot(&mut drawing, &words);
    drawing
}

fn maps<'a>(view: &'a SurfaceView, unit: Option<&str>) -> Vec<Map<'a>> {
    let largest = |values: &[f64]| values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    let largest_r = largest(&view.curvedness);
    let faded = move |s: f64, r: f64| {
        let strength = if largest_r > 0.0 && r.is_finite() { (r / (FADE * largest_r)).min(1.0) } else { 0.0 };
        mix(FAINT, along(&DIVERGING, stepped(0.5 * (s + 1.0))), stepped(strength))
    };
    let numbers = |caption: String, values: &'a [f64], most: Option<f64>| {
        let most = most.unwrap_or(largest(values));
        // of a plane, or of numbers without noise, nothing is left but zero
        let most = if most > 0.0 { most } else { 1.0 };
        let colour = Box::new(move |v: f64, _| along(&VIRIDIS, stepped(v / most)));
        Map { caption, values, colour, ends: Some([0.0, most]) }
    };
    let mut maps = vec![
        Map { caption: "S, shape index".into(), values: &view.shape_index, colour: Box::new(faded), ends: None },
        numbers(with_unit("R, curvedness", unit, -1), &view.curvedness, view.flat),
    ];
    if let Some([s, r]) = &view.uncertainty {
        if view.flat.is_none() {
            maps.push(numbers("u(S), standard uncertainty".into(), s, None));
        }
        maps.push(numbers(with_unit("u(R)", unit, -1), r, None));
    }
    maps
}

/// The nearest of the colours that are used: areas of one colour are stored in a few bytes.
fn stepped(t: f64) -> f64 {
    (t * COLOURS).round() / COLOURS
}

/// Width and height of every map: to scale, but for slivers.
fn sides(view: &SurfaceView) -> [f64; 2] {
    let span = |k: usize| match (view.places[k].first(), view.places[k].last()) {
        (Some(lo), Some(hi)) if hi > lo => hi - lo,
        _ => 1.0,
    };
    let scale = (SIDE / span(0)).min(TALLEST / span(1));
    [0, 1].map(|k| (scale * span(k)).max(0.25 * SIDE))
}

/// One map's place in the picture.
struct Panel<'a> {
    view: &'a SurfaceView,
    size: [usize; 2],
    x: Axis,
    y: Axis,
}

impl<'a> Panel<'a> {
    fn new(view: &'a SurfaceView, [left, top]: [f64; 2], [width, height]: [f64; 2]) -> Panel<'a> {
        let ends = |places: &[f64]| match (places.first(), places.last()) {
            (Some(lo), Some(hi)) if hi > lo => [*lo, *hi],
            (Some(lo), _) => [lo - 0.5, lo + 0.5],
            _ => [0.0, 1.0],
        };
        let [[x0, x1], [y0, y1]] = [ends(&view.places[0]), ends(&view.places[1])];
        Panel {
            view,
            size: [view.places[0].len(), view.places[1].len()],
            x: Axis::linear([x0, x1], [left, left + width]),
            y: Axis::linear([y0, y1], [top + height, top]),
        }
    }

    /// The map in pixels, linear between the grid's points.
    fn raster(&self, map: &Map) -> Raster {
        let [width, height] = [self.x.to - self.x.from, self.y.from - self.y.to];
        let scale = PIXELS / width.max(height);
        let [columns, rows] = [width, height].map(|side| (scale * side).round().max(2.0) as usize);
        let share = |k: usize, count: usize| (k as f64 + 0.5) / count as f64;
        let mut rgb = Vec::with_capacity(3 * columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let at = [share(column, columns), 1.0 - share(row, rows)];
                let value = known_between(map.values, self.size, at);
                // of a flat patch S says nothing, which is not that nothing is known there, nor that it is a saddle
                let flat = self.view.flat.is_some() && map.ends.is_none();
                let colour = value.map_or(if flat { FAINT } else { UNKNOWN }, |value| {
                    let r = known_between(&self.view.curvedness, self.size, at).unwrap_or(f64::NAN);
                    (map.colour)(value, r)
                });
                rgb.extend(colour);
            }
        }
        Raster { width: columns, height: rows, rgb }
    }

    /// Pixels of a place of the grid.
    fn pixel(&self, [i, j]: [f64; 2]) -> [f64; 2] {
        let share = |t: f64, count: usize| t / (count.max(2) - 1) as f64;
        let (s, t) = (share(i, self.size[0]), share(j, self.size[1]));
        [self.x.from + s * (self.x.to - self.x.from), self.y.from + t * (self.y.to - self.y.from)]
    }

    fn lines(&self, drawing: &mut Drawing, values: &[f64], levels: &[f64], width: f64, colour: Colour) {
        let lines: Vec<Vec<[f64; 2]>> = levels.iter().flat_map(|level| contours(values, self.size, *level)).collect();
        if lines.iter().map(Vec::len).sum::<usize>() > MOST_PIECES {
            return;
        }
        for line in lines {
            let line: Vec<[f64; 2]> = line.into_iter().map(|place| self.pixel(place)).collect();
            drawing.line(&line, width, colour);
        }
    }

    /// Where support ends.
    fn outline(&self, drawing: &mut Drawing) {
        let known: Vec<f64> = self.view.curvedness.iter().map(|r| if r.is_nan() { 0.0 } else { 1.0 }).collect();
        self.lines(drawing, &known, &[0.5], 1.0, GREY);
    }

    fn levels(&self, drawing: &mut Drawing, map: &Map, levels: &[f64]) {
        // lines of the noise of rounding would be drawn where all values are alike
        let finite = || map.values.iter().copied().filter(|v| v.is_finite());
        let (lo, hi) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if hi - lo > 1e-3 * lo.abs().max(hi.abs()) {
            let colour = if map.ends.is_none() { [60; 3] } else { [245; 3] };
            self.lines(drawing, map.values, levels, 0.6, colour);
        }
    }

    /// Dots at the contacts, and what the foot says of them.
    fn contacts(&self, drawing: &mut Drawing, contacts: &ContactsView) -> Vec<String> {
        let chosen = evenly(&contacts.places, MOST_DOTS);
        let mut words = match chosen.len() {
            held if held < contacts.all => format!("{held} of {} contacts, evenly chosen", contacts.all),
            all => format!("all {all} contacts"),
        };
        // feet of contacts at the rim lie a little beyond it; the margins of the panel have room for them
        let near = |axis: &Axis, v: f64| (-MARGIN..=1.0 + MARGIN).contains(&((v - axis.lo) / (axis.hi - axis.lo)));
        let inside = |[x, y]: &[f64; 2]| near(&self.x, *x) && near(&self.y, *y);
        let pixels = |out: bool| -> Vec<[f64; 2]> {
            let some = chosen.iter().filter(|k| contacts.left_out[**k] == out).map(|k| contacts.places[*k]);
            some.filter(inside).map(|[x, y]| [self.x.at(x), self.y.at(y)]).collect()
        };
        let (dots, crosses) = (pixels(false), pixels(true));
        if chosen.len() == contacts.all && dots.len() + crosses.len() < contacts.all {
            words =
                format!("{} of {} contacts, the others lie beyond the map", dots.len() + crosses.len(), contacts.all);
        }
        let size = radius(&dots, LARGEST_DOT);
        if size == LARGEST_DOT && dots.len() <= RIMMED {
            drawing.dots(dots.clone(), size + 0.9, [255; 3]);
        }
        drawing.dots(dots, size, BLACK);
        for [x, y] in &crosses {
            drawing.line(&[[x - 2.5, y - 2.5], [x + 2.5, y + 2.5]], 1.0, [200, 0, 120]);
            drawing.line(&[[x - 2.5, y + 2.5], [x + 2.5, y - 2.5]], 1.0, [200, 0, 120]);
        }
        let mut list = vec![format!("dots: {words}")];
        if contacts.left_out.iter().any(|out| *out) {
            list.push("crosses: left out".into());
        }
        list
    }
}

/// Values of a grid between its points, from those that are known; `None` where these weigh less than half.
fn known_between(values: &[f64], [n, m]: [usize; 2], at: [f64; 2]) -> Option<f64> {
    let cell = |t: f64, count: usize| {
        let place = t.clamp(0.0, 1.0) * (count.max(1) - 1) as f64;
        let below = (place as usize).min(count.saturating_sub(2));
        (below, (below + 1).min(count.max(1) - 1), place - below as f64)
    };
    let ((i, next_i, s), (j, next_j, t)) = (cell(at[0], n), cell(at[1], m));
    let corners = [
        (i, j, (1.0 - s) * (1.0 - t)),
        (i, next_j, (1.0 - s) * t),
        (next_i, j, s * (1.0 - t)),
        (next_i, next_j, s * t),
    ];
    let (mut sum, mut weight) = (0.0, 0.0);
    for (i, j, part) in corners {
        let value = values.get(i * m + j).copied().filter(|v| v.is_finite());
        if let Some(value) = value {
            sum += part * value;
            weight += part;
        }
    }
    (weight >= 0.5).then(|| sum / weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::drawing::Shape;

    #[test]
    fn colours_stand_where_their_values_are() {
        // S runs from -1 to 1 along the first direction, R is 2 where the second one is above its middle, else unknown
        let (n, m) = (5, 5);
        let at = |k: usize, s: &dyn Fn(f64, f64) -> f64| s((k / m) as f64 / 4.0, (k % m) as f64 / 4.0);
        let places: Vec<f64> = (0..5).map(|k| f64::from(k) / 4.0).collect();
        let view = SurfaceView {
            axes: ["x", "y"],
            places: [places.clone(), places],
            shape_index: (0..n * m).map(|k| at(k, &|x, y| if y < 0.4 { f64::NAN } else { 2.0 * x - 1.0 })).collect(),
            curvedness: (0..n * m).map(|k| at(k, &|_, y| if y < 0.4 { f64::NAN } else { 2.0 })).collect(),
            ..SurfaceView::default()
        };
        let drawing = shape(&view, "", None);
        let images = drawing.shapes.iter().filter_map(|shape| match shape {
            Shape::Image { raster, .. } if raster.width > 1 => Some(raster),
            _ => None,
        });
        let images: Vec<&Raster> = images.collect();
        let pixel = |image: &Raster, x: f64, y: f64| -> Colour {
            let (column, row) = ((x * image.width as f64) as usize, ((1.0 - y) * image.height as f64) as usize);
            let at = 3 * (row * image.width + column);
            [image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]]
        };
        let near = |a: Colour, b: Colour| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) < 12);
        assert_eq!(images.len(), 2);
        for (x, stop) in [(0.0, 0), (0.5, 3), (0.999, 6)] {
            assert!(near(pixel(images[0], x, 0.8), DIVERGING[stop]), "{x}: {:?}", pixel(images[0], x, 0.8));
            assert_eq!(pixel(images[1], x, 0.8), VIRIDIS[9]);
            assert_eq!(pixel(images[0], x, 0.1), UNKNOWN);
        }
    }
}
