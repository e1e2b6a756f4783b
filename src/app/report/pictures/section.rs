//! `section`: the surface along a line of the map through the middle of what contacts support, and what all contacts miss it by.
//!
//! ```text
//! line       p(s) = c + s d        c: the middle of the supported points, d: across the axis of the shape, else the first direction
//! above      (s, height) of a surface over x and y; of one in space the same in the tangent plane at c
//! below      residuals of all contacts at s = (p - c) . d; dark those that the upper panel shows
//! ```

use crate::report::charts::{Axis, Frame, GREY, SMALL, frame};
use crate::report::drawing::{Anchor, Drawing};
use crate::report::surface_view::{ContactsView, SurfaceView, Vector, between};
use crate::report::table::significant;

use super::scale::{LARGE, WIDTH, fitting, foot, picture, thinned, with_unit};

/// Edges of the panels.
const LEFT: f64 = 66.0;
const RIGHT: f64 = WIDTH - 14.0;
const ABOVE: [f64; 2] = [34.0, 204.0];
const BELOW: [f64; 2] = [252.0, 352.0];
/// Points of the line.
const POINTS: usize = 240;
/// Parts of the map's size within which a contact counts as lying at the section, the first that holds [`CONTACTS_OF_BAND`] of them.
const BANDS: [f64; 5] = [0.03, 0.06, 0.12, 0.25, 0.5];
const CONTACTS_OF_BAND: usize = 8;
/// Dots of a panel.
const MOST_DOTS: usize = 2_000;
const BLUE: [u8; 3] = [31, 90, 166];
const ORANGE: [u8; 3] = [200, 82, 0];
const LIGHT: [u8; 3] = [170; 3];

/// A point of a panel; of the section whether contacts support it, of a residual whether its contact lies at the section.
type Place = ([f64; 2], bool);

/// The line of the map, and the plane that it is drawn in.
struct Cut<'a> {
    view: &'a SurfaceView,
    centre: [f64; 2],
    along: [f64; 2],
    /// Base point, and the directions of abscissa and ordinate; none of a surface over x and y.
    plane: Option<[Vector; 3]>,
    words: String,
}

/// Draws the section.
pub(super) fn section(view: &SurfaceView, title: &str, unit: Option<&str>, across_deg: Option<f64>) -> Drawing {
    let mut drawing = picture(394.0);
    drawing.word([8.0, 14.0], fitting(title, 70), LARGE, Anchor::Start);
    let cut = Cut::new(view, across_deg);
    let line = cut.line();
    let contacts = view.contacts.as_ref();
    let band = contacts.map_or(0.0, |contacts| cut.band(contacts));
    let (near, misses) = contacts.map_or_else(Default::default, |contacts| cut.contacts(contacts, band));
    let known = line.iter().map(|(place, _)| *place).chain(near.iter().copied());
    let known: Vec<[f64; 2]> = known.filter(|p| p.iter().all(|v| v.is_finite())).collect();
    // contacts in the corners of the map stand beyond the ends of the line
    let corners = misses.iter().map(|(p, _)| p[0]).filter(|_| cut.plane.is_none());
    let x = spread(known.iter().map(|p| p[0]).chain(corners)).placed(LEFT, RIGHT);
    let y = spread(known.iter().map(|p| p[1])).placed(ABOVE[1], ABOVE[0]);
    let ([x, y], names) = match cut.plane {
        None => ([x, y], ["", "z"]),
        Some(_) => (to_scale(x, y), ["", "along the normal"]),
    };
    let names = names.map(|name| if name.is_empty() { String::new() } else { with_unit(name, unit, 1) });
    let around = Frame { names: [&names[0], &names[1]], most: [7, 6], numbers: true, room: LEFT };
    frame(&mut drawing, &x, &y, &around);
    let (step, _) = thinned(near.len(), MOST_DOTS);
    let shown = near.iter().step_by(step).map(|p| [x.at(p[0]), y.at(p[1])]).collect();
    drawing.dots(shown, if near.len() > 400 { 1.0 } else { 2.2 }, ORANGE);
    draw_line(&mut drawing, &line, &x, &y);
    let mut words = vec![cut.words.clone(), stretched(&x, &y)];
    match contacts {
        Some(contacts) => {
            // on a bent surface the way along it is no tangent
            let along = misses.iter().map(|(p, _)| p[0]);
            let x = if cut.plane.is_none() { x } else { spread(along).placed(LEFT, RIGHT) };
            words.push(residuals(&mut drawing, &x, &misses, band, unit, contacts));
        }
        None => words.push("the contacts are not saved with the surface".into()),
    }
    let along = if cut.plane.is_none() { "along the section" } else { cut.view.axes[usize::from(cut.along[1] == 1.0)] };
    drawing.word([0.5 * (LEFT + RIGHT), BELOW[1] + 27.0], with_unit(along, unit, 1), 12.0, Anchor::Middle);
    foot(&mut drawing, &words);
    drawing
}

