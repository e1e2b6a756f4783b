//! `perspective`: the surface in space, coloured by S, with its control net and the contacts.
//!
//! ```text
//! camera at c + d (cos e cos a, cos e sin a, sin e), a = -60 degrees, e = 28 degrees, d = 3 sizes of the scene
//! pieces are drawn from the farthest to the nearest
//! ```
//!
//! The net is that of the spline: lines between neighbouring control points, which the surface follows and does not meet.

use crate::report::charts::{BLACK, GREY, MIDDLE, SMALL};
use crate::report::colour::{DIVERGING, FADE, FAINT, along, mix};
use crate::report::drawing::{Anchor, Colour, Drawing};
use crate::report::surface_view::{SurfaceView, Vector};
use crate::report::table::significant;

use super::dots::{evenly, radius};
use super::scale::{LARGE, fitting, foot, picture, shape_bar, short, with_unit};

/// Edges of the scene: left, right, above, below.
const ROOM: [f64; 4] = [52.0, 376.0, 44.0, 310.0];
/// Quadrilaterals a side.
const SIDE: usize = 28;
/// Lines of a net, each way: more would hide the surface.
const MOST_LINES: usize = 25;
/// Contacts that are drawn.
const MOST_DOTS: usize = 1_000;
/// Depths at which contacts are drawn.
const LAYERS: f64 = 24.0;
/// Pieces that the lines of a net are cut into, so that each stands at its own depth: of every line, and of all together.
const PIECES: [usize; 2] = [8, 480];
/// Pixels of an edge beside which its name and the numbers of its ends would touch.
const CRAMPED: f64 = 75.0;
const AZIMUTH: f64 = -60.0;
const ELEVATION: f64 = 28.0;
/// Distance of the camera, in sizes of the scene.
const DISTANCE: f64 = 3.0;
/// Relief below this part of the width is drawn larger.
const LEAST_RELIEF: f64 = 0.15;
const NET: Colour = [70, 70, 90];
const DOT: Colour = [20; 3];

enum Piece {
    Face(Vec<[f64; 2]>, Colour),
    Line([[f64; 2]; 2], f64),
    Knots(Vec<[f64; 2]>),
    Contacts(Vec<[f64; 2]>, f64),
}

/// Where the scene is seen from, and where it is drawn.
struct Camera {
    centre: Vector,
    size: f64,
    right: Vector,
    up: Vector,
    back: Vector,
    stretch: f64,
    shift: [f64; 2],
    zoom: f64,
}

/// Draws the surface.
pub(super) fn perspective(view: &SurfaceView, title: &str, unit: Option<&str>) -> Drawing {
    let mut drawing = picture(362.0);
    drawing.word([8.0, 14.0], fitting(title, 70), LARGE, Anchor::Start);
    let faces = faces(view);
    let corners: Vec<Vector> = faces.iter().flat_map(|(face, _)| face.iter().map(|k| view.points[*k])).collect();
    let mut words = Vec::new();
    let contacts = contacts(view, &mut words);
    let Some(bounds) = bounds(corners.iter().chain(&contacts)) else { return drawing };
    let net = net(view, &bounds, &mut words);
    let knots = || net.iter().flat_map(|(_, ends)| ends);
    let camera = Camera::over(view, bounds, corners.iter().chain(&contacts).chain(knots()));
    base(&mut drawing, &camera, bounds, unit);
    let mut pieces: Vec<(f64, Piece)> = Vec::new();
    let largest = view.curvedness.iter().copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
    for (face, middle) in &faces {
        let points: Vec<Vector> = face.iter().map(|k| view.points[*k]).collect();
        let depth = points.iter().map(|p| camera.depth(*p)).sum::<f64>() / points.len() as f64;
        let colour = colour(view, *middle, largest, &camera);
        pieces.push((depth, Piece::Face(points.iter().map(|p| camera.at(*p)).collect(), colour)));
    }
    pieces.extend(upon(&net, &contacts, &camera));
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    draw(&mut drawing, &pieces);
    shape_bar(&mut drawing, [410.0, 70.0], 150.0);
    drawing.word([410.0, 52.0], "S", MIDDLE, Anchor::Start);
    if camera.stretch > 1.0 {
        words.push(format!("heights drawn {} times as large", significant(camera.stretch, 3)));
    }
    foot(&mut drawing, &words);
    drawing
}

