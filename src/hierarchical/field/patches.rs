//! A hierarchical surface as several tensor splines that adjoin, each with knots no finer than its own smallest cells.
//!
//! ```text
//! c_ij = S[t_i+1, .., t_i+p; s_j+1, .., s_j+q]      the blossom of S's polynomial on a cell of the patch that function (i, j) reaches
//! ```
//!
//! The knots of a patch are those of its finest level, the ends p + 1 times. S has no other knots inside, so that each patch is S, to
//! rounding, and two patches have the same height, slopes and, of degree 3 and more, curvature along their edge. Where one edge meets two
//! others, it is cut at their common corner: every edge has one patch on each side or lies on the rim, and is one curve for both.

use std::collections::BTreeMap;
use std::ops::Range;

use super::HierarchicalField;
use crate::error::HierarchyError;
use crate::mesh::{CellId, CellRectangle, blossom_row};
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::Knots;

/// A rectangle of cells as one tensor spline.
#[derive(Clone, Debug)]
pub struct TensorPatch {
    /// Which cells.
    pub rectangle: CellRectangle,
    /// The surface over them.
    pub surface: HeightField,
}

/// A straight piece of knot line between two patches, or of the rim.
#[derive(Clone, Debug)]
pub struct PatchEdge {
    /// 0: along x; 1: along y.
    pub axis: usize,
    /// Where it begins and ends, in cells of the deepest level.
    pub ends: [[u32; 2]; 2],
    /// Numbers of the patches at smaller and at larger coordinates across.
    pub sides: [Option<usize>; 2],
    /// Its coordinate across.
    pub across: f64,
    /// Knots along it.
    pub knots: Knots,
    /// Coefficients of the height along it.
    pub heights: Vec<f64>,
}

/// A surface in patches.
#[derive(Clone, Debug)]
pub struct FieldPatches {
    /// The patches.
    pub patches: Vec<TensorPatch>,
    /// All pieces of their edges.
    pub edges: Vec<PatchEdge>,
}

/// Axis, place across, and ends along it, in cells of the deepest level.
type EdgePlace = (usize, u32, [u32; 2]);

impl HierarchicalField {
    /// Coefficients of all patches of [`HierarchicalField::patches`].
    pub fn patch_coefficients(&self) -> usize {
        let degree = self.space().mesh().levels().degree();
        let of = |piece: &CellRectangle| (0..2).map(|k| piece.sides()[k] as usize + degree[k]).product::<usize>();
        self.space().mesh().rectangles().iter().map(of).sum()
    }

    /// The surface as tensor splines over the rectangles of its mesh, and the edges where they meet.
    ///
    /// # Errors
    /// [`HierarchyError::Knots`] where two knots of a level are the same number.
    pub fn patches(&self) -> Result<FieldPatches, HierarchyError> {
        let rectangles = self.space().mesh().rectangles();
        let patches = rectangles.iter().map(|rectangle| self.patch(*rectangle)).collect::<Result<Vec<_>, _>>()?;
        let deepest = self.space().mesh().tree().deepest() as u8;
        let edges = edge_places(&rectangles, deepest).into_iter().map(|(place, sides)| {
            let level = sides.iter().flatten().map(|patch| rectangles[*patch].level).max().unwrap_or(deepest);
            self.edge(place, sides, [level, deepest])
        });
        let edges = edges.collect::<Result<Vec<_>, _>>()?;
        Ok(FieldPatches { patches, edges })
    }

    fn patch(&self, rectangle: CellRectangle) -> Result<TensorPatch, HierarchyError> {
        let CellRectangle { level, from, to } = rectangle;
        let knots = [self.restricted(0, level, from[0]..to[0])?, self.restricted(1, level, from[1]..to[1])?];
        let inner = knots.each_ref().map(inner_knots);
        let mut coefficients = Vec::with_capacity(inner[0].len() * inner[1].len());
        for (segment_x, along_x) in &inner[0] {
            for (segment_y, along_y) in &inner[1] {
                let place = [from[0] + *segment_x as u32, from[1] + *segment_y as u32];
                coefficients.push(self.blossom(CellId { level, place }, [along_x, along_y]));
            }
        }
        let surface =
            HeightField::new(knots, &coefficients[..]).map_err(|source| HierarchyError::Knots { axis: "x", source })?;
        Ok(TensorPatch { rectangle, surface })
    }

