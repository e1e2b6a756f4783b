//! A height field over a hierarchical space: value and derivatives cell by cell, as fast as a tensor spline's.
//!
//! ```text
//! S(x, y) = sum_ab C_Q[a][b] N^l_a(x) M^l_b(y),   C_Q = E_Q c kept for every cell Q
//! ```

mod embedding;
#[cfg(test)]
mod gismo_tests;
mod patches;
mod placed;
#[cfg(test)]
mod space_tests;

use std::sync::Arc;

pub use patches::{FieldPatches, PatchEdge, TensorPatch};

use crate::error::HierarchyError;
use crate::space::HierarchicalSpace;
use palpate_geometry::surface::{Heights, Jet, Surface, SurfacePoint};
use palpate_numeric::threads;

/// Cells whose tables one thread makes at a time.
const PIECE: usize = 256;

/// A surface `z = S(x, y)` of truncated hierarchical B-splines, lengths in the unit of its knots and coefficients.
///
/// ```
/// use std::sync::Arc;
/// use palpate_hierarchical::{field::HierarchicalField, mesh::{CellId, Mesh}, space::HierarchicalSpace};
/// use palpate_numeric::bspline::Knots;
///
/// let mut mesh = Mesh::new([Knots::uniform(2, 4, 0.0, 1.0)?, Knots::uniform(2, 4, 0.0, 1.0)?])?;
/// mesh.refine(CellId { level: 0, place: [1, 2] })?;
/// let space = Arc::new(HierarchicalSpace::new(mesh));
/// // the functions sum to one
/// let ones = vec![1.0; space.unknowns()];
/// let field = HierarchicalField::new(space, ones)?;
/// let point = field.at(0.3, 0.6);
/// assert!((point.z - 1.0).abs() < 1e-15 && point.zx.abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct HierarchicalField {
    space: Arc<HierarchicalSpace>,
    coefficients: Vec<f64>,
    /// (p + 1)(q + 1) numbers for every leaf.
    tables: Vec<f64>,
}

/// The same cells, knots and coefficients; the tables follow from them.
impl PartialEq for HierarchicalField {
    fn eq(&self, other: &HierarchicalField) -> bool {
        let bases = [self, other].map(|field| field.space.mesh().levels().at(0).map(|level| level.knots()));
        bases[0] == bases[1] && self.space.leaves() == other.space.leaves() && self.coefficients == other.coefficients
    }
}

impl HierarchicalField {
    /// A surface from a space and one coefficient for each of its functions.
    ///
    /// # Errors
    /// [`HierarchyError::Coefficients`], [`HierarchyError::NotFinite`].
    pub fn new(space: Arc<HierarchicalSpace>, coefficients: Vec<f64>) -> Result<HierarchicalField, HierarchyError> {
        if coefficients.len() != space.unknowns() {
            return Err(HierarchyError::Coefficients { found: coefficients.len(), expected: space.unknowns() });
        }
        if let Some(index) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(HierarchyError::NotFinite { index });
        }
        let count = space.local_count();
        let mut tables = vec![0.0; space.leaves().len() * count];
        let mut pieces: Vec<&mut [f64]> = tables.chunks_mut(PIECE * count).collect();
        threads::each(&mut pieces, |piece, tables| {
            for (k, table) in tables.chunks_exact_mut(count).enumerate() {
                space.local_coefficients(piece * PIECE + k, &coefficients, table);
            }
        });
        Ok(HierarchicalField { space, coefficients, tables })
    }

    /// The space.
    pub fn space(&self) -> &Arc<HierarchicalSpace> {
        &self.space
    }

    /// One number for each function.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Coefficients of the B-splines of a leaf's level on the leaf: y runs fastest.
    pub fn table(&self, leaf: usize) -> &[f64] {
        let count = self.space.local_count();
        &self.tables[leaf * count..(leaf + 1) * count]
    }

    /// Those of all leaves, one behind the other.
    pub fn tables(&self) -> &[f64] {
        &self.tables
    }

    /// Height, slopes and second derivatives at `(x, y)`; outside the domain the end polynomials are extended.
    pub fn at(&self, x: f64, y: f64) -> SurfacePoint {
        self.at_on(self.space.leaf_at([x, y]), x, y)
    }

    /// The same with the polynomial of a leaf wherever `(x, y)` is.
    pub fn at_on(&self, leaf: usize, x: f64, y: f64) -> SurfacePoint {
        let place = self.space.leaves()[leaf].place.map(|k| k as usize);
        let [kx, ky] = self.space.knots_of(leaf);
        let (bx, by) = (kx.basis_on(place[0], x), ky.basis_on(place[1], y));
        let table = self.table(leaf);
        let width = ky.degree() + 1;
        SurfacePoint::of_rows(&bx, &by, |i, j| table[(i - bx.first) * width + j - by.first])
    }
}