/// The two axes with as many pixels a length: the one that has more of them reaches farther.
fn to_scale(mut x: Axis, mut y: Axis) -> [Axis; 2] {
    let pixels = |axis: &Axis| (axis.to - axis.from).abs();
    let scale = (pixels(&x) / (x.hi - x.lo)).min(pixels(&y) / (y.hi - y.lo));
    for axis in [&mut x, &mut y] {
        let (middle, half) = (0.5 * (axis.lo + axis.hi), 0.5 * pixels(axis) / scale);
        (axis.lo, axis.hi) = (middle - half, middle + half);
    }
    [x, y]
}

/// An axis over values, with some room.
fn spread(values: impl Iterator<Item = f64>) -> Axis {
    let finite = values.filter(|v| v.is_finite());
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let (lo, hi) = if lo <= hi { (lo, hi) } else { (-1.0, 1.0) };
    // rounding is not blown up to a relief
    let least = (1e-9 * lo.abs().max(hi.abs())).max(f64::MIN_POSITIVE);
    let room = if hi - lo > least { 0.06 * (hi - lo) } else { 0.5 * lo.abs().max(1.0) };
    Axis::linear([lo - room, hi + room], [0.0, 1.0])
}

/// How much more the ordinate is stretched than the abscissa, in words.
fn stretched(x: &Axis, y: &Axis) -> String {
    let scale = |axis: &Axis| ((axis.to - axis.from) / (axis.hi - axis.lo)).abs();
    let times = scale(y) / scale(x);
    if (times - 1.0).abs() < 0.005 {
        return "heights and lengths to one scale".into();
    }
    format!("heights drawn {} times as large as lengths", significant(times, 2))
}

/// The line: blue where contacts support it, grey elsewhere.
fn draw_line(drawing: &mut Drawing, line: &[Place], x: &Axis, y: &Axis) {
    for piece in line.chunk_by(|a, b| a.1 == b.1) {
        let place = |(p, _): &Place| [x.at(p[0]), y.at(p[1])];
        let points: Vec<[f64; 2]> = piece.iter().filter(|(p, _)| p.iter().all(|v| v.is_finite())).map(place).collect();
        let supported = piece.first().is_some_and(|(_, supported)| *supported);
        drawing.line(&points, if supported { 2.0 } else { 1.0 }, if supported { BLUE } else { LIGHT });
    }
}

