//! Heights, principal curvatures, S and R at every point of a grid, and their means over the points that data support.

use std::sync::Arc;

use ndarray::Array2;

use super::ShapeGrid;
use crate::surface::{CurvatureGrid, HeightField, Heights, SurfacePoint};
use palpate_numeric::bspline::BasisRow;

/// Above this number of points the derivatives are computed row by row from one polynomial per segment. They equal those
/// computed point by point up to rounding, and take a fraction of the time.
const MANY: usize = 4096;

/// Maps over a shape grid, indexed [x, y]. Undefined entries are NaN; [`ShapeMaps::shape_index_at`] returns `None` there.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use ndarray::Array2;
/// use palpate::spline::Knots;
/// use palpate::geometry::ShapeGrid;
/// use palpate::spline::HeightField;
///
/// // z = x^2 is a rut along y: S = -1/2, and R = sqrt 2 at its bottom
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let coefficients = Array2::from_shape_fn((3, 3), |(i, _)| if i == 1 { -1.0 } else { 1.0 });
/// let surface = HeightField::new([axis.clone(), axis], coefficients)?;
/// let maps = surface.shape_maps(ShapeGrid::over([[-1.0, 1.0]; 2], [3, 3], 0.0), &[]);
/// assert!(maps.shape_index_at(1, 1).is_some_and(|s| (s + 0.5).abs() < 1e-12));
/// assert!((maps.curvedness[[1, 1]] - 2.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ShapeMaps {
    /// The points.
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
    /// Basis rows along both axes, by the knots of the surface; empty for a parametric surface.
    pub rows: Arc<[Vec<BasisRow>; 2]>,
}

impl ShapeMaps {
    /// Shape index at point (i, j); `None` where it is undefined or not supported by data.
    pub fn shape_index_at(&self, i: usize, j: usize) -> Option<f64> {
        let s = self.shape_index[[i, j]];
        (self.supported[[i, j]] && !s.is_nan()).then_some(s)
    }

    /// Curvedness at point (i, j); `None` where it is not supported by data.
    pub fn curvedness_at(&self, i: usize, j: usize) -> Option<f64> {
        self.supported[[i, j]].then_some(self.curvedness[[i, j]])
    }
}

/// Mean and sample standard deviation (n - 1) of the defined values: variation over the patch, not uncertainty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spread {
    /// Mean; `None` with fewer than 2 points.
    pub mean: Option<f64>,
    /// Sample sd; `None` with fewer than 2 points.
    pub sd: Option<f64>,
    /// Number of points.
    pub count: usize,
}

/// Spread of `values`, in two passes, the second about the mean.
pub fn spread(values: impl Iterator<Item = f64> + Clone) -> Spread {
    let count = values.clone().count();
    if count < 2 {
        return Spread { count, ..Spread::default() };
    }
    let mean = values.clone().sum::<f64>() / count as f64;
    let squares: f64 = values.map(|v| (v - mean) * (v - mean)).sum();
    Spread { mean: Some(mean), sd: Some((squares / (count - 1) as f64).sqrt()), count }
}

impl ShapeMaps {
    /// Rows and columns of the grid points that the data support.
    pub(crate) fn supported_points(&self) -> impl Iterator<Item = (usize, usize)> + Clone + '_ {
        let columns = self.grid.y.len();
        (0..self.grid.len()).map(move |k| (k / columns, k % columns)).filter(|&(i, j)| self.supported[[i, j]])
    }

    /// Mean and sd of S over the supported points where it is defined.
    pub fn spread_of_shape_index(&self) -> Spread {
        let defined = self.supported_points().filter(|&(i, j)| self.shape_index_at(i, j).is_some());
        spread(defined.map(|at| self.shape_index[at]))
    }

    /// Mean and sd over the supported points of k1, k2 or R, in units in which the patch's length is `scale`.
    pub fn spread_of(&self, map: &Array2<f64>, scale: f64) -> Spread {
        spread(self.supported_points().map(|at| map[at] / scale))
    }
}

impl ShapeMaps {
    /// Curvatures, S and R where height and derivatives are known; all of it supported by data.
    pub fn of_points(grid: ShapeGrid, points: Array2<SurfacePoint>, rows: Arc<[Vec<BasisRow>; 2]>) -> ShapeMaps {
        let size = points.dim();
        let mut maps = ShapeMaps {
            k1: Array2::zeros(size),
            k2: Array2::zeros(size),
            shape_index: Array2::zeros(size),
            curvedness: Array2::zeros(size),
            supported: Array2::from_elem(size, true),
            points,
            rows,
            grid,
        };
        for (at, point) in maps.points.indexed_iter() {
            if let Some(p) = point.derivatives().principal() {
                (maps.k1[at], maps.k2[at]) = (p.k1, p.k2);
                maps.shape_index[at] = p.shape_index().unwrap_or(f64::NAN);
                maps.curvedness[at] = p.curvedness();
            }
        }
        maps
    }

