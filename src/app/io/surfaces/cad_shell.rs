//! An adaptive surface for CAD whose one spline would be too large: several faces, sewn along common edges.
//!
//! ```text
//! face = tensor spline over a rectangle of cells       edge = one curve, of two faces or of the rim       vertex = corner of edges
//! ```
//!
//! Every edge is one curve in the knots of the finer of its faces, and stands in the file once: the shell is closed along it by its topology,
//! and the faces' own rims are that curve to rounding. Across edges height and slopes go on, and curvature of degree 3 and more.

use std::collections::BTreeMap;

use super::cad::{CadPatch, MOST_COEFFICIENTS, in_space};
use palpate_geometry::contact::Frame;
use palpate_hierarchical::field::{FieldPatches, HierarchicalField, PatchEdge};
use palpate_numeric::bspline::Knots;

/// A curve that faces share.
#[derive(Clone, Debug)]
pub(super) struct CadEdge {
    pub(super) degree: usize,
    /// Full knot vector.
    pub(super) knots: Vec<f64>,
    pub(super) points: Vec<[f64; 3]>,
    /// Numbers of the vertices at its ends.
    pub(super) ends: [usize; 2],
}

/// Faces with what bounds them.
#[derive(Clone, Debug)]
pub(super) struct CadShell {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) edges: Vec<CadEdge>,
    pub(super) faces: Vec<CadPatch>,
    /// Edges around every face with the surface on their left, and whether they are run forwards.
    pub(super) loops: Vec<Vec<(usize, bool)>>,
}

impl CadShell {
    /// The faces of an adaptive surface.
    ///
    /// # Errors
    /// What can be saved instead where they are too large, too.
    pub(super) fn of(field: &HierarchicalField, frame: &Frame) -> Result<CadShell, String> {
        let numbers = field.patch_coefficients();
        if numbers > MOST_COEFFICIENTS {
            return Err(format!(
                "as splines over its cells the surface has {numbers} coefficients, at most {MOST_COEFFICIENTS} in all are written; .json \
                 holds its cells as they are, and a mesh (.ply, .obj, .stl, .glb, .vtu) takes any surface"
            ));
        }
        let FieldPatches { patches, edges } = field.patches().map_err(|error| error.to_string())?;
        let faces = patches.iter().map(|patch| CadPatch::of_height(&patch.surface, frame)).collect();
        let (mut vertices, mut numbered) = (Vec::new(), BTreeMap::new());
        let mut curves = Vec::with_capacity(edges.len());
        for edge in &edges {
            let points = points_of(edge, frame);
            let corners = [(edge.ends[0], points[0]), (edge.ends[1], points[points.len() - 1])];
            let ends = corners.map(|(place, point)| {
                *numbered.entry(place).or_insert_with(|| {
                    vertices.push(point);
                    vertices.len() - 1
                })
            });
            curves.push(CadEdge { degree: edge.knots.degree(), knots: edge.knots.as_slice().to_vec(), points, ends });
        }
        let loops = loops_of(&edges, patches.len());
        Ok(CadShell { vertices, edges: curves, faces, loops })
    }
}

fn points_of(edge: &PatchEdge, frame: &Frame) -> Vec<[f64; 3]> {
    let along = Knots::greville(&edge.knots);
    let point = |(t, z): (&f64, &f64)| {
        let place = if edge.axis == 0 { [*t, edge.across, *z] } else { [edge.across, *t, *z] };
        in_space(place, frame)
    };
    along.iter().zip(&edge.heights).map(point).collect()
}

