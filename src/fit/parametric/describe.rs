//! S, R, curvatures and their directions over a grid in (u, v), where contacts reach; means, uncertainty, class.
//!
//! ```text
//! u^2(mean S) = g' A^-1 g,   g = d(mean S)/dc,   A the Gauss-Newton matrix at the levels of the noise
//! ```

use ndarray::Array2;

use super::gradient::{INPUTS, shape_gradient};
use super::vector::{Vector, dot, minus, unit};
use super::{ParametricFit, problem};
use crate::curvature::ShapeClass;
use crate::fit::Statistic;
use crate::shape::{ShapeGrid, Spread, chi_square_upper_tail, class_probabilities, normal_interval, radius_of, spread};
use crate::surface::SpacePoint;

/// The level at which the best plane is rejected, as for height fields.
const PLANE_LEVEL: f64 = 0.01;
/// Mean R times the larger side below which a surface is flat to rounding.
const FLAT: f64 = 1e-9;
/// Steps of the best plane's normal; each is nine products.
const PLANE_STEPS: usize = 2000;

/// Maps over (u, v), input units.
#[derive(Clone, Debug)]
pub struct SpaceMaps {
    /// Where, in u (as `x`) and v (as `y`).
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

/// The shape of a surface in space, input units.
#[derive(Clone, Debug)]
pub struct ParametricShape {
    /// Maps over the grid.
    pub maps: SpaceMaps,
    /// Shape index S; all `None` for a plane.
    pub shape_index: Statistic,
    /// Curvedness R, 1/length.
    pub curvedness: Statistic,
    /// Class of the mean S, or plane.
    pub class: ShapeClass,
    /// Probability of each curved class; empty for a plane.
    pub class_probability: Vec<(ShapeClass, f64)>,
    /// Radius of the cap, cup, ridge or rut.
    pub radius: Option<f64>,
    /// Larger principal curvature.
    pub k1: Spread,
    /// Smaller principal curvature.
    pub k2: Spread,
    /// Unit direction of k1 in space at the supported grid point nearest the middle of (u, v).
    pub direction: Option<Vector>,
    /// Points used / grid points.
    pub support: f64,
    /// p-value of the best plane against the fit.
    pub plane_p: Option<f64>,
}

/// Describes the fit over the grid of its options.
pub fn describe(fit: &ParametricFit) -> ParametricShape {
    let (local, jets) = maps(fit);
    let scale = fit.frame.scale;
    let places: Vec<(usize, usize)> = local.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at).collect();
    let defined = |map: &Array2<f64>| {
        spread(places.iter().map(|at| map[*at]).filter(|v| !v.is_nan()).collect::<Vec<_>>().into_iter())
    };
    let (s, r) = (defined(&local.shape_index), defined(&local.curvedness));
    let [u_s, u_r] = uncertainties(fit, &jets, s.count);
    let plane_p = plane_probability(fit);
    let flat = r.mean.is_some_and(|r| r * 2.0 < FLAT);
    let curved = s.mean.filter(|_| !flat && plane_p.is_none_or(|p| p <= PLANE_LEVEL));
    let level = fit.options.level;
    let statistic = |spread: Spread, factor: f64, u: f64, floor: f64, ceiling: f64| Statistic {
        mean: spread.mean.map(|m| m * factor),
        sd: spread.sd.map(|m| m * factor),
        u: spread.mean.map(|_| u * factor),
        interval: spread.mean.map(|m| normal_interval(m * factor, u * factor, level, floor, ceiling)),
    };
    let class = curved.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    let curvedness = statistic(r, 1.0 / scale, u_r, 0.0, f64::INFINITY);
    let maps = in_input_units(local, fit);
    let of = |map: &Array2<f64>| {
        spread(places.iter().map(|at| map[*at]).filter(|v| !v.is_nan()).collect::<Vec<_>>().into_iter())
    };
    ParametricShape {
        shape_index: if curved.is_some() { statistic(s, 1.0, u_s, -1.0, 1.0) } else { Statistic::default() },
        radius: curvedness.mean.and_then(|mean| radius_of(class, mean)),
        curvedness,
        class,
        class_probability: curved.map_or(Vec::new(), |mean| class_probabilities(mean, u_s)),
        k1: of(&maps.k1),
        k2: of(&maps.k2),
        direction: curved.and_then(|_| direction(&maps)),
        support: s.count as f64 / maps.grid.len() as f64,
        plane_p,
        maps,
    }
}

/// Points of the grid: of a closed direction the upper end is the lower one again and left out.
fn grid(fit: &ParametricFit) -> ShapeGrid {
    let domain = [0, 1].map(|k| fit.cells.knots()[k].domain());
    let mut grid = ShapeGrid::over(domain, fit.options.grid, fit.options.inset);
    for (k, axis) in [&mut grid.x, &mut grid.y].into_iter().enumerate() {
        if fit.cells.knots()[k].is_closed() {
            let ([lo, hi], n) = (domain[k], axis.len() as f64);
            axis.iter_mut().enumerate().for_each(|(i, t)| *t = lo + (hi - lo) * i as f64 / n);
        }
    }
    grid
}

