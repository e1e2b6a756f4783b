//! S, R, curvatures and their directions over a grid in (u, v) of a parametric surface.

use ndarray::Array2;

use super::support::supported;
use super::{ShapeGrid, ShapeMaps, Support};
use crate::surface::{Parametric, SurfacePoint};
use palpate_numeric::bspline::{BasisRow, Knots};

type Vector = [f64; 3];

/// Maps over (u, v), input units.
///
/// ```
/// # use palpate_geometry::facade as palpate;
/// use palpate::spline::Knots;
/// use palpate_geometry::shape::{UvSupport, parametric_maps, uv_grid};
/// use palpate::spline::Parametric;
///
/// // a parabolic sheet over u; the support is the triangle (0, 0), (1, 0), (0, 1)
/// let axis = Knots::uniform(2, 1, 0.0, 1.0)?;
/// let (u, height) = ([0.0, 0.5, 1.0], [0.0, 0.0, 1.0]);
/// let free: Vec<[f64; 3]> = (0..9).map(|k| [u[k / 3], u[k % 3], height[k / 3]]).collect();
/// let surface = Parametric::from_free([axis.clone(), axis.clone()], &free)?;
/// let support = UvSupport::new(vec![[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]], [None, None]);
/// let maps = parametric_maps(&surface, uv_grid([&axis, &axis], [2, 2], 0.1), &support);
/// assert!(maps.supported[[0, 0]] && !maps.supported[[1, 1]]);
/// assert!((maps.shape_index[[0, 0]] + 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParametricMaps {
    /// The points in u (as `x`) and v (as `y`).
    pub grid: ShapeGrid,
    /// Points in space.
    pub points: Array2<Vector>,
    /// Unit normals to the free side.
    pub normals: Array2<Vector>,
    /// Larger principal curvature; NaN where undefined, as all of the following.
    pub k1: Array2<f64>,
    /// Smaller principal curvature.
    pub k2: Array2<f64>,
    /// Unit direction of k1 in space.
    pub direction: Array2<Vector>,
    /// Shape index.
    pub shape_index: Array2<f64>,
    /// Curvedness.
    pub curvedness: Array2<f64>,
    /// Whether contacts surround the point.
    pub supported: Array2<bool>,
}

/// A grid over (u, v). In a closed direction the upper end, which is the lower end again, is left out.
pub fn uv_grid(knots: [&Knots; 2], points: [usize; 2], inset: f64) -> ShapeGrid {
    let domain = knots.map(Knots::domain);
    let mut grid = ShapeGrid::over(domain, points, inset);
    for (k, axis) in [&mut grid.x, &mut grid.y].into_iter().enumerate() {
        if knots[k].is_closed() {
            let ([lo, hi], n) = (domain[k], axis.len() as f64);
            axis.iter_mut().enumerate().for_each(|(i, t)| *t = lo + (hi - lo) * i as f64 / n);
        }
    }
    grid
}

/// Evaluates the surface and its shape over `grid`, where `support` holds.
pub fn parametric_maps(surface: &Parametric, grid: ShapeGrid, support: &impl Support) -> ParametricMaps {
    let held = supported(&grid, support);
    parametric_maps_at(surface, grid, &held)
}

/// The same where `held` says so, point by point of the grid.
pub fn parametric_maps_at(surface: &Parametric, grid: ShapeGrid, held: &Array2<bool>) -> ParametricMaps {
    let size = (grid.x.len(), grid.y.len());
    let nan = Array2::from_elem(size, f64::NAN);
    let mut maps = ParametricMaps {
        points: Array2::from_elem(size, [0.0; 3]),
        normals: Array2::from_elem(size, [f64::NAN; 3]),
        direction: Array2::from_elem(size, [f64::NAN; 3]),
        k1: nan.clone(),
        k2: nan.clone(),
        shape_index: nan.clone(),
        curvedness: nan,
        supported: Array2::from_elem(size, false),
        grid,
    };
    let along_v: Vec<BasisRow> = maps.grid.y.iter().map(|v| surface.row(1, *v)).collect();
    for i in 0..size.0 {
        let along_u = surface.row(0, maps.grid.x[i]);
        for j in 0..size.1 {
            let here = surface.with_rows(&along_u, &along_v[j]);
            maps.points[[i, j]] = here.point;
            let Some(p) = here.principal().filter(|_| held[[i, j]]) else { continue };
            maps.supported[[i, j]] = true;
            (maps.k1[[i, j]], maps.k2[[i, j]]) = (p.k1, p.k2);
            (maps.normals[[i, j]], maps.direction[[i, j]]) = (p.normal, p.direction1);
            maps.shape_index[[i, j]] = p.shape_index().unwrap_or(f64::NAN);
            maps.curvedness[[i, j]] = p.curvedness();
        }
    }
    maps
}

impl ParametricMaps {
    /// The same maps under `P -> origin + scale P`, u and v scaled alike.
    pub fn placed(mut self, origin: Vector, scale: f64) -> ParametricMaps {
        for axis in [&mut self.grid.x, &mut self.grid.y] {
            axis.iter_mut().for_each(|t| *t *= scale);
        }
        self.points.mapv_inplace(|p| [0, 1, 2].map(|k| origin[k] + scale * p[k]));
        for map in [&mut self.k1, &mut self.k2, &mut self.curvedness] {
            map.mapv_inplace(|k| k / scale);
        }
        self
    }

    /// The maps over (u, v) as if it were (x, y), with z as the height, for pictures and saved arrays.
    pub fn flat(&self) -> ShapeMaps {
        ShapeMaps {
            rows: Default::default(),
            grid: self.grid.clone(),
            points: self.points.mapv(|p| SurfacePoint { z: p[2], ..SurfacePoint::default() }),
            k1: self.k1.clone(),
            k2: self.k2.clone(),
            shape_index: self.shape_index.clone(),
            curvedness: self.curvedness.clone(),
            supported: self.supported.clone(),
        }
    }

    /// Values of `map` at the supported points where they are defined.
    pub fn defined<'a>(&'a self, map: &'a Array2<f64>) -> impl Iterator<Item = f64> + Clone + 'a {
        let places = self.supported.indexed_iter().filter(|(_, supported)| **supported);
        places.map(|(at, _)| map[at]).filter(|v| !v.is_nan())
    }
}