impl Heights for HierarchicalField {
    fn height_at(&self, x: f64, y: f64) -> SurfacePoint {
        self.at(x, y)
    }
}

impl Surface for HierarchicalField {
    fn domain(&self) -> [[f64; 2]; 2] {
        self.space.mesh().levels().at(0).map(|level| level.knots().domain())
    }

    fn closed(&self) -> [bool; 2] {
        [false; 2]
    }

    fn unknowns(&self) -> usize {
        self.coefficients.len()
    }

    fn jet(&self, [x, y]: [f64; 2]) -> Jet {
        let here = self.at(x, y);
        Jet { point: [x, y, here.z], derivatives: here.derivatives() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{CellId, Mesh};
    use ndarray::Array2;
    use palpate_geometry::surface::HeightField;
    use palpate_numeric::bspline::Knots;

    /// Everything refined twice: the tensor spline of level 2, bit for bit but where a place lies within rounding of a knot.
    #[test]
    fn a_uniform_hierarchy_is_the_tensor_spline() {
        for degree in 2..=5 {
            let knots = |segments| Knots::uniform(degree, segments, -0.7, 1.9).unwrap();
            let mut mesh = Mesh::new([knots(3), knots(2)]).unwrap();
            for level in 0..2u8 {
                for i in 0..3 << level {
                    (0..2 << level).for_each(|j| mesh.refine(CellId { level, place: [i, j] }).unwrap());
                }
            }
            let space = Arc::new(HierarchicalSpace::new(mesh));
            let shape = (12 + degree, 8 + degree);
            assert_eq!(space.unknowns(), shape.0 * shape.1);
            let c: Vec<f64> = (0..space.unknowns()).map(|k| (0.37 * k as f64).sin()).collect();
            let tensor = HeightField::new([knots(12), knots(8)], Array2::from_shape_vec(shape, c.clone()).unwrap());
            let (tensor, field) = (tensor.unwrap(), HierarchicalField::new(space, c).unwrap());
            for k in 0..2000 {
                let at = [0.618_034, 0.754_878].map(|g: f64| -0.7 + 2.6 * (g * f64::from(k)).fract());
                assert_eq!(field.at(at[0], at[1]), tensor.at(at[0], at[1]), "degree {degree} {at:?}");
            }
            let [p, q] = [field.jet([0.2, 0.3]), tensor.jet([0.2, 0.3])].map(|jet| jet.principal().unwrap());
            assert_eq!((p.shape_index(), p.curvedness()), (q.shape_index(), q.curvedness()));
        }
    }

    #[test]
    fn coefficients_that_fit_nothing_are_refused() {
        let knots = || Knots::uniform(3, 2, 0.0, 1.0).unwrap();
        let space = Arc::new(HierarchicalSpace::new(Mesh::new([knots(), knots()]).unwrap()));
        let refused = |c: Vec<f64>| HierarchicalField::new(space.clone(), c).unwrap_err();
        assert_eq!(refused(vec![0.0; 3]), HierarchyError::Coefficients { found: 3, expected: 25 });
        assert_eq!(refused([vec![0.0; 24], vec![f64::NAN]].concat()), HierarchyError::NotFinite { index: 24 });
    }
}
