//! A hierarchical surface elsewhere, and as the tensor spline that it is a thin form of.

use std::sync::Arc;

use super::HierarchicalField;
use crate::error::HierarchyError;
use crate::mesh::{CellId, Mesh};
use crate::space::HierarchicalSpace;
use palpate_geometry::surface::HeightField;
use palpate_numeric::bspline::Knots;

impl HierarchicalField {
    /// The same surface under `x -> ox + s x`, `y -> oy + s y`, `z -> oz + s z`.
    ///
    /// # Errors
    /// When the map leaves the finite numbers or makes distinct knots equal.
    pub fn placed(&self, origin: [f64; 3], scale: f64) -> Result<HierarchicalField, HierarchyError> {
        let mesh = self.space().mesh();
        let base = mesh.levels().at(0);
        let axis = |k: usize| {
            let knots = base[k].knots();
            let moved = knots.as_slice().iter().map(|t| origin[k] + scale * t).collect();
            let name = if k == 0 { "x" } else { "y" };
            Knots::new(knots.degree(), moved).map_err(|source| HierarchyError::Knots { axis: name, source })
        };
        let moved = Mesh::of_splits([axis(0)?, axis(1)?], mesh.splits())?;
        let heights = self.coefficients().iter().map(|c| origin[2] + scale * c).collect();
        HierarchicalField::new(Arc::new(HierarchicalSpace::new(moved)), heights)
    }

    /// Coefficients that the tensor spline of the finest level has.
    pub fn tensor_size(&self) -> [usize; 2] {
        let mesh = self.space().mesh();
        mesh.levels().at(mesh.tree().deepest()).map(|level| level.knots().n_basis())
    }

    /// The tensor spline of the finest level: the same surface, its detail everywhere.
    ///
    /// # Errors
    /// Where two knots of a level are the same number.
    pub fn to_tensor(&self) -> Result<HeightField, HierarchyError> {
        let mesh = self.space().mesh();
        let base = mesh.levels().at(0).map(|level| level.knots().clone());
        let (deepest, grid) = (mesh.tree().deepest(), mesh.tree().base());
        let mut fine = Mesh::new(base)?;
        for level in 0..deepest {
            let places = |axis: usize| 0..(grid[axis] << level) as u32;
            for i in places(0) {
                places(1).try_for_each(|j| fine.refine(CellId { level: level as u8, place: [i, j] }))?;
            }
        }
        let tensor = self.embedded(Arc::new(HierarchicalSpace::new(fine)))?;
        let knots = mesh.levels().at(deepest).map(|level| level.knots().clone());
        HeightField::new(knots, tensor.coefficients()).map_err(|source| HierarchyError::Knots { axis: "x", source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    fn scratched() -> HierarchicalField {
        let knots = |n| Knots::uniform(3, n, -1.0, 1.0).unwrap();
        let mut mesh = Mesh::new([knots(4), knots(3)]).unwrap();
        mesh.refine(CellId { level: 2, place: [9, 5] }).unwrap();
        let space = Arc::new(HierarchicalSpace::new(mesh));
        let mut draw = Lcg::new(3);
        let coefficients = (0..space.unknowns()).map(|_| draw.uniform()).collect();
        HierarchicalField::new(space, coefficients).unwrap()
    }

    #[test]
    fn a_moved_surface_is_the_same_elsewhere() {
        let field = scratched();
        let moved = field.placed([500.0, -40.0, 7.0], 8.0).unwrap();
        assert_eq!(moved.space().functions(), field.space().functions());
        let mut draw = Lcg::new(4);
        for _ in 0..200 {
            let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
            let (a, b) = (field.at(x, y), moved.at(500.0 + 8.0 * x, 8.0 * y - 40.0));
            assert!((7.0 + 8.0 * a.z - b.z).abs() < 1e-12 && (a.zx - b.zx).abs() < 1e-10);
            assert!((a.zxy / 8.0 - b.zxy).abs() < 1e-9);
        }
    }

    #[test]
    fn the_tensor_spline_of_the_finest_level_is_the_same_surface() {
        let field = scratched();
        let tensor = field.to_tensor().unwrap();
        assert_eq!([tensor.coefficients().nrows(), tensor.coefficients().ncols()], field.tensor_size());
        let mut draw = Lcg::new(5);
        for _ in 0..200 {
            let [x, y] = [0, 1].map(|_| 2.0 * draw.uniform() - 1.0);
            let (a, b) = (field.at(x, y), tensor.at(x, y));
            assert!((a.z - b.z).abs() < 1e-14 && (a.zx - b.zx).abs() < 1e-12 && (a.zyy - b.zyy).abs() < 1e-10);
        }
    }

    #[test]
    fn a_hierarchy_is_made_again_from_its_splits() {
        let field = scratched();
        let mesh = field.space().mesh();
        let base = mesh.levels().at(0).map(|level| level.knots().clone());
        let again = Mesh::of_splits(base.clone(), mesh.splits()).unwrap();
        let again = HierarchicalField::new(Arc::new(HierarchicalSpace::new(again)), field.coefficients().to_vec());
        assert_eq!(again.unwrap(), field);
        let wrong = Mesh::of_splits(base, [CellId { level: 1, place: [8, 0] }]).unwrap_err();
        assert_eq!(wrong, HierarchyError::Place { level: 1, place: [8, 0] });
    }
}
