//! Heights, principal curvatures, S and R at every point of a grid.

use ndarray::Array2;

use super::ShapeGrid;
use crate::curvature::principal_curvatures;
use crate::surface::{HeightField, SurfacePoint};

/// Maps over a shape grid, indexed [x, y]. Undefined entries are NaN inside; ask [`ShapeMaps::shape_index_at`].
#[derive(Clone, Debug)]
pub struct ShapeMaps {
    /// Where.
    pub grid: ShapeGrid,
    /// Height and derivatives.
    pub points: Array2<SurfacePoint>,
    /// Larger principal curvature.
    pub k1: Array2<f64>,
    /// Smaller principal curvature.
    pub k2: Array2<f64>,
    /// Shape index, NaN where both curvatures vanish.
    pub shape_index: Array2<f64>,
    /// Curvedness.
    pub curvedness: Array2<f64>,
    /// Whether the data determine every coefficient that this point depends on.
    pub supported: Array2<bool>,
}

impl ShapeMaps {
    /// Shape index at point (i, j); `None` where it is undefined or the data do not reach.
    pub fn shape_index_at(&self, i: usize, j: usize) -> Option<f64> {
        let s = self.shape_index[[i, j]];
        (self.supported[[i, j]] && !s.is_nan()).then_some(s)
    }

    /// Curvedness at point (i, j); `None` where the data do not reach.
    pub fn curvedness_at(&self, i: usize, j: usize) -> Option<f64> {
        self.supported[[i, j]].then_some(self.curvedness[[i, j]])
    }
}

/// Evaluates the surface and its shape over `grid`; `unsupported` lists coefficients (number `i m + j`) without data.
pub fn shape_maps(surface: &HeightField, grid: ShapeGrid, unsupported: &[usize]) -> ShapeMaps {
    let size = (grid.x.len(), grid.y.len());
    let free = flags(surface, unsupported);
    let mut maps = ShapeMaps {
        points: Array2::default(size),
        k1: Array2::zeros(size),
        k2: Array2::zeros(size),
        shape_index: Array2::zeros(size),
        curvedness: Array2::zeros(size),
        supported: Array2::from_elem(size, true),
        grid,
    };
    for i in 0..size.0 {
        for j in 0..size.1 {
            let (x, y) = (maps.grid.x[i], maps.grid.y[j]);
            let point = surface.at(x, y);
            maps.points[[i, j]] = point;
            if let Some(p) = principal_curvatures(&point.derivatives()) {
                (maps.k1[[i, j]], maps.k2[[i, j]]) = (p.k1, p.k2);
                maps.shape_index[[i, j]] = p.shape_index().unwrap_or(f64::NAN);
                maps.curvedness[[i, j]] = p.curvedness();
            }
            if let Some(free) = &free {
                maps.supported[[i, j]] = is_supported(surface, free, x, y);
            }
        }
    }
    maps
}

fn flags(surface: &HeightField, unsupported: &[usize]) -> Option<Array2<bool>> {
    if unsupported.is_empty() {
        return None;
    }
    let mut free = Array2::from_elem(surface.coefficients().dim(), false);
    let columns = free.ncols();
    unsupported.iter().for_each(|&u| free[[u / columns, u % columns]] = true);
    Some(free)
}

fn is_supported(surface: &HeightField, free: &Array2<bool>, x: f64, y: f64) -> bool {
    let [bx, by] = [surface.knots()[0].basis(x), surface.knots()[1].basis(y)];
    // a basis function counts where it or a derivative up to the second enters the shape
    let alive = |row: &crate::bspline::BasisRow, a: usize| (0..3).any(|k| row.derivative(k)[a] != 0.0);
    (0..bx.derivative(0).len())
        .filter(|&a| alive(&bx, a))
        .all(|a| (0..by.derivative(0).len()).filter(|&b| alive(&by, b)).all(|b| !free[[bx.first + a, by.first + b]]))
}
