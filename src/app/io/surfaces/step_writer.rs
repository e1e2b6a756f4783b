//! STEP: one spline as the only face of an open shell, ISO 10303-21 in the schema of AP214.
//!
//! ```text
//! product -> shape representation -> shell-based surface model -> open shell -> advanced face
//!     face = B_SPLINE_SURFACE_WITH_KNOTS, bounded by four B_SPLINE_CURVE_WITH_KNOTS, the rims of its control net
//! ```
//!
//! The rims run around the face with the surface on their left, seen from the free side. Numbers have as many digits as
//! read back to the same bits.

use std::fmt::Write as _;

use ndarray::{Array2, ArrayView1};

use super::cad::CadPatch;
use super::cad_shell::{CadEdge, CadShell};

/// Instances in the order of their numbers.
#[derive(Default)]
pub(super) struct StepInstances {
    text: String,
    last: usize,
}

impl StepInstances {
    /// Adds an instance and returns its reference.
    pub(super) fn add(&mut self, entity: &str) -> String {
        self.last += 1;
        // writing to a string cannot fail
        let _ = writeln!(self.text, "#{}={entity};", self.last);
        format!("#{}", self.last)
    }
}

/// The whole file, of one face.
pub(super) fn write(patch: &CadPatch, title: &str) -> String {
    whole(title, SPLINE, |data| vec![face(data, patch)])
}

/// The whole file, of several faces that share their edges.
pub(super) fn write_shell(shell: &CadShell, title: &str) -> String {
    whole(title, SPLINE, |data| faces(data, shell))
}

/// What a file of splines says that it is.
const SPLINE: &str = "spline surface fitted to contacts";

/// A file of an open shell of these faces.
pub(super) fn whole(title: &str, what: &str, faces: impl FnOnce(&mut StepInstances) -> Vec<String>) -> String {
    let mut data = StepInstances::default();
    let title = string(title);
    let (context, definition) = product(&mut data, &title);
    let faces = faces(&mut data);
    let shell = data.add(&format!("OPEN_SHELL('',{})", list(faces.iter())));
    let model = data.add(&format!("SHELL_BASED_SURFACE_MODEL({title},({shell}))"));
    let origin = data.add("CARTESIAN_POINT('',(0.,0.,0.))");
    let axis = data.add("DIRECTION('',(0.,0.,1.))");
    let across = data.add("DIRECTION('',(1.,0.,0.))");
    let placed = data.add(&format!("AXIS2_PLACEMENT_3D('',{origin},{axis},{across})"));
    let shape = data.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION({title},({placed},{model}),{context})"));
    data.add(&format!("SHAPE_DEFINITION_REPRESENTATION({definition},{shape})"));
    // no clock is read: the same surface gives the same file
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('{what}'),'2;1');\n\
         FILE_NAME({title},'1970-01-01T00:00:00',(''),(''),'palpate {}','palpate','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
        env!("CARGO_PKG_VERSION"),
        data.text
    )
}

/// The product that the shape belongs to: the geometric context with its units, and the definition's shape.
fn product(data: &mut StepInstances, title: &str) -> (String, String) {
    let application = data.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
    data.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})"
    ));
    let kind = data.add(&format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let product = data.add(&format!("PRODUCT({title},{title},'',({kind}))"));
    data.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
    let formation = data.add(&format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let stage = data.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let definition = data.add(&format!("PRODUCT_DEFINITION('design','',{formation},{stage})"));
    let shape = data.add(&format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    let length = data.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let angle = data.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let solid = data.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let tolerance = data
        .add(&format!("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{length},'distance_accuracy_value','')"));
    let context = data.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({tolerance}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid}))REPRESENTATION_CONTEXT('',''))"
    ));
    (context, shape)
}

/// The faces of a shell: vertices and edges stand once for all faces that they belong to.
fn faces(data: &mut StepInstances, shell: &CadShell) -> Vec<String> {
    let vertices: Vec<String> = shell.vertices.iter().map(|at| vertex(data, *at)).collect();
    let edges: Vec<String> = shell.edges.iter().map(|edge| shared_edge(data, edge, &vertices)).collect();
    let face = |(patch, around): (&CadPatch, &Vec<(usize, bool)>)| {
        let points = patch.points.mapv(|p| point(data, p));
        let surface = surface(data, patch, &points);
        let runs: Vec<String> = around
            .iter()
            .map(|(edge, forward)| {
                let forward = if *forward { ".T." } else { ".F." };
                data.add(&format!("ORIENTED_EDGE('',*,*,{},{forward})", edges[*edge]))
            })
            .collect();
        bounded(data, &surface, &runs)
    };
    shell.faces.iter().zip(&shell.loops).map(face).collect()
}

pub(super) fn vertex(data: &mut StepInstances, at: [f64; 3]) -> String {
    let at = point(data, at);
    data.add(&format!("VERTEX_POINT('',{at})"))
}

