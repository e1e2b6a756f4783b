//! S, R, curvatures and their directions over a grid in (u, v), where contacts reach; means, uncertainty, class.
//!
//! ```text
//! u^2(mean S) = g' A^-1 g,   g = d(mean S)/dc,   A the Gauss-Newton matrix at the noise sds
//! ```

use super::fit_data::FitData;
use super::problem;
use super::vector::{Vector, cross, dot, minus, unit};
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{
    INPUTS, ParametricMaps, ShapeReport, Spread, Statistic, chi_square_upper_tail, class_probabilities, jet_gradient,
    normal_interval, parametric_maps, radius_of, spread, uv_grid,
};

/// The significance level at which the best plane is rejected, as for height fields.
const PLANE_LEVEL: f64 = 0.01;
/// Mean R times the larger side below which a surface is flat to rounding.
const FLAT: f64 = 1e-9;
/// Steps of the iteration for the normal of the best plane; each takes nine products.
const PLANE_STEPS: usize = 2000;

/// The shape of a parametric surface, input units.
pub type ParametricShape = ShapeReport<ParametricMaps>;

/// Describes the fit over the grid of its options.
pub(super) fn describe(fit: &FitData) -> ParametricShape {
    let domain = [0, 1].map(|k| &fit.cells.knots()[k]);
    let grid = uv_grid(domain, fit.options.grid, fit.options.inset);
    let local = parametric_maps(&fit.surface, grid, &fit.support);
    let scale = fit.frame.scale;
    let (s, r) = (spread(local.defined(&local.shape_index)), spread(local.defined(&local.curvedness)));
    let [u_s, u_r] = uncertainties(fit, &local, s.count);
    let plane_p = plane_probability(fit);
    let flat = r.mean.is_some_and(|r| r * 2.0 < FLAT);
    let curved = s.mean.filter(|_| !flat && plane_p.is_none_or(|p| p <= PLANE_LEVEL));
    let level = fit.options.level;
    let statistic = |spread: Spread, factor: f64, u: f64, floor: f64, ceiling: f64| Statistic {
        mean: spread.mean.map(|m| m * factor),
        sd: spread.sd.map(|m| m * factor),
        u: spread.mean.map(|_| u * factor),
        interval: spread.mean.map(|m| normal_interval(m * factor, u * factor, level, floor, ceiling)),
        ..Statistic::default()
    };
    let class = curved.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    let curvedness = statistic(r, 1.0 / scale, u_r, 0.0, f64::INFINITY);
    let maps = local.placed(fit.frame.origin, scale);
    let directions = curved.and_then(|_| directions(&maps));
    ParametricShape {
        shape_index: if curved.is_some() { statistic(s, 1.0, u_s, -1.0, 1.0) } else { Statistic::default() },
        radius: curvedness.mean.and_then(|mean| radius_of(class, mean)),
        curvedness,
        class,
        class_probability: curved.map_or(Vec::new(), |mean| class_probabilities(mean, u_s)),
        k1: spread(maps.defined(&maps.k1)),
        k2: spread(maps.defined(&maps.k2)),
        direction: directions.map(|[k1, _]| k1),
        axis: directions.map(|[_, axis]| axis).filter(|_| class.has_axis()),
        support: s.count as f64 / maps.grid.len() as f64,
        plane_p,
        ..ShapeReport::of_maps(maps)
    }
}