/// Around every face: along x at its least y, along y at its greatest x, and both back.
fn loops_of(edges: &[PatchEdge], faces: usize) -> Vec<Vec<(usize, bool)>> {
    // edges come in the order of their places; sides of a face: below, right, above, left
    let mut around = vec![[const { Vec::new() }; 4]; faces];
    for (number, edge) in edges.iter().enumerate() {
        let [before, behind] = edge.sides;
        let [of_behind, of_before] = if edge.axis == 0 { [0, 2] } else { [3, 1] };
        behind.iter().for_each(|face| around[*face][of_behind].push((number, of_behind == 0)));
        before.iter().for_each(|face| around[*face][of_before].push((number, of_before == 1)));
    }
    let in_order = |[below, right, mut above, mut left]: [Vec<(usize, bool)>; 4]| {
        above.reverse();
        left.reverse();
        [below, right, above, left].concat()
    };
    around.into_iter().map(in_order).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use palpate_hierarchical::mesh::{CellId, Mesh};
    use palpate_hierarchical::space::HierarchicalSpace;

    fn field(level: u8, place: [u32; 2]) -> HierarchicalField {
        let knots = |n| Knots::uniform(3, n, 0.0, 1.0).unwrap();
        let mut mesh = Mesh::new([knots(4), knots(5)]).unwrap();
        mesh.refine(CellId { level, place }).unwrap();
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let heights = (0..space.unknowns()).map(|k| (k as f64).sin()).collect();
        HierarchicalField::new(space, heights).unwrap()
    }

    #[test]
    fn both_formats_hold_all_faces_and_every_edge_once() {
        let field = field(8, [533, 320]);
        assert!(super::super::cad::is_too_large(&field));
        let shell = CadShell::of(&field, &Frame::IDENTITY).unwrap();
        let step = super::super::step_writer::write_shell(&shell, "a lens");
        let count = |text: &str, word: &str| text.matches(word).count();
        assert_eq!(count(&step, "=ADVANCED_FACE("), shell.faces.len());
        assert_eq!(count(&step, "=EDGE_CURVE("), shell.edges.len());
        assert_eq!(count(&step, "=VERTEX_POINT("), shell.vertices.len());
        assert_eq!(count(&step, "=ORIENTED_EDGE("), shell.loops.iter().map(Vec::len).sum::<usize>());
        let iges = super::super::iges_writer::write(&shell.faces, "a lens");
        assert!(iges.lines().all(|line| line.len() == 80));
        let directory = iges.lines().filter(|line| line.as_bytes()[72] == b'D').count();
        assert_eq!(directory, 2 * shell.faces.len());
        // the parameters of every entity say whose they are, and begin where the directory says
        let parameters: Vec<&str> = iges.lines().filter(|line| line.as_bytes()[72] == b'P').collect();
        let entries: Vec<&str> = iges.lines().filter(|line| line.as_bytes()[72] == b'D').collect();
        for (k, entry) in entries.iter().step_by(2).enumerate() {
            let first: usize = entry[8..16].trim().parse().unwrap();
            assert!(parameters[first - 1].starts_with("128,"));
            assert_eq!(parameters[first - 1][64..72].trim().parse::<usize>().unwrap(), 2 * k + 1);
        }
    }

    #[test]
    fn loops_close_and_every_inner_edge_is_run_both_ways() {
        let shell = CadShell::of(&field(4, [33, 20]), &Frame::IDENTITY).unwrap();
        let mut runs = vec![[0; 2]; shell.edges.len()];
        for face in &shell.loops {
            let end = |(edge, forward): (usize, bool), end: usize| {
                shell.edges[edge].ends[if forward { end } else { 1 - end }]
            };
            for (k, edge) in face.iter().enumerate() {
                assert_eq!(end(*edge, 1), end(face[(k + 1) % face.len()], 0));
                runs[edge.0][usize::from(edge.1)] += 1;
            }
        }
        let inner = runs.iter().filter(|run| **run == [1, 1]).count();
        let rim = runs.iter().filter(|run| run.iter().sum::<usize>() == 1).count();
        assert!(inner + rim == runs.len() && inner > rim && rim >= 4);
        // Euler: faces - edges + vertices of a disc
        assert_eq!(shell.faces.len() + shell.vertices.len(), shell.edges.len() + 1);
    }
}