/// Maps in patch units, and the jets of the supported points.
fn maps(fit: &ParametricFit) -> (SpaceMaps, Vec<([f64; 2], SpacePoint)>) {
    let grid = grid(fit);
    let size = (grid.x.len(), grid.y.len());
    let nan = Array2::from_elem(size, f64::NAN);
    let mut maps = SpaceMaps {
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
    let mut jets = Vec::new();
    for i in 0..size.0 {
        for j in 0..size.1 {
            let (u, v) = (maps.grid.x[i], maps.grid.y[j]);
            let here = fit.surface.at(u, v);
            maps.points[[i, j]] = here.point;
            maps.supported[[i, j]] = fit.support.holds(u, v);
            let Some(p) = here.principal().filter(|_| maps.supported[[i, j]]) else { continue };
            (maps.k1[[i, j]], maps.k2[[i, j]]) = (p.k1, p.k2);
            (maps.normals[[i, j]], maps.direction[[i, j]]) = (p.normal, p.direction1);
            maps.shape_index[[i, j]] = p.shape_index().unwrap_or(f64::NAN);
            maps.curvedness[[i, j]] = p.curvedness();
            jets.push(([u, v], here));
        }
    }
    (maps, jets)
}

fn in_input_units(mut maps: SpaceMaps, fit: &ParametricFit) -> SpaceMaps {
    let scale = fit.frame.scale;
    for axis in [&mut maps.grid.x, &mut maps.grid.y] {
        axis.iter_mut().for_each(|t| *t *= scale);
    }
    maps.points.mapv_inplace(|p| fit.frame.to_input(p));
    for map in [&mut maps.k1, &mut maps.k2, &mut maps.curvedness] {
        map.mapv_inplace(|k| k / scale);
    }
    maps
}

/// Standard uncertainties of mean S and mean R, patch units.
fn uncertainties(fit: &ParametricFit, jets: &[([f64; 2], SpacePoint)], defined: usize) -> [f64; 2] {
    let unknowns = 3 * fit.cells.shape().coefficients();
    let mut sums = [vec![0.0; unknowns], vec![0.0; unknowns]];
    let (mut alive, mut products) = (Vec::new(), Vec::new());
    for ([u, v], point) in jets {
        let Some((by_s, by_r)) = shape_gradient(&point.derivatives) else { continue };
        let row = fit.cells.row(*u, *v);
        fit.cells.alive(&row, &mut alive);
        for (k, order) in [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].into_iter().enumerate() {
            row.products(order, &mut products);
            for (sum, by) in sums.iter_mut().zip([&by_s, &by_r]) {
                for (coefficient, product) in alive.iter().zip(&products) {
                    (0..3).for_each(|d| sum[3 * coefficient + d] += by[3 * k + d] * product);
                }
            }
        }
    }
    const { assert!(INPUTS == 15) };
    sums.map(|g| {
        let mut solved = g.clone();
        fit.solver.factor.solve(&mut solved);
        let square: f64 = g.iter().zip(&solved).map(|(a, b)| a * b).sum();
        square.max(0.0).sqrt() / defined.max(1) as f64
    })
}

fn direction(maps: &SpaceMaps) -> Option<Vector> {
    let middle = [&maps.grid.x, &maps.grid.y].map(|axis| 0.5 * (axis[0] + axis[axis.len() - 1]));
    let distance = |at: (usize, usize)| (maps.grid.x[at.0] - middle[0]).hypot(maps.grid.y[at.1] - middle[1]);
    let supported = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at);
    let at = supported.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    let (k1, k2) = (maps.k1[at], maps.k2[at]);
    // an umbilic has no direction; 1 % of the bending is what a spline leaves of one
    (k1 - k2 > 0.01 * k1.abs().max(k2.abs())).then_some(maps.direction[at]).filter(|d| d[0].is_finite())
}

/// Best plane against the fit by chi-square at the levels of the noise. Freedom counts every coefficient's one geometric
/// unknown less the plane's three, so a smoothed fit has fewer and the test leans to the plane.
fn plane_probability(fit: &ParametricFit) -> Option<f64> {
    let touches = &fit.touches;
    let freedom = fit.cells.shape().coefficients() as f64 - 3.0;
    let squares = |w: f64| w * w;
    let weight: f64 = touches.position_weight.iter().map(|w| squares(*w)).sum();
    if freedom <= 0.0 || weight <= 0.0 {
        return None;
    }
    let sum = |f: &dyn Fn(usize) -> Vector| {
        (0..touches.len()).fold([0.0; 3], |m, r| {
            let v = f(r);
            [0, 1, 2].map(|k| m[k] + v[k])
        })
    };
    let centre = sum(&|r| touches.points[r].map(|p| p * squares(touches.position_weight[r]) / weight));
    let problem::Weights { position, normal, .. } = fit.weights;
    let mut spread = [[0.0; 3]; 3];
    for r in 0..touches.len() {
        let d = minus(touches.points[r], centre).map(|v| v * touches.position_weight[r] / position);
        (0..3).for_each(|a| (0..3).for_each(|b| spread[a][b] += d[a] * d[b]));
    }
    let pull = sum(&|r| touches.normals[r].map(|n| n * squares(touches.normal_weight[r] / normal)));
    let pulled: f64 = touches.normal_weight.iter().map(|w| squares(w / normal)).sum();
    // minimise n'Cn - 2 n.s on the sphere: n <- unit((tr C - C) n + s) never goes up
    let trace = spread[0][0] + spread[1][1] + spread[2][2];
    let mut n = unit(pull);
    for _ in 0..PLANE_STEPS {
        let bent = spread.map(|row| dot(row, n));
        n = unit([0, 1, 2].map(|k| trace * n[k] - bent[k] + pull[k]));
    }
    let of_plane = dot(n, spread.map(|row| dot(row, n))) + 2.0 * (pulled - dot(n, pull));
    let of_fit: f64 = (fit.residuals.iter().enumerate())
        .map(|(r, [distance, turn])| {
            squares(distance * touches.position_weight[r] / position)
                + squares(turn * touches.normal_weight[r] / normal)
        })
        .sum();
    Some(chi_square_upper_tail((of_plane - of_fit).max(0.0), freedom))
}