/// Lines and dots. What lies on the surface is drawn on it.
fn upon(net: &[(f64, [Vector; 2])], contacts: &[Vector], camera: &Camera) -> Vec<(f64, Piece)> {
    let nearer = |depth: f64| depth + 0.03 * camera.size;
    let cuts = PIECES[0].min(PIECES[1] / net.len().max(1)).max(1);
    let mut pieces = Vec::new();
    for (width, [a, b]) in net {
        let at = |k: usize| [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * k as f64 / cuts as f64);
        for ends in (0..cuts).map(|k| [at(k), at(k + 1)]) {
            let depth = nearer(0.5 * (camera.depth(ends[0]) + camera.depth(ends[1])));
            pieces.push((depth, Piece::Line(ends.map(|p| camera.at(p)), *width)));
        }
    }
    let knots = layers(net.iter().flat_map(|(_, ends)| ends).copied(), camera);
    pieces.extend(knots.into_iter().map(|(depth, dots)| (nearer(depth), Piece::Knots(dots))));
    let seen: Vec<[f64; 2]> = contacts.iter().map(|p| camera.at(*p)).collect();
    let radius = radius(&seen, 1.8);
    let touched = layers(contacts.iter().copied(), camera);
    pieces.extend(touched.into_iter().map(|(depth, dots)| (nearer(depth), Piece::Contacts(dots, radius))));
    pieces
}

fn draw(drawing: &mut Drawing, pieces: &[(f64, Piece)]) {
    for piece in pieces {
        match &piece.1 {
            Piece::Face(points, colour) => drawing.area(points, *colour, *colour),
            Piece::Line(ends, width) => drawing.line(ends, *width, NET),
            Piece::Knots(dots) => drawing.dots(dots.clone(), 1.5, NET),
            Piece::Contacts(dots, radius) => drawing.dots(dots.clone(), *radius, DOT),
        }
    }
}

/// Points by their depth, with the depth of the nearest of each layer; points in one place once.
fn layers(points: impl Iterator<Item = Vector>, camera: &Camera) -> Vec<(f64, Vec<[f64; 2]>)> {
    let mut seen: Vec<(f64, [f64; 2])> = points.map(|p| (camera.depth(p), camera.at(p))).collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
    seen.dedup();
    let layer = |depth: f64| (LAYERS * depth / camera.size).floor();
    let alike = seen.chunk_by(|a, b| layer(a.0) == layer(b.0));
    alike.map(|some| (some[some.len() - 1].0, some.iter().map(|(_, at)| *at).collect())).collect()
}

/// Corners of every piece of the surface, and the point of the map in its middle.
fn faces(view: &SurfaceView) -> Vec<([usize; 4], usize)> {
    let [n, m] = [view.places[0].len(), view.places[1].len()];
    let steps = |count: usize, closed: bool| -> Vec<usize> {
        if count < 2 {
            return Vec::new();
        }
        let parts = SIDE.min(if closed { count } else { count - 1 });
        let last = if closed { count } else { count - 1 };
        (0..=parts).map(|k| k * last / parts).collect()
    };
    let (rows, columns) = (steps(n, view.closed[0]), steps(m, view.closed[1]));
    let known = |k: &usize| view.curvedness.get(*k).is_some_and(|r| r.is_finite());
    let any = view.curvedness.iter().any(|r| r.is_finite());
    let mut faces = Vec::new();
    for i in rows.windows(2) {
        for j in columns.windows(2) {
            let at = |i: usize, j: usize| (i % n) * m + j % m;
            let face = [at(i[0], j[0]), at(i[0], j[1]), at(i[1], j[1]), at(i[1], j[0])];
            if !any || face.iter().all(known) {
                faces.push((face, at((i[0] + i[1]) / 2, (j[0] + j[1]) / 2)));
            }
        }
    }
    faces
}

