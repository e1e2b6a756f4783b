//! The surface in perspective as SVG: what is seen until the turning view starts, and without WebGL or JavaScript.
//!
//! ```text
//! p = point - middle of the box        w = D - p.e        (x, y) = (p.r, p.u) / (w tan 15 deg)        D = 2.2 diagonals
//! ```
//!
//! `e` points to the eye, `r` across, `u` up. The turning view (`assets/stage.js`) begins with the same eye, box and margin,
//! so that it takes the picture's place without a jump. The farthest faces are drawn first.

use std::fmt::Write as _;

use crate::report::surface_view::{SurfaceView, Vector};
use crate::vector::{cross, dot, minus, unit};

use super::super::colour::{FAINT, Field, hex, mix};
use super::html::text;

/// Faces along each direction, a multiple of [`LINES`]; more would take a browser without graphics longer to draw.
const FACES: usize = 20;
/// Lines on the surface along each direction, as the turning view has them.
const LINES: usize = 10;
/// Contacts that are drawn.
const DOTS: usize = 400;
/// Where the eye stands: front, left, above.
const EYE: Vector = [-0.47, -0.7, 0.54];
/// Its distance in diagonals of the box.
const AWAY: f64 = 2.2;
/// Half of the picture's height at distance 1: the tangent of 15 degrees.
const OPENING: f64 = 0.267_949_192_431_122_7;
/// Part of the picture that the box may fill.
const FILLED: f64 = 0.86;
/// Units of the viewing box along its longer side: half a pixel of a wide screen.
const SIDE: f64 = 2000.0;

/// The eye, and the box that it looks at.
struct Eye {
    low: Vector,
    high: Vector,
    distance: f64,
    /// Across, up, towards the eye.
    axes: [Vector; 3],
}

impl Eye {
    fn new(points: &[Vector]) -> Eye {
        let ends = [0, 1, 2].map(|k| {
            let finite = points.iter().map(|p| p[k]).filter(|v| v.is_finite());
            let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            if lo <= hi { (lo, hi) } else { (0.0, 0.0) }
        });
        let (low, high) = (ends.map(|(lo, _)| lo), ends.map(|(_, hi)| hi));
        let diagonal = dot(minus(high, low), minus(high, low)).sqrt();
        let towards = unit(EYE);
        let across = unit(cross([0.0, 0.0, 1.0], towards));
        let distance = AWAY * dot(EYE, EYE).sqrt() * if diagonal > 0.0 { diagonal } else { 1.0 };
        Eye { low, high, distance, axes: [across, cross(towards, across), towards] }
    }

    /// Across, up, and towards the eye, in lengths.
    fn turned(&self, p: Vector) -> Vector {
        let p = [0, 1, 2].map(|k| p[k] - 0.5 * (self.low[k] + self.high[k]));
        self.axes.map(|axis| dot(p, axis))
    }

    /// Where a point is seen; the picture is 2 high for a camera of 30 degrees.
    fn seen(&self, p: Vector) -> [f64; 2] {
        let [x, y, near] = self.turned(p);
        let scale = OPENING * (self.distance - near);
        [x / scale, y / scale]
    }

    fn corner(&self, bits: usize) -> Vector {
        [0, 1, 2].map(|k| if bits >> k & 1 == 1 { self.high[k] } else { self.low[k] })
    }

    /// How far the box reaches across and up.
    fn reach(&self) -> [f64; 2] {
        let seen = (0..8).map(|bits| self.seen(self.corner(bits)));
        seen.fold([1e-12_f64; 2], |most, p| [0, 1].map(|k| most[k].max(p[k].abs())))
    }

    /// Edges of the box behind the surface (which end at the corner farthest away), or the others.
    fn edges(&self, behind: bool) -> Vec<[Vector; 2]> {
        let far = (0..8).min_by(|a, b| {
            let near = |bits: usize| self.turned(self.corner(bits))[2];
            near(*a).total_cmp(&near(*b))
        });
        let pairs = (0..8_usize).flat_map(|bits| [1, 2, 4].map(|axis| (bits, bits | axis)));
        let chosen = pairs.filter(|(a, b)| a != b && (Some(*a) == far || Some(*b) == far) == behind);
        chosen.map(|(a, b)| [self.corner(a), self.corner(b)]).collect()
    }
}

/// How bright a face is: light falls from beside the viewer, on either side of the surface.
fn light([a, b, c, d]: [Vector; 4]) -> f64 {
    let normal = unit(cross(minus(c, a), minus(d, b)));
    let along = dot(normal, unit([0.25, 0.45, 1.0])).abs();
    if along.is_finite() { 0.42 + 0.58 * along.min(1.0) } else { 1.0 }
}

/// Points along one direction that are joined by faces: the first and the last among them.
fn chosen(count: usize, closed: bool) -> Vec<usize> {
    let faces = FACES.min(count.max(2) - 1);
    // rounded as the turning view rounds, whose lines lie between the same points
    let mut all: Vec<usize> = (0..=faces).map(|k| (2 * k * (count - 1) + faces) / (2 * faces)).collect();
    if closed {
        all.push(0);
    }
    all
}