/// The lower panel; what the foot says of the contacts.
fn residuals(
    drawing: &mut Drawing,
    x: &Axis,
    misses: &[Place],
    band: f64,
    unit: Option<&str>,
    contacts: &ContactsView,
) -> String {
    let finite: Vec<&Place> = misses.iter().filter(|(p, _)| p.iter().all(|v| v.is_finite())).collect();
    let largest = finite.iter().map(|(p, _)| p[1].abs()).fold(0.0, f64::max);
    let size = x.hi - x.lo;
    let largest = if largest > 1e-12 * size { 1.1 * largest } else { 1e-3 * size };
    let y = Axis::linear([-largest, largest], [BELOW[1], BELOW[0]]);
    drawing.line(&[[x.from, y.at(0.0)], [x.to, y.at(0.0)]], 0.8, GREY);
    let (step, _) = thinned(finite.len(), MOST_DOTS);
    let radius = if finite.len() > 400 { 1.0 } else { 2.2 };
    for (dark, colour) in [(false, LIGHT), (true, ORANGE)] {
        let some = finite.iter().step_by(step).filter(|(p, near)| *near == dark && (x.lo..=x.hi).contains(&p[0]));
        drawing.dots(some.map(|(p, _)| [x.at(p[0]), y.at(p[1])]).collect(), radius, colour);
    }
    // the same abscissa as above: dots beyond it are counted out
    let drawn = finite.iter().step_by(step).filter(|(p, _)| (x.lo..=x.hi).contains(&p[0])).count();
    let name = with_unit("residual", unit, 1);
    frame(drawing, x, &y, &Frame { names: ["", &name], most: [7, 5], numbers: true, room: LEFT });
    drawing.word(
        [x.from, BELOW[0] - 12.0],
        format!("contact minus surface, {}", contacts.measured),
        SMALL,
        Anchor::Start,
    );
    let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
    let shown = if drawn < contacts.all {
        format!("{drawn} of {} contacts", contacts.all)
    } else {
        format!("all {drawn} contacts")
    };
    format!("{shown}, orange within {}{unit}", significant(band, 2))
}

impl<'a> Cut<'a> {
    fn new(view: &'a SurfaceView, across_deg: Option<f64>) -> Cut<'a> {
        let [n, m] = [view.places[0].len(), view.places[1].len()];
        let held: Vec<usize> = (0..n * m).filter(|k| view.curvedness.get(*k).is_some_and(|r| r.is_finite())).collect();
        let all: Vec<usize> = if held.is_empty() { (0..n * m).collect() } else { held };
        let mean = |k: usize| -> f64 {
            let of = |p: &usize| view.places[k][if k == 0 { p / m } else { p % m }];
            all.iter().map(of).sum::<f64>() / all.len().max(1) as f64
        };
        let centre = [mean(0), mean(1)];
        let upright = view.axes == ["x", "y"]
            && view.points.first().zip(view.places[0].first()).is_some_and(|(p, x)| (p[0] - x).abs() <= 1e-9 * x.abs())
            && view.points.last().zip(view.places[1].last()).is_some_and(|(p, y)| (p[1] - y).abs() <= 1e-9 * y.abs());
        let angle = across_deg.filter(|_| upright);
        // a section around a tube shows more than one along it
        let around = !upright && view.closed[1] && !view.closed[0];
        let (sine, cosine) = angle.unwrap_or(0.0).to_radians().sin_cos();
        let along = if around { [0.0, 1.0] } else { [cosine, sine] };
        let words = match angle {
            Some(angle) => format!("section across the shape's axis, {angle:.0}° from x"),
            None if upright => format!("section along {}", view.axes[0]),
            None => format!("section along {}, in the plane of tangent and normal", view.axes[usize::from(around)]),
        };
        let mut cut = Cut { view, centre, along, plane: None, words };
        if !upright {
            cut.plane = cut.tangent_plane();
        }
        cut
    }

    /// A place of the map as parts of its size.
    fn share(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| {
            let [lo, hi] = ends(&self.view.places[k]);
            (place[k] - lo) / (hi - lo)
        })
    }

    /// The surface's point at a place of the map.
    fn point(&self, place: [f64; 2]) -> Vector {
        let size = [self.view.places[0].len(), self.view.places[1].len()];
        let share = self.share(place);
        [0, 1, 2].map(|k| {
            let values: Vec<f64> = self.view.points.iter().map(|p| p[k]).collect();
            between(&values, size, share)
        })
    }