/// Lines of the control net within twice the scene, with their width.
fn net(view: &SurfaceView, bounds: &[[f64; 2]; 3], words: &mut Vec<String>) -> Vec<(f64, [Vector; 2])> {
    let ([n, m], points) = (view.net.0, &view.net.1);
    let widest = bounds.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    let near = |p: &Vector| (0..3).all(|k| p[k] > bounds[k][0] - 0.6 * widest && p[k] < bounds[k][1] + 0.6 * widest);
    let steps = [n, m].map(|count| count.div_ceil(MOST_LINES).max(1));
    let mut lines = Vec::new();
    let mut add = |a: Option<&Vector>, b: Option<&Vector>| {
        if let (Some(a), Some(b)) = (a.filter(|p| near(p)), b.filter(|p| near(p))) {
            lines.push((0.9, [*a, *b]));
        }
    };
    for i in (0..n).step_by(steps[0]) {
        for j in (0..m).step_by(steps[1]) {
            let at = |i: usize, j: usize| points.get((i % n) * m + j % m);
            if i + steps[0] < n || view.closed[0] {
                add(at(i, j), at(if i + steps[0] < n { i + steps[0] } else { 0 }, j));
            }
            if j + steps[1] < m || view.closed[1] {
                add(at(i, j), at(i, if j + steps[1] < m { j + steps[1] } else { 0 }));
            }
        }
    }
    let all = if steps == [1, 1] { String::new() } else { format!(", one line in {}", steps[0].max(steps[1])) };
    words.push(format!("net: {n} x {m} control points{all}"));
    let outside = points.iter().filter(|p| !near(p)).count();
    if outside > 0 {
        words.push(format!("{outside} of them far off, not drawn"));
    }
    lines
}

/// Contacts that belong to the surface, thinned.
fn contacts(view: &SurfaceView, words: &mut Vec<String>) -> Vec<Vector> {
    let Some(contacts) = &view.contacts else { return Vec::new() };
    let chosen = evenly(&contacts.places, MOST_DOTS).into_iter().filter(|k| !contacts.left_out[*k]);
    let some: Vec<Vector> = chosen.map(|k| contacts.points[k]).filter(|p| p.iter().all(|v| v.is_finite())).collect();
    words.push(if some.len() == contacts.all {
        format!("dots: all {} contacts", some.len())
    } else {
        format!("dots: {} of {} contacts", some.len(), contacts.all)
    });
    some
}

fn bounds<'a>(points: impl Iterator<Item = &'a Vector>) -> Option<[[f64; 2]; 3]> {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for point in points {
        for k in 0..3 {
            bounds[k] = [bounds[k][0].min(point[k]), bounds[k][1].max(point[k])];
        }
    }
    bounds.iter().all(|[lo, hi]| lo <= hi && lo.is_finite() && hi.is_finite()).then_some(bounds)
}

/// S, shaded by how squarely the surface faces the light above the camera.
fn colour(view: &SurfaceView, k: usize, largest: f64, camera: &Camera) -> Colour {
    let (s, r) = (view.shape_index[k], view.curvedness[k]);
    let strength = if largest > 0.0 && s.is_finite() { (r / (FADE * largest)).min(1.0) } else { 0.0 };
    let full = if s.is_finite() { along(&DIVERGING, 0.5 * (s + 1.0)) } else { FAINT };
    let n = view.normals[k];
    let light: f64 = (0..3).map(|i| n[i] * (0.6 * camera.up[i] + 0.8 * camera.back[i])).sum();
    let shade = if light.is_finite() { 0.68 + 0.32 * light.abs() } else { 1.0 };
    mix(BLACK, mix(FAINT, full, strength), shade)
}