/// The picture; empty where there is no mesh.
pub(super) fn picture(view: &SurfaceView, field: &Field) -> String {
    let [n, m] = [view.places[0].len(), view.places[1].len()];
    if n < 2 || m < 2 {
        return String::new();
    }
    let eye = Eye::new(&view.points);
    let reach = eye.reach();
    let scale = 0.5 * FILLED * SIDE / reach[0].max(reach[1]);
    let [width, height] = reach.map(|reach| 2.0 * scale * reach / FILLED);
    let place = |p: Vector| {
        let [x, y] = eye.seen(p);
        format!("{:.0} {:.0}", 0.5 * width + scale * x, 0.5 * height - scale * y)
    };
    let label = text(&format!("The surface in perspective, coloured by {}", field.name));
    let mut out = format!(
        "<svg class=\"perspective\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"{label}\">\n"
    );
    edges(&eye.edges(true), &place, &mut out);
    faces(view, field, &eye, &place, &mut out);
    edges(&eye.edges(false), &place, &mut out);
    dots(view, &place, &mut out);
    out.push_str("</svg>\n");
    out
}

fn edges(all: &[[Vector; 2]], place: &dyn Fn(Vector) -> String, out: &mut String) {
    let path: String = all.iter().map(|[a, b]| format!("M{}L{}", place(*a), place(*b))).collect();
    let _ = writeln!(out, "<path class=\"box\" d=\"{path}\"/>");
}

/// One face: its corners, the point that colours it, its place among the faces.
struct Face {
    near: f64,
    corners: [usize; 4],
    middle: usize,
    at: [usize; 2],
}

/// Faces from the farthest to the nearest, and how many there are along both directions.
fn faces_of(view: &SurfaceView, turned: &[Vector]) -> (Vec<Face>, [usize; 2]) {
    let m = view.places[1].len();
    let [i, j] = [0, 1].map(|k| chosen(view.places[k].len(), view.closed[k]));
    let mut faces = Vec::new();
    for (k, a) in i.windows(2).enumerate() {
        for (l, b) in j.windows(2).enumerate() {
            let corners = [a[0] * m + b[0], a[1] * m + b[0], a[1] * m + b[1], a[0] * m + b[1]];
            let near = corners.iter().map(|c| turned[*c][2]).sum();
            // the last face of a closed direction ends where the first begins
            let middle = (a[0] + a[1].max(a[0])) / 2 * m + (b[0] + b[1].max(b[0])) / 2;
            faces.push(Face { near, corners, middle, at: [k, l] });
        }
    }
    faces.sort_by(|a, b| a.near.total_cmp(&b.near));
    (faces, [i.len() - 1, j.len() - 1])
}

fn faces(view: &SurfaceView, field: &Field, eye: &Eye, place: &dyn Fn(Vector) -> String, out: &mut String) {
    let turned: Vec<Vector> = view.points.iter().map(|p| eye.turned(*p)).collect();
    let (faces, [n, m]) = faces_of(view, &turned);
    let every = [n, m].map(|count| (count / LINES).max(1));
    let mut drawn = vec![false; n * m];
    for Face { corners, middle, at: [k, l], .. } in faces {
        drawn[k * m + l] = true;
        let light = light(corners.map(|c| turned[c]));
        let [a, b, c, d] = corners.map(|c| place(view.points[c]));
        let (colour, class) = field.colour(middle).map_or((FAINT, " class=\"none\""), |colour| (colour, ""));
        let fill = hex(mix([0; 3], colour, light));
        let _ = writeln!(out, "<path{class} d=\"M{a}L{b} {c} {d}z\" fill=\"{fill}\"/>");
        // a line between two faces is drawn after both, or the second would hide half of it
        let done = |i: usize, j: usize| i >= n || j >= m || drawn[i * m + j];
        let edges = [
            (k, every[0], done(k.wrapping_sub(1), l), [&a, &d]),
            (k + 1, every[0], done(k + 1, l), [&b, &c]),
            (l, every[1], done(k, l.wrapping_sub(1)), [&a, &b]),
            (l + 1, every[1], done(k, l + 1), [&d, &c]),
        ];
        let lines = edges.iter().filter(|(number, every, last, _)| number % every == 0 && *last);
        let path: String = lines.map(|(.., [from, to])| format!("M{from}L{to}")).collect();
        if !path.is_empty() {
            let _ = writeln!(out, "<path class=\"line\" d=\"{path}\"/>");
        }
    }
}

fn dots(view: &SurfaceView, place: &dyn Fn(Vector) -> String, out: &mut String) {
    let Some(contacts) = &view.contacts else { return };
    let step = contacts.points.len().div_ceil(DOTS).max(1);
    let path: String = contacts.points.iter().step_by(step).map(|p| format!("M{}h0", place(*p))).collect();
    let size = if contacts.points.len() < DOTS { "few" } else { "many" };
    let _ = writeln!(out, "<path class=\"rim {size}\" d=\"{path}\"/><path class=\"dot {size}\" d=\"{path}\"/>");
}