fn shared_edge(data: &mut StepInstances, edge: &CadEdge, vertices: &[String]) -> String {
    let points: Vec<String> = edge.points.iter().map(|at| point(data, *at)).collect();
    let curve = curve(data, ArrayView1::from(&points), edge.degree, &multiplicities(&edge.knots));
    let [from, to] = edge.ends.map(|end| &vertices[end]);
    data.add(&format!("EDGE_CURVE('',{from},{to},{curve},.T.)"))
}

fn surface(data: &mut StepInstances, patch: &CadPatch, points: &Array2<String>) -> String {
    let [p, q] = patch.degree;
    let [u, v] = [0, 1].map(|k| multiplicities(&patch.knots[k]));
    let rows: Vec<String> = points.rows().into_iter().map(|row| list(row.iter())).collect();
    data.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',{p},{q},{},.UNSPECIFIED.,.F.,.F.,.F.,{},{},{},{},.UNSPECIFIED.)",
        list(rows.iter()),
        u.1,
        v.1,
        u.0,
        v.0
    ))
}

fn bounded(data: &mut StepInstances, surface: &str, edges: &[String]) -> String {
    let outline = data.add(&format!("EDGE_LOOP('',{})", list(edges.iter())));
    let bound = data.add(&format!("FACE_OUTER_BOUND('',{outline},.T.)"));
    data.add(&format!("ADVANCED_FACE('',({bound}),{surface},.T.)"))
}

fn face(data: &mut StepInstances, patch: &CadPatch) -> String {
    let points = patch.points.mapv(|p| point(data, p));
    let (n, m) = points.dim();
    let [p, q] = patch.degree;
    let [u, v] = [0, 1].map(|k| multiplicities(&patch.knots[k]));
    let surface = surface(data, patch, &points);
    // around the face: along u, along v, and both back against their curves
    let corners = [(0, 0), (n - 1, 0), (n - 1, m - 1), (0, m - 1)];
    let vertices = corners.map(|at| data.add(&format!("VERTEX_POINT('',{})", points[at])));
    let rims = [
        (points.column(0), p, &u, 0, 1, ".T."),
        (points.row(n - 1), q, &v, 1, 2, ".T."),
        (points.column(m - 1), p, &u, 3, 2, ".F."),
        (points.row(0), q, &v, 0, 3, ".F."),
    ];
    let edges: Vec<String> = rims
        .into_iter()
        .map(|(rim, degree, knots, from, to, forward)| {
            let curve = curve(data, rim, degree, knots);
            let (from, to) = (&vertices[from], &vertices[to]);
            let edge = data.add(&format!("EDGE_CURVE('',{from},{to},{curve},.T.)"));
            data.add(&format!("ORIENTED_EDGE('',*,*,{edge},{forward})"))
        })
        .collect();
    bounded(data, &surface, &edges)
}

pub(super) fn point(data: &mut StepInstances, p: [f64; 3]) -> String {
    let [x, y, z] = p.map(real);
    data.add(&format!("CARTESIAN_POINT('',({x},{y},{z}))"))
}

fn curve(data: &mut StepInstances, rim: ArrayView1<String>, degree: usize, knots: &(String, String)) -> String {
    data.add(&format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',{degree},{},.UNSPECIFIED.,.F.,.F.,{},{},.UNSPECIFIED.)",
        list(rim.iter()),
        knots.1,
        knots.0
    ))
}

pub(super) fn list<'a>(items: impl Iterator<Item = &'a String>) -> String {
    format!("({})", items.map(String::as_str).collect::<Vec<_>>().join(","))
}

/// Distinct knots, and how often each stands.
fn multiplicities(knots: &[f64]) -> (String, String) {
    let groups: Vec<&[f64]> = knots.chunk_by(|a, b| a == b).collect();
    let values: Vec<String> = groups.iter().map(|group| real(group[0])).collect();
    let counts: Vec<String> = groups.iter().map(|group| group.len().to_string()).collect();
    (list(values.iter()), list(counts.iter()))
}

/// A number as Part 21 has it: a decimal point always, and the fewest digits that read back to the same bits.
pub(super) fn real(value: f64) -> String {
    let text = format!("{value:E}");
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let point = if mantissa.contains('.') { "" } else { "." };
    if exponent == "0" { format!("{mantissa}{point}") } else { format!("{mantissa}{point}E{exponent}") }
}

/// A string of Part 21: quotes and backslashes doubled, everything beyond ASCII in hexadecimal.
fn string(text: &str) -> String {
    let mut out = String::from("'");
    for c in text.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            c => {
                let _ = write!(out, "\\X4\\{:08X}\\X0\\", u32::from(c));
            }
        }
    }
    out + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_read_back_to_the_bit() {
        for value in [0.0, -0.0, 1.0, 0.1, -1.0 / 3.0, 1e300, 5e-324, 123456.75, 1e22] {
            let text = real(value);
            assert!(text.contains('.'), "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
        }
    }

    #[test]
    fn strings_hold_quotes_and_letters() {
        assert_eq!(string("it's a \\ \u{e9}"), "'it''s a \\\\ \\X4\\000000E9\\X0\\'");
    }
}