    /// The edge in the knots of the finer patch beside it.
    fn edge(
        &self,
        (axis, line, along): EdgePlace,
        sides: [Option<usize>; 2],
        [level, deepest]: [u8; 2],
    ) -> Result<PatchEdge, HierarchyError> {
        let [from, to] = along.map(|k| k >> (deepest - level));
        let knots = self.restricted(axis, level, from..to)?;
        // the cell behind the line, and at the end of the domain that before it
        let row = line >> (deepest - level);
        let cell_across = if sides[1].is_some() { row } else { row - 1 };
        let of_level = self.space().mesh().levels().at(level.into())[1 - axis].knots();
        let [lo, hi] = of_level.segment(cell_across as usize);
        let across = if sides[1].is_some() { lo } else { hi };
        let still = vec![across; of_level.degree()];
        let height = |(segment, inner): (usize, &[f64])| {
            let mut place = [cell_across; 2];
            place[axis] = from + segment as u32;
            let arguments = if axis == 0 { [inner, &still[..]] } else { [&still[..], inner] };
            self.blossom(CellId { level, place }, arguments)
        };
        let heights = inner_knots(&knots).into_iter().map(height).collect();
        let corner = |k: u32| if axis == 0 { [k, line] } else { [line, k] };
        Ok(PatchEdge { axis, ends: along.map(corner), sides, across, knots, heights })
    }

    /// Knots of a level over some of its segments, the ends p + 1 times.
    fn restricted(&self, axis: usize, level: u8, segments: Range<u32>) -> Result<Knots, HierarchyError> {
        let all = self.space().mesh().levels().at(level.into())[axis].knots();
        let (lo, hi) = (all.segment(segments.start as usize)[0], all.segment(segments.end as usize - 1)[1]);
        let ends = |t: f64| std::iter::repeat_n(t, all.degree() + 1);
        let between = all.as_slice().iter().copied().filter(|t| *t > lo && *t < hi);
        let name = if axis == 0 { "x" } else { "y" };
        Knots::new(all.degree(), ends(lo).chain(between).chain(ends(hi)).collect())
            .map_err(|source| HierarchyError::Knots { axis: name, source })
    }

    /// The blossom of the polynomial on a cell that is a leaf, or lies in one.
    fn blossom(&self, cell: CellId, [x, y]: [&[f64]; 2]) -> f64 {
        let space = self.space();
        let leaf = (0..=cell.level).rev().find_map(|level| space.leaf_of(cell.ancestor(level))).unwrap_or_default();
        let place = space.leaves()[leaf].place.map(|k| k as usize);
        let [kx, ky] = space.knots_of(leaf);
        let (a, b) = (blossom_row(kx, place[0], x), blossom_row(ky, place[1], y));
        let rows = self.table(leaf).chunks_exact(ky.degree() + 1);
        let along = |row: &[f64]| row.iter().zip(&b.shares).map(|(c, share)| c * share).sum::<f64>();
        rows.zip(&a.shares).map(|(row, share)| share * along(row)).sum()
    }
}

/// For every function the first segment that it reaches, and its p inner knots.
fn inner_knots(knots: &Knots) -> Vec<(usize, &[f64])> {
    let p = knots.degree();
    let mut segment = 0;
    let of = |k: usize| {
        while knots.first_basis(segment) + p < k {
            segment += 1;
        }
        (segment, &knots.as_slice()[k + 1..=k + p])
    };
    (0..knots.n_basis()).map(of).collect()
}

/// Ends of a patch's side along a line, the patch, and on which side of the line it lies.
type PatchSide = ([u32; 2], usize, usize);

