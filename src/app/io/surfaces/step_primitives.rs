//! STEP: the primitives of a body as faces of an open shell, ISO 10303-21 in the schema of AP214.
//!
//! ```text
//! PLANE, SPHERICAL_SURFACE, CYLINDRICAL_SURFACE, CONICAL_SURFACE, TOROIDAL_SURFACE        edges: LINE, CIRCLE
//! band:  circle at the first end forwards, side up, circle at the last end back, side down; all round both sides are one seam
//! ```
//!
//! Outlines run with the face on their left, seen from outside; what is hollow is seen from inside, and its face is turned.

use std::io::Write;

use palpate_numeric::vector::{Vector, along, cross, minus, norm, unit};

use super::step_writer::{StepInstances, list, point, real, vertex, whole};
use super::trimmed_primitive::{PlacedAxes, TrimmedFace, TrimmedPrimitive, TurnedSurface};

/// Writes all of them into one file.
///
/// # Errors
/// What the system says.
pub(crate) fn write_primitives(
    primitives: &[TrimmedPrimitive],
    title: &str,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let faces = |data: &mut StepInstances| primitives.iter().map(|primitive| face(data, primitive)).collect();
    out.write_all(whole(title, "primitives found in contacts", faces).as_bytes())
}

fn face(data: &mut StepInstances, primitive: &TrimmedPrimitive) -> String {
    let axes = &primitive.axes;
    let placed = placement(data, axes);
    let (surface, outline) = match &primitive.face {
        TrimmedFace::Polygon(corners) => (data.add(&format!("PLANE('',{placed})")), polygon(data, corners)),
        TrimmedFace::Cap { radius, from } => {
            let surface = data.add(&format!("SPHERICAL_SURFACE('',{placed},{})", real(*radius)));
            (surface, cap(data, axes, *radius, *from))
        }
        TrimmedFace::Band { surface, around, profile } => {
            let entity = turned_surface(surface, &placed);
            let (around, profile) = (*around, *profile);
            (data.add(&entity), TurnedBand { axes, surface, around, profile }.outline(data))
        }
    };
    let sense = if primitive.hollow { ".F." } else { ".T." };
    let bound = data.add(&format!("FACE_OUTER_BOUND('',{outline},{sense})"));
    data.add(&format!("ADVANCED_FACE('{}',({bound}),{surface},{sense})", primitive.name))
}

fn turned_surface(surface: &TurnedSurface, placed: &str) -> String {
    match surface {
        TurnedSurface::Cylinder { radius } => format!("CYLINDRICAL_SURFACE('',{placed},{})", real(*radius)),
        TurnedSurface::Cone { radius, half_angle } => {
            format!("CONICAL_SURFACE('',{placed},{},{})", real(*radius), real(*half_angle))
        }
        TurnedSurface::Torus { ring, tube } => {
            format!("TOROIDAL_SURFACE('',{placed},{},{})", real(*ring), real(*tube))
        }
    }
}

fn placement(data: &mut StepInstances, axes: &PlacedAxes) -> String {
    let origin = point(data, axes.origin);
    let [z, x] = [axes.z, axes.x].map(|way| direction(data, way));
    data.add(&format!("AXIS2_PLACEMENT_3D('',{origin},{z},{x})"))
}

fn direction(data: &mut StepInstances, way: Vector) -> String {
    let [x, y, z] = way.map(real);
    data.add(&format!("DIRECTION('',({x},{y},{z}))"))
}

fn circle(data: &mut StepInstances, axes: &PlacedAxes, radius: f64) -> String {
    let placed = placement(data, axes);
    data.add(&format!("CIRCLE('',{placed},{})", real(radius)))
}

fn line(data: &mut StepInstances, from: Vector, to: Vector) -> String {
    let start = point(data, from);
    let way = direction(data, unit(minus(to, from)));
    let vector = data.add(&format!("VECTOR('',{way},{})", real(norm(minus(to, from)))));
    data.add(&format!("LINE('',{start},{vector})"))
}

fn edge(data: &mut StepInstances, from: &str, to: &str, curve: &str) -> String {
    data.add(&format!("EDGE_CURVE('',{from},{to},{curve},.T.)"))
}

/// A loop of edges, each forwards or back.
fn edge_loop(data: &mut StepInstances, edges: &[(&String, bool)]) -> String {
    let oriented: Vec<String> = edges
        .iter()
        .map(|(edge, forward)| {
            let forward = if *forward { ".T." } else { ".F." };
            data.add(&format!("ORIENTED_EDGE('',*,*,{edge},{forward})"))
        })
        .collect();
    data.add(&format!("EDGE_LOOP('',{})", list(oriented.iter())))
}

