//! The grid that shape is averaged over: equally spaced points over the domain less an inset, both ends included.

use palpate_numeric::bspline::{BasisRow, Knots, linspace};

/// Points of the shape grid, in the coordinates of the surface's knots.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use palpate::geometry::ShapeGrid;
///
/// // 3 x 2 points over [0, 10] x [0, 1], a tenth of every side left out at each end
/// let grid = ShapeGrid::over([[0.0, 10.0], [0.0, 1.0]], [3, 2], 0.1);
/// assert_eq!((grid.x, grid.y), (vec![1.0, 5.0, 9.0], vec![0.1, 0.9]));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ShapeGrid {
    /// x coordinates.
    pub x: Vec<f64>,
    /// y coordinates.
    pub y: Vec<f64>,
}

impl ShapeGrid {
    /// `points[0] x points[1]` points over `[x0, x1] x [y0, y1]`, every edge cut by the fraction `inset` of its side.
    pub fn over(domain: [[f64; 2]; 2], points: [usize; 2], inset: f64) -> ShapeGrid {
        let axis = |[lo, hi]: [f64; 2], n: usize| {
            let cut = inset * (hi - lo);
            linspace(lo + cut, hi - cut, n)
        };
        ShapeGrid { x: axis(domain[0], points[0]), y: axis(domain[1], points[1]) }
    }

    /// Basis rows along the two axes; the basis at a point is the product of one row of each.
    pub fn rows(&self, knots: &[Knots; 2]) -> [Vec<BasisRow>; 2] {
        let along = |axis: &[f64], knots: &Knots| axis.iter().map(|at| knots.basis(*at)).collect();
        [along(&self.x, &knots[0]), along(&self.y, &knots[1])]
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.x.len() * self.y.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
