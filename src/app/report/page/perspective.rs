//! The surface in perspective as SVG: what is seen until the turning view starts, and without WebGL or JavaScript. The
//! farthest faces are drawn first.

use std::fmt::Write as _;

use crate::report::surface_view::{SurfaceView, Vector};
use palpate_numeric::vector::{cross, dot, minus, unit};

use super::super::colour::{FAINT, Field, hex, mix};
use super::camera::{Camera, Canvas};

/// Faces along each direction, a multiple of [`LINES`]; more would take a browser without graphics longer to draw.
const FACES: usize = 20;
/// Lines on the surface along each direction, as the turning view has them.
const LINES: usize = 10;
/// Contacts that are drawn.
const DOTS: usize = 400;

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
    let camera = Camera::new(&view.points);
    let canvas = camera.canvas();
    let mut out = canvas.begin(&format!("The surface in perspective, coloured by {}", field.name));
    out.push_str(&canvas.edges(&camera, true));
    faces(view, field, (&camera, &canvas), &mut out);
    out.push_str(&canvas.edges(&camera, false));
    dots(view, (&camera, &canvas), &mut out);
    out.push_str("</svg>\n");
    out
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

fn faces(view: &SurfaceView, field: &Field, (camera, canvas): (&Camera, &Canvas), out: &mut String) {
    let turned: Vec<Vector> = view.points.iter().map(|p| camera.turned(*p)).collect();
    let (faces, [n, m]) = faces_of(view, &turned);
    let every = [n, m].map(|count| (count / LINES).max(1));
    let mut drawn = vec![false; n * m];
    for Face { corners, middle, at: [k, l], .. } in faces {
        drawn[k * m + l] = true;
        let light = light(corners.map(|c| turned[c]));
        let [a, b, c, d] = corners.map(|c| canvas.place(camera, view.points[c]));
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

fn dots(view: &SurfaceView, (camera, canvas): (&Camera, &Canvas), out: &mut String) {
    let Some(contacts) = &view.contacts else { return };
    let step = contacts.points.len().div_ceil(DOTS).max(1);
    let path: String =
        contacts.points.iter().step_by(step).map(|p| format!("M{}h0", canvas.place(camera, *p))).collect();
    let size = if contacts.points.len() < DOTS { "few" } else { "many" };
    let _ = writeln!(out, "<path class=\"rim {size}\" d=\"{path}\"/><path class=\"dot {size}\" d=\"{path}\"/>");
}