    fn tangent_plane(&self) -> Option<[Vector; 3]> {
        let step =
            1e-3 * (0..2).map(|k| ends(&self.view.places[k])).map(|[lo, hi]| hi - lo).fold(f64::INFINITY, f64::min);
        let moved = |by: f64| self.point([0, 1].map(|k| self.centre[k] + by * self.along[k]));
        let (base, before, behind) = (moved(0.0), moved(-step), moved(step));
        let unit = |v: Vector| {
            let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            (length > 0.0).then(|| v.map(|c| c / length))
        };
        let tangent = unit([0, 1, 2].map(|k| behind[k] - before[k]))?;
        let nearest = |k: usize| {
            let places = &self.view.places[k];
            (0..places.len())
                .min_by(|a, b| (places[*a] - self.centre[k]).abs().total_cmp(&(places[*b] - self.centre[k]).abs()))
        };
        let normal = *self.view.normals.get(nearest(0)? * self.view.places[1].len() + nearest(1)?)?;
        let dot: f64 = (0..3).map(|k| normal[k] * tangent[k]).sum();
        let up = unit([0, 1, 2].map(|k| normal[k] - dot * tangent[k]))?;
        Some([base, tangent, up])
    }

    /// Along the line, and aside of it.
    fn seen(&self, place: [f64; 2]) -> [f64; 2] {
        let [a, b] = [0, 1].map(|k| place[k] - self.centre[k]);
        let [cosine, sine] = self.along;
        [a * cosine + b * sine, b * cosine - a * sine]
    }

    /// Where a point of space is drawn.
    fn flat(&self, point: Vector, s: f64) -> [f64; 2] {
        match &self.plane {
            None => [s, point[2]],
            Some([base, tangent, up]) => {
                let along = |d: &Vector| (0..3).map(|k| (point[k] - base[k]) * d[k]).sum();
                [along(tangent), along(up)]
            }
        }
    }

    /// The section within the map.
    fn line(&self) -> Vec<Place> {
        let (n, m) = (self.view.places[0].len(), self.view.places[1].len());
        if n < 2 || m < 2 {
            return Vec::new();
        }
        let reach = self.reach();
        let at = |k: usize| {
            let s = reach[0] + (reach[1] - reach[0]) * k as f64 / (POINTS - 1) as f64;
            let place = [0, 1].map(|k| self.centre[k] + s * self.along[k]);
            let [i, j] = self.share(place);
            let near = |t: f64, count: usize| (t.clamp(0.0, 1.0) * (count - 1) as f64).round() as usize;
            let known = self.view.curvedness.get(near(i, n) * m + near(j, m)).is_some_and(|r| r.is_finite());
            (self.flat(self.point(place), s), known)
        };
        (0..POINTS).map(at).collect()
    }

    /// How far the line runs within the map, both ways.
    fn reach(&self) -> [f64; 2] {
        let mut reach = [f64::NEG_INFINITY, f64::INFINITY];
        for k in 0..2 {
            let [lo, hi] = ends(&self.view.places[k]);
            if self.along[k].abs() > 1e-9 {
                let both = [lo, hi].map(|end| (end - self.centre[k]) / self.along[k]);
                reach = [reach[0].max(both[0].min(both[1])), reach[1].min(both[0].max(both[1]))];
            }
        }
        reach
    }

    /// Where contacts at the section are drawn; abscissa and residual of all of them, and whether they lie at it.
    fn contacts(&self, contacts: &ContactsView, band: f64) -> (Vec<[f64; 2]>, Vec<Place>) {
        let (mut near, mut misses) = (Vec::new(), Vec::new());
        for (k, place) in contacts.places.iter().enumerate().filter(|(k, _)| !contacts.left_out[*k]) {
            let [s, aside] = self.seen(*place);
            misses.push(([s, contacts.residuals[k]], aside.abs() <= band));
            if aside.abs() <= band {
                near.push(self.flat(contacts.points[k], s));
            }
        }
        (near, misses)
    }

    fn band(&self, contacts: &ContactsView) -> f64 {
        let size = (0..2).map(|k| ends(&self.view.places[k])).map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
        let within = |band: &f64| {
            contacts.places.iter().filter(|place| self.seen(**place)[1].abs() <= *band).count() >= CONTACTS_OF_BAND
        };
        BANDS.iter().map(|part| part * size).find(within).unwrap_or(size)
    }
}

fn ends(places: &[f64]) -> [f64; 2] {
    match (places.first(), places.last()) {
        (Some(lo), Some(hi)) if hi > lo => [*lo, *hi],
        (Some(lo), _) => [*lo, lo + 1.0],
        _ => [0.0, 1.0],
    }
}