/// Standard uncertainties of mean S and mean R, patch units.
fn uncertainties(fit: &FitData, maps: &ParametricMaps, defined: usize) -> [f64; 2] {
    let unknowns = 3 * fit.cells.shape().coefficients();
    let mut sums = [vec![0.0; unknowns], vec![0.0; unknowns]];
    let (mut alive, mut products) = (Vec::new(), vec![0.0; fit.cells.local()]);
    // a point of a grid shares its basis in either direction with all points of its line
    let (x, y) = (&maps.grid.x, &maps.grid.y);
    let along_u: Vec<_> = x.iter().map(|u| (fit.surface.row(0, *u), fit.cells.row(*u, y[0], 2))).collect();
    let along_v: Vec<_> = y.iter().map(|v| (fit.surface.row(1, *v), fit.cells.row(x[0], *v, 2))).collect();
    for ((i, j), _) in maps.supported.indexed_iter().filter(|(_, supported)| **supported) {
        let ((basis_u, row_u), (basis_v, row_v)) = (&along_u[i], &along_v[j]);
        let here = fit.surface.with_rows(basis_u, basis_v);
        let Some((by_s, by_r)) = jet_gradient(&here.derivatives) else { continue };
        let row = fit.cells.joined(row_u, row_v);
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
    sums.map(|g| fit.standard_uncertainty(&g) / defined.max(1) as f64)
}

/// Unit directions at the supported point nearest the middle: of k1, and of the curvature that is smaller by magnitude.
fn directions(maps: &ParametricMaps) -> Option<[Vector; 2]> {
    let middle = [&maps.grid.x, &maps.grid.y].map(|axis| 0.5 * (axis[0] + axis[axis.len() - 1]));
    let distance = |at: (usize, usize)| (maps.grid.x[at.0] - middle[0]).hypot(maps.grid.y[at.1] - middle[1]);
    let supported = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at);
    let at = supported.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    let (k1, k2) = (maps.k1[at], maps.k2[at]);
    // an umbilic has no direction, and a spline leaves 1 % of the curvature as a difference there
    let k1_along =
        (k1 - k2 > 0.01 * k1.abs().max(k2.abs())).then_some(maps.direction[at]).filter(|d| d[0].is_finite())?;
    Some([k1_along, if k1.abs() <= k2.abs() { k1_along } else { cross(maps.normals[at], k1_along) }])
}

/// p-value of the best plane against the fit, by chi-square at the noise sds. The degrees of freedom are one for every
/// coefficient, the one along the normal, less the three of the plane; a smoothed fit has fewer, so that the test favours
/// the plane.
fn plane_probability(fit: &FitData) -> Option<f64> {
    let contacts = &fit.contacts;
    let freedom = fit.cells.shape().coefficients() as f64 - 3.0;
    let squares = |w: f64| w * w;
    let weight: f64 = contacts.position_weight.iter().map(|w| squares(*w)).sum();
    if freedom <= 0.0 || weight <= 0.0 {
        return None;
    }
    let sum = |f: &dyn Fn(usize) -> Vector| {
        (0..contacts.len()).fold([0.0; 3], |m, r| {
            let v = f(r);
            [0, 1, 2].map(|k| m[k] + v[k])
        })
    };
    let centre = sum(&|r| contacts.points[r].map(|p| p * squares(contacts.position_weight[r]) / weight));
    let problem::Weights { position, normal, .. } = fit.weights;
    let mut spread = [[0.0; 3]; 3];
    for r in 0..contacts.len() {
        let d = minus(contacts.points[r], centre).map(|v| v * contacts.position_weight[r] / position);
        (0..3).for_each(|a| (0..3).for_each(|b| spread[a][b] += d[a] * d[b]));
    }
    let pull = sum(&|r| contacts.normals[r].map(|n| n * squares(contacts.normal_weight[r] / normal)));
    let pulled: f64 = contacts.normal_weight.iter().map(|w| squares(w / normal)).sum();
    // minimises n'Cn - 2 n.s on the sphere: n <- unit((tr C - C) n + s) never raises it
    let trace = spread[0][0] + spread[1][1] + spread[2][2];
    let mut n = unit(pull);
    for _ in 0..PLANE_STEPS {
        let product = spread.map(|row| dot(row, n));
        n = unit([0, 1, 2].map(|k| trace * n[k] - product[k] + pull[k]));
    }
    let of_plane = dot(n, spread.map(|row| dot(row, n))) + 2.0 * (pulled - dot(n, pull));
    let of_fit: f64 = (fit.residuals.iter().enumerate())
        .map(|(r, [distance, difference])| {
            squares(distance * contacts.position_weight[r] / position)
                + squares(difference * contacts.normal_weight[r] / normal)
        })
        .sum();
    Some(chi_square_upper_tail((of_plane - of_fit).max(0.0), freedom))
}