fn polygon(data: &mut StepInstances, corners: &[Vector]) -> String {
    let vertices: Vec<String> = corners.iter().map(|corner| vertex(data, *corner)).collect();
    let sides: Vec<String> = (0..corners.len())
        .map(|k| {
            let next = (k + 1) % corners.len();
            let side = line(data, corners[k], corners[next]);
            edge(data, &vertices[k], &vertices[next], &side)
        })
        .collect();
    edge_loop(data, &sides.iter().map(|side| (side, true)).collect::<Vec<(&String, bool)>>())
}

/// The rim of a cap; of the whole ball a pole.
fn cap(data: &mut StepInstances, axes: &PlacedAxes, radius: f64, from: Option<f64>) -> String {
    let Some(height) = from else {
        let pole = vertex(data, along(axes.origin, radius, axes.z));
        return data.add(&format!("VERTEX_LOOP('',{pole})"));
    };
    let across = (radius * radius - height * height).max(0.0).sqrt();
    let start = vertex(data, axes.place(0.0, across, height));
    let rim = circle(data, &PlacedAxes { origin: along(axes.origin, height, axes.z), ..*axes }, across);
    let rim = edge(data, &start, &start, &rim);
    edge_loop(data, &[(&rim, true)])
}

/// A band with the axes that it is turned about; `None` goes all round.
struct TurnedBand<'a> {
    axes: &'a PlacedAxes,
    surface: &'a TurnedSurface,
    around: Option<[f64; 2]>,
    profile: Option<[f64; 2]>,
}

impl TurnedBand<'_> {
    fn angles(&self) -> [f64; 2] {
        self.around.unwrap_or([0.0; 2])
    }

    fn ends(&self) -> [f64; 2] {
        self.profile.unwrap_or([0.0; 2])
    }

    fn place(&self, angle: f64, v: f64) -> Vector {
        let [distance, height] = self.surface.profile(v);
        self.axes.place(angle, distance, height)
    }

    /// Vertices at the first end, in the order of the angles, and at the last: what goes all round has one in the place of two.
    fn corners(&self, data: &mut StepInstances) -> [[String; 2]; 2] {
        let ([first, last], [lo, hi]) = (self.angles(), self.ends());
        let mut corner = |angle: f64, v: f64| vertex(data, self.place(angle, v));
        let start = corner(first, lo);
        let beside = if self.around.is_some() { corner(last, lo) } else { start.clone() };
        if self.profile.is_none() {
            return [[start.clone(), beside.clone()], [start, beside]];
        }
        let above = corner(first, hi);
        let across = if self.around.is_some() { corner(last, hi) } else { above.clone() };
        [[start, beside], [above, across]]
    }

    /// The circle at an end, from the first angle to the last.
    fn ring(&self, data: &mut StepInstances, v: f64, [from, to]: &[String; 2]) -> String {
        let [distance, height] = self.surface.profile(v);
        let origin = along(self.axes.origin, height, self.axes.z);
        let curve = circle(data, &PlacedAxes { origin, ..*self.axes }, distance);
        edge(data, from, to, &curve)
    }

    /// The side at an angle, from the first end to the last.
    fn side(&self, data: &mut StepInstances, angle: f64, from: &str, to: &str) -> String {
        let [lo, hi] = self.ends();
        let curve = match self.surface {
            TurnedSurface::Torus { ring, tube } => {
                let x = self.axes.radial(angle);
                let (origin, z) = (along(self.axes.origin, *ring, x), cross(x, self.axes.z));
                circle(data, &PlacedAxes { origin, x, z }, *tube)
            }
            _ => line(data, self.place(angle, lo), self.place(angle, hi)),
        };
        edge(data, from, to, &curve)
    }

    fn outline(&self, data: &mut StepInstances) -> String {
        let [below, above] = self.corners(data);
        let ([first, last], [lo, hi]) = (self.angles(), self.ends());
        let bottom = self.ring(data, lo, &below);
        let top = if self.profile.is_some() { self.ring(data, hi, &above) } else { bottom.clone() };
        let left = self.side(data, first, &below[0], &above[0]);
        let right = if self.around.is_some() { self.side(data, last, &below[1], &above[1]) } else { left.clone() };
        edge_loop(data, &[(&bottom, true), (&right, true), (&top, false), (&left, false)])
    }
}