    /// The same of any surface of heights, point by point.
    pub fn of_heights(surface: &dyn Heights, grid: ShapeGrid) -> ShapeMaps {
        let at = |(i, j): (usize, usize)| surface.height_at(grid.x[i], grid.y[j]);
        let points = Array2::from_shape_fn((grid.x.len(), grid.y.len()), at);
        ShapeMaps::of_points(grid, points, Arc::new([Vec::new(), Vec::new()]))
    }
}

impl HeightField {
    /// Heights, curvatures, S and R: evaluates the surface and its shape over `grid`; `unsupported` lists coefficients (number `i m + j`) without data.
    pub fn shape_maps(&self, grid: ShapeGrid, unsupported: &[usize]) -> ShapeMaps {
        let rows = Arc::new(grid.rows(self.knots()));
        let mut points = Array2::default((grid.x.len(), grid.y.len()));
        fill_points(self, &grid, &rows, &mut points);
        let mut maps = ShapeMaps::of_points(grid, points, rows.clone());
        if let Some(free) = flags(self, unsupported) {
            let supported =
                |((i, j), s): ((usize, usize), &mut bool)| *s = is_supported(&free, &rows[0][i], &rows[1][j]);
            maps.supported.indexed_iter_mut().for_each(supported);
        }
        maps
    }
}

fn fill_points(
    surface: &HeightField,
    grid: &ShapeGrid,
    [along_x, along_y]: &[Vec<BasisRow>; 2],
    points: &mut Array2<SurfacePoint>,
) {
    let ascending = grid.y.is_sorted();
    let coefficients = surface.coefficients().as_standard_layout();
    match coefficients.as_slice() {
        Some(c) if points.len() > MANY && ascending => {
            CurvatureGrid::new(surface.knots(), &grid.x, &grid.y).derivatives(c, |i, [z, zx, zy, zxx, zxy, zyy]| {
                for (j, point) in points.row_mut(i).iter_mut().enumerate() {
                    *point = SurfacePoint { z: z[j], zx: zx[j], zy: zy[j], zxx: zxx[j], zxy: zxy[j], zyy: zyy[j] };
                }
            });
        }
        _ => points.indexed_iter_mut().for_each(|((i, j), point)| *point = surface.with_rows(&along_x[i], &along_y[j])),
    }
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

fn is_supported(free: &Array2<bool>, bx: &BasisRow, by: &BasisRow) -> bool {
    // a basis function matters where it or a derivative up to the second is not zero
    let alive = |row: &BasisRow, a: usize| (0..3).any(|k| row.derivative(k)[a] != 0.0);
    (0..bx.derivative(0).len())
        .filter(|&a| alive(bx, a))
        .all(|a| (0..by.derivative(0).len()).filter(|&b| alive(by, b)).all(|b| !free[[bx.first + a, by.first + b]]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::bspline::Knots;

    #[test]
    fn rows_and_points_give_the_same_maps() {
        let knots = [Knots::uniform(3, 5, 0.0, 1.0).unwrap(), Knots::uniform(2, 4, -1.0, 1.0).unwrap()];
        let c = Array2::from_shape_fn((8, 6), |(i, j)| (i as f64 * 0.9 + j as f64 * 0.4).sin());
        let surface = HeightField::new(knots, c).unwrap();
        let grid = ShapeGrid::over([[0.0, 1.0], [-1.0, 1.0]], [70, 81], 0.0);
        assert!(grid.len() > MANY);
        let maps = surface.shape_maps(grid, &[]);
        for ((i, j), point) in maps.points.indexed_iter() {
            let expected = surface.at(maps.grid.x[i], maps.grid.y[j]);
            let near = |a: f64, b: f64, size: f64| (a - b).abs() < 1e-13 * size;
            assert!(near(point.z, expected.z, 1.0) && near(point.zx, expected.zx, 10.0));
            assert!(near(point.zy, expected.zy, 10.0) && near(point.zxx, expected.zxx, 100.0));
            assert!(near(point.zxy, expected.zxy, 100.0) && near(point.zyy, expected.zyy, 100.0));
        }
    }
}