/// All pieces of edges with the patches on both sides.
fn edge_places(rectangles: &[CellRectangle], deepest: u8) -> BTreeMap<EdgePlace, [Option<usize>; 2]> {
    // on every line the patches that end or begin there
    let mut lines: BTreeMap<(usize, u32), Vec<PatchSide>> = BTreeMap::new();
    for (patch, rectangle) in rectangles.iter().enumerate() {
        let CellRectangle { from, to, .. } = rectangle.in_level(deepest);
        for axis in 0..2 {
            let along = [from[axis], to[axis]];
            lines.entry((axis, from[1 - axis])).or_default().push((along, patch, 1));
            lines.entry((axis, to[1 - axis])).or_default().push((along, patch, 0));
        }
    }
    let mut edges: BTreeMap<EdgePlace, [Option<usize>; 2]> = BTreeMap::new();
    for ((axis, line), sides) in lines {
        let mut corners: Vec<u32> = sides.iter().flat_map(|(along, _, _)| *along).collect();
        corners.sort_unstable();
        corners.dedup();
        for ([from, to], patch, side) in sides {
            let first = corners.partition_point(|k| *k < from);
            let last = corners.partition_point(|k| *k < to);
            for ends in corners[first..=last].windows(2) {
                edges.entry((axis, line, [ends[0], ends[1]])).or_default()[side] = Some(patch);
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::mesh::Mesh;
    use crate::space::HierarchicalSpace;
    use palpate_numeric::draws::Lcg;

    fn rough(degree: usize) -> HierarchicalField {
        let mut draw = Lcg::new(11);
        let mut mesh = Mesh::new([5, 4].map(|n| Knots::uniform(degree, n, -1.0, 1.5).unwrap())).unwrap();
        for cell in [CellId { level: 3, place: [13, 21] }, CellId { level: 5, place: [150, 8] }] {
            mesh.refine(cell).unwrap();
        }
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let coefficients = (0..space.unknowns()).map(|_| draw.uniform()).collect();
        HierarchicalField::new(space, coefficients).unwrap()
    }

    #[test]
    fn every_patch_is_the_surface() {
        let mut draw = Lcg::new(12);
        for degree in 2..=5 {
            let field = rough(degree);
            let FieldPatches { patches, .. } = field.patches().unwrap();
            assert!(patches.len() > 3);
            let numbers: usize = patches.iter().map(|patch| patch.surface.coefficients().len()).sum();
            let [n, m] = field.tensor_size();
            assert!(numbers == field.patch_coefficients() && numbers < n * m / 2, "{numbers} of {n} x {m}");
            for patch in &patches {
                let [x, y] = patch.surface.knots().each_ref().map(Knots::domain);
                for _ in 0..40 {
                    let [u, v] = [x, y].map(|[lo, hi]| lo + (hi - lo) * draw.uniform());
                    let (a, b) = (field.at(u, v), patch.surface.at(u, v));
                    assert!((a.z - b.z).abs() < 1e-13 && (a.zx - b.zx).abs() < 1e-11 && (a.zyy - b.zyy).abs() < 1e-8);
                }
            }
        }
    }

    #[test]
    fn every_edge_is_that_of_both_patches() {
        let field = rough(3);
        let FieldPatches { patches, edges } = field.patches().unwrap();
        let inside = edges.iter().filter(|edge| edge.sides.iter().all(Option::is_some)).count();
        assert!(inside > patches.len() && edges.iter().all(|edge| edge.sides.iter().any(Option::is_some)));
        for edge in &edges {
            let [lo, hi] = edge.knots.domain();
            for k in 0..=8 {
                let t = lo + (hi - lo) * f64::from(k) / 8.0;
                let row = edge.knots.basis(t);
                let along = row.derivative(0).iter().zip(&edge.heights[row.first..]);
                let z: f64 = along.map(|(b, c)| b * c).sum();
                let at = if edge.axis == 0 { [t, edge.across] } else { [edge.across, t] };
                for patch in edge.sides.into_iter().flatten() {
                    assert!((patches[patch].surface.at(at[0], at[1]).z - z).abs() < 1e-13);
                }
            }
        }
        // round every patch the pieces close
        for (number, patch) in patches.iter().enumerate() {
            let deepest = field.space().mesh().tree().deepest() as u8;
            let around: u32 = 2 * patch.rectangle.in_level(deepest).sides().iter().sum::<u32>();
            let beside = edges.iter().filter(|edge| edge.sides.contains(&Some(number)));
            let length = |edge: &PatchEdge| (0..2).map(|k| edge.ends[1][k] - edge.ends[0][k]).sum::<u32>();
            assert_eq!(beside.map(length).sum::<u32>(), around);
        }
    }
}