impl Camera {
    fn over<'a>(view: &SurfaceView, bounds: [[f64; 2]; 3], all: impl Iterator<Item = &'a Vector>) -> Camera {
        let sides = bounds.map(|[lo, hi]| hi - lo);
        let flat = sides[0].max(sides[1]);
        let upright = view.axes == ["x", "y"]
            && view.normals.iter().filter(|n| n[2].abs() > 0.7).count() * 2 > view.normals.len();
        let stretch = match sides[2] {
            // less than this is rounding
            z if !upright || z < 1e-6 * flat || z >= LEAST_RELIEF * flat => 1.0,
            z => {
                [2.0, 5.0, 10.0, 20.0, 50.0, 100.0].into_iter().find(|f| f * z >= LEAST_RELIEF * flat).unwrap_or(200.0)
            }
        };
        let below = view.normals.iter().filter(|n| n[2] < -0.5).count() * 2 > view.normals.len();
        let (sa, ca) = AZIMUTH.to_radians().sin_cos();
        let (se, ce) = (if below { -ELEVATION } else { ELEVATION }).to_radians().sin_cos();
        let mut camera = Camera {
            centre: bounds.map(|[lo, hi]| 0.5 * (lo + hi)),
            size: sides[0].hypot(sides[1]).hypot(stretch * sides[2]).max(f64::MIN_POSITIVE),
            right: [-sa, ca, 0.0],
            up: [-se * ca, -se * sa, ce],
            back: [ce * ca, ce * sa, se],
            stretch,
            shift: [0.0; 2],
            zoom: 1.0,
        };
        // the corners of the box hold room for the axes
        let corners = (0..8).map(|k| [0, 1, 2].map(|i| bounds[i][k >> i & 1]));
        let seen: Vec<[f64; 2]> = all.copied().chain(corners).map(|p| camera.at(p)).collect();
        let ends = |k: usize| {
            let of = seen.iter().map(|p| p[k]);
            of.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
        };
        let [x, y] = [ends(0), ends(1)];
        camera.zoom = ((ROOM[1] - ROOM[0]) / (x[1] - x[0])).min((ROOM[3] - ROOM[2]) / (y[1] - y[0]));
        camera.shift = [
            0.5 * (ROOM[0] + ROOM[1]) - camera.zoom * 0.5 * (x[0] + x[1]),
            0.5 * (ROOM[2] + ROOM[3]) - camera.zoom * 0.5 * (y[0] + y[1]),
        ];
        camera
    }

    fn along(&self, point: Vector, direction: &Vector) -> f64 {
        let stretch = [1.0, 1.0, self.stretch];
        (0..3).map(|k| stretch[k] * (point[k] - self.centre[k]) * direction[k]).sum()
    }

    /// Towards the camera.
    fn depth(&self, point: Vector) -> f64 {
        self.along(point, &self.back)
    }

    /// Pixels of a point.
    fn at(&self, point: Vector) -> [f64; 2] {
        let distance = DISTANCE * self.size;
        let scale = distance / (distance - self.depth(point)).max(0.1 * distance);
        let [u, v] = [self.along(point, &self.right), -self.along(point, &self.up)];
        [self.shift[0] + self.zoom * scale * u, self.shift[1] + self.zoom * scale * v]
    }
}

/// The edges of the box below and at the left, with names and the numbers of their ends.
fn base(drawing: &mut Drawing, camera: &Camera, bounds: [[f64; 2]; 3], unit: Option<&str>) {
    let [x, y, z] = bounds;
    let corner = |i: usize, j: usize, k: usize| [x[i], y[j], z[k]];
    let hidden =
        [[corner(0, 0, 0), corner(0, 1, 0)], [corner(0, 1, 0), corner(1, 1, 0)], [corner(0, 1, 0), corner(0, 1, 1)]];
    for [a, b] in hidden {
        drawing.line(&[camera.at(a), camera.at(b)], 0.6, [200; 3]);
    }
    let edges = [
        ("x", [corner(0, 0, 0), corner(1, 0, 0)], x, [-6.0, 12.0], Anchor::Middle),
        ("y", [corner(1, 0, 0), corner(1, 1, 0)], y, [10.0, 10.0], Anchor::Start),
        ("z", [corner(0, 0, 0), corner(0, 0, 1)], z, [-7.0, 0.0], Anchor::End),
    ];
    for (name, [a, b], ends, [right, down], anchor) in edges {
        let [a, b] = [camera.at(a), camera.at(b)];
        drawing.line(&[a, b], 0.8, GREY);
        let beside = |t: f64| [a[0] + t * (b[0] - a[0]) + right, a[1] + t * (b[1] - a[1]) + down];
        // the middle of a patch without noise is 0 but for rounding
        let span = ends[1] - ends[0];
        let ends = ends.map(|value| short(if value.abs() < 1e-9 * span { 0.0 } else { value }));
        let [mx, my] = beside(0.5);
        // an edge that runs towards the eye has no room for three words side by side
        if name == "y" && (b[0] - a[0]).hypot(b[1] - a[1]) < CRAMPED {
            let [x, y] = beside(0.0);
            drawing.word([x, y], format!("{}:", with_unit(name, unit, 1)), MIDDLE, Anchor::Start);
            drawing.word([x, y + 14.0], ends.join(" to "), SMALL, Anchor::Start);
            continue;
        }
        // the ends of two edges meet in one corner: their numbers keep off it
        for (t, word) in [0.08, 0.92].into_iter().zip(ends) {
            drawing.word(beside(t), word, SMALL, anchor);
        }
        if name == "z" {
            drawing.word([b[0], b[1] - 14.0], with_unit(name, unit, 1), MIDDLE, Anchor::Middle);
        } else {
            drawing.word([mx, my + 8.0], with_unit(name, unit, 1), MIDDLE, anchor);
        }
    }
}
