//! The surface in perspective as SVG: what is seen until the turning view starts, and without WebGL or JavaScript.
//!
//! ```text
//! (x, y, z) -> (x cos a + y sin a,  z cos e + (y cos a - x sin a) sin e)      a parallel view; the farthest faces first
//! ```

use std::fmt::Write as _;

use crate::report::surface_view::{SurfaceView, Vector};

use super::super::colour::{Field, hex, mix};
use super::html::text;

/// Faces along each direction; more would not be told apart.
const FACES: usize = 26;
/// Contacts that are drawn.
const DOTS: usize = 200;
/// Direction of the view: turned about z, and raised.
const TURN: f64 = -0.6;
const RISE: f64 = 0.6;
const SIZE: [f64; 2] = [600.0, 420.0];

/// Across, up, and towards the viewer.
fn seen(p: Vector) -> [f64; 3] {
    let (across, away) = (p[0] * TURN.cos() + p[1] * TURN.sin(), p[1] * TURN.cos() - p[0] * TURN.sin());
    [across, p[2] * RISE.cos() + away * RISE.sin(), p[2] * RISE.sin() - away * RISE.cos()]
}

/// How bright a face is: light falls from beside the viewer, on either side of the surface.
fn light([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let across = [0, 1, 2].map(|k| c[k] - a[k]);
    let up = [0, 1, 2].map(|k| d[k] - b[k]);
    let normal = [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        across[i] * up[j] - across[j] * up[i]
    });
    let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
    let along = 0.23 * normal[0] + 0.41 * normal[1] + 0.88 * normal[2];
    if length > 0.0 { 0.42 + 0.58 * (along / length).abs().min(1.0) } else { 1.0 }
}

/// Points along one direction that are joined by faces: the first and the last among them.
fn chosen(count: usize, closed: bool) -> Vec<usize> {
    let faces = FACES.min(count.max(2) - 1);
    let mut all: Vec<usize> = (0..=faces).map(|k| k * (count - 1) / faces).collect();
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
    let all: Vec<[f64; 3]> = view.points.iter().map(|p| seen(*p)).collect();
    let place = fitted(&all);
    let ([i, j], mut faces) = ([chosen(n, view.closed[0]), chosen(m, view.closed[1])], Vec::new());
    for a in i.windows(2) {
        for b in j.windows(2) {
            let corners = [a[0] * m + b[0], a[1] * m + b[0], a[1] * m + b[1], a[0] * m + b[1]];
            let depth: f64 = corners.iter().map(|k| all[*k][2]).sum();
            faces.push((depth, corners));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [width, height] = SIZE;
    let label = text(&format!("The surface in perspective, coloured by {}", field.name));
    let mut out =
        format!("<svg class=\"perspective\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{label}\">\n");
    for (_, corners) in faces {
        let points: Vec<String> =
            corners.iter().map(|k| place(all[*k])).map(|[x, y]| format!("{x:.0},{y:.0}")).collect();
        let light = light(corners.map(|k| all[k]));
        let fill = field.colour(corners[0]).map_or("var(--unknown)".into(), |c| hex(mix([0; 3], c, light)));
        let _ = writeln!(out, "<polygon points=\"{}\" fill=\"{fill}\"/>", points.join(" "));
    }
    if let Some(contacts) = &view.contacts {
        let step = contacts.points.len().div_ceil(DOTS).max(1);
        for point in contacts.points.iter().step_by(step) {
            let [x, y] = place(seen(*point));
            let _ = writeln!(out, "<circle cx=\"{x:.0}\" cy=\"{y:.0}\" r=\"3\"/>");
        }
    }
    out.push_str("</svg>\n");
    out
}

/// Where seen points stand in the picture.
fn fitted(all: &[[f64; 3]]) -> impl Fn([f64; 3]) -> [f64; 2] {
    let range =
        |k: usize| all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], p| [lo.min(p[k]), hi.max(p[k])]);
    let ([left, right], [low, high]) = (range(0), range(1));
    let scale = (0.9 * SIZE[0] / (right - left)).min(0.9 * SIZE[1] / (high - low));
    let scale = if scale.is_finite() { scale } else { 1.0 };
    move |p| {
        let middle = [0.5 * (left + right), 0.5 * (low + high)];
        [0.5 * SIZE[0] + scale * (p[0] - middle[0]), 0.5 * SIZE[1] - scale * (p[1] - middle[1])]
    }
}
