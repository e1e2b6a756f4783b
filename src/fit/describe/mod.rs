//! Steps 4 and 5: S and R over a grid, mean and spread, class, radius, direction, plane, and their uncertainty.

pub(super) mod plane;
pub(super) mod uncertainty;

use crate::curvature::{ShapeClass, principal_curvatures};
use crate::fit::describe::plane::plane_rows;
use crate::fit::{Declared, Fit};
use crate::linalg::{RowWeights, SiteWeights, Sites};
use crate::shape::{
    GridGradients, Interval, ShapeGrid, ShapeMaps, Spread, best_plane, chi_square_upper_tail, class_probabilities,
    f_upper_tail, gap_gradient, mean_gradients, normal_interval, radius_of, shape_maps, spread,
};
use crate::surface::SurfacePoint;

/// The level at which the best plane is rejected (design, section 1).
const PLANE_LEVEL: f64 = 0.01;
/// Unit roundoff 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Mean over the patch with spread (variation over the patch) and uncertainty (of the mean, from noise).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistic {
    /// Mean over supported points.
    pub mean: Option<f64>,
    /// Sample sd over them.
    pub sd: Option<f64>,
    /// Standard uncertainty of the mean.
    pub u: Option<f64>,
    /// Interval for the mean at the options' level.
    pub interval: Option<Interval>,
}

/// The shape of a patch, in input units.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Maps over the shape grid: x, y along the frame's axes in input units, heights, k1, k2, S, R.
    pub maps: ShapeMaps,
    /// Shape index S; all `None` for a plane.
    pub shape_index: Statistic,
    /// Curvedness R, 1/length.
    pub curvedness: Statistic,
    /// Class of the mean S, or plane.
    pub class: ShapeClass,
    /// Probability of each curved class by the delta method; empty for a plane.
    pub class_probability: Vec<(ShapeClass, f64)>,
    /// Radius of the cap, cup, ridge or rut.
    pub radius: Option<f64>,
    /// Larger principal curvature over the patch.
    pub k1: Spread,
    /// Smaller principal curvature over the patch.
    pub k2: Spread,
    /// Direction of k1 at the patch centre projected to the input's x, y, degrees in [0, 180).
    pub direction_deg: Option<f64>,
    /// Points used / grid points.
    pub support: f64,
    /// p-value of the best plane against the fit.
    pub plane_p: Option<f64>,
    /// What S and R depend on, for the certificate.
    pub(super) gradients: GridGradients,
}

/// Describes the fit over the grid of its options.
pub fn describe(fit: &Fit) -> Shape {
    let domain = [fit.patch.knots[0].domain(), fit.patch.knots[1].domain()];
    let grid = ShapeGrid::over(domain, fit.options.grid, fit.options.inset);
    let local = shape_maps(&fit.surface, grid, &fit.fitted.solution.unsupported);
    let plane_p = plane_probability(fit);
    let is_plane = plane_p.is_some_and(|p| p > PLANE_LEVEL) || is_flat(fit, &local);
    summarise(fit, &local, plane_p, is_plane)
}

fn points(maps: &ShapeMaps) -> impl Iterator<Item = (usize, usize)> + Clone + '_ {
    let columns = maps.grid.y.len();
    (0..maps.grid.len()).map(move |k| (k / columns, k % columns)).filter(|&(i, j)| maps.supported[[i, j]])
}

fn summarise(fit: &Fit, local: &ShapeMaps, plane_p: Option<f64>, is_plane: bool) -> Shape {
    let scale = fit.patch.frame.scale;
    let defined = points(local).filter(|&(i, j)| local.shape_index_at(i, j).is_some());
    let s = spread(defined.clone().map(|at| local.shape_index[at]));
    let r = spread(points(local).map(|at| local.curvedness[at] / scale));
    let of_points = GridGradients::new(&fit.surface, &local.rows);
    let gradients = mean_gradients(&fit.surface, local, &of_points);
    let level = fit.options.level;
    let statistic = |spread: Spread, u: f64, floor: f64, ceiling: f64| Statistic {
        mean: spread.mean,
        sd: spread.sd,
        u: spread.mean.map(|_| u),
        interval: spread.mean.map(|m| normal_interval(m, u, level, floor, ceiling)),
    };
    let u_s = uncertainty::functional(fit, &gradients.shape_index);
    let u_r = uncertainty::functional(fit, &gradients.curvedness) / scale;
    let curved = s.mean.filter(|_| !is_plane);
    let class = curved.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    Shape {
        shape_index: if curved.is_some() { statistic(s, u_s, -1.0, 1.0) } else { Statistic::default() },
        curvedness: statistic(r, u_r, 0.0, f64::INFINITY),
        class,
        class_probability: curved.map_or(Vec::new(), |mean| class_probabilities(mean, u_s)),
        radius: r.mean.and_then(|mean| radius_of(class, mean)),
        k1: spread(points(local).map(|at| local.k1[at] / scale)),
        k2: spread(points(local).map(|at| local.k2[at] / scale)),
        direction_deg: if curved.is_some() { direction(fit) } else { None },
        support: s.count as f64 / local.grid.len() as f64,
        plane_p,
        maps: in_input_units(fit, local),
        gradients: of_points,
    }
}

/// Maps in input units along the frame's axes.
fn in_input_units(fit: &Fit, local: &ShapeMaps) -> ShapeMaps {
    let frame = &fit.patch.frame;
    let origin = if frame.keeps_axes() { frame.origin } else { frame.rotate(frame.origin) };
    let mut maps = local.clone();
    let place = |axis: &mut [f64], o: f64| axis.iter_mut().for_each(|v| *v = o + frame.scale * *v);
    place(&mut maps.grid.x, origin[0]);
    place(&mut maps.grid.y, origin[1]);
    maps.points.mapv_inplace(|p| SurfacePoint {
        z: origin[2] + frame.scale * p.z,
        zx: p.zx,
        zy: p.zy,
        zxx: p.zxx / frame.scale,
        zxy: p.zxy / frame.scale,
        zyy: p.zyy / frame.scale,
    });
    for map in [&mut maps.k1, &mut maps.k2, &mut maps.curvedness] {
        map.mapv_inplace(|k| k / frame.scale);
    }
    maps
}

/// Angle of k1's direction at the centre; `None` where k1 - k2 is within twice its uncertainty or rounding of zero.
fn direction(fit: &Fit) -> Option<f64> {
    let [dx, dy] = [0, 1].map(|k| {
        let [lo, hi] = fit.patch.knots[k].domain();
        0.5 * (lo + hi)
    });
    let point = fit.surface.at(dx, dy);
    let principal = principal_curvatures(&point.derivatives())?;
    let rounding = 1e3 * UNIT * (1.0 + principal.k1.abs().max(principal.k2.abs()));
    let noise = uncertainty::functional(fit, &gap_gradient(&fit.surface, dx, dy));
    if principal.difference <= (2.0 * noise).max(rounding) {
        return None;
    }
    let d = fit.patch.frame.rotate_back(principal.direction1);
    if d[0] == 0.0 && d[1] == 0.0 {
        return None;
    }
    let angle = d[1].atan2(d[0]).to_degrees().rem_euclid(180.0);
    // rounding of -0 degrees lands on 180
    Some(if angle >= 180.0 { 0.0 } else { angle })
}

/// Best plane against the fit: chi-square with declared sigmas, else F.
fn plane_probability(fit: &Fit) -> Option<f64> {
    let fitted = &fit.fitted;
    let equations = &fitted.equations;
    let freedom = fitted.solution.rank as f64 - 3.0;
    let rest = equations.count() as f64 - fitted.solution.rank as f64;
    if freedom <= 0.0 || (fit.noise().declared != Declared::Sigma && rest <= 0.0) {
        return None;
    }
    let of_fit: f64 = equations.residual_squares(&fitted.solution.coefficients).iter().sum();
    let largest = fit.data.largest_height(&fit.patch) / fit.patch.frame.scale;
    let plane = plane_rows(equations, largest)?;
    if plane.is_rounding {
        return Some(1.0);
    }
    let rise = (plane.squares - of_fit).max(0.0);
    Some(match fit.noise().declared {
        Declared::Sigma => chi_square_upper_tail(rise, freedom),
        _ => f_upper_tail((rise / freedom) / (of_fit / rest), freedom, rest),
    })
}

/// Flat to rounding: mean R times the larger side below
/// `100 u condition max deviation from the plane / side + 4 u max z / side`.
fn is_flat(fit: &Fit, local: &ShapeMaps) -> bool {
    let side = fit.patch.side;
    let scale = fit.patch.frame.scale;
    let Some(r) = spread(points(local).map(|at| local.curvedness[at] / scale)).mean else { return false };
    let sites = &fit.fitted.equations.sites;
    let largest = fit.data.largest_height(&fit.patch);
    let rounding =
        |deviation: f64| 100.0 * UNIT * fit.condition() * deviation * scale / side + 4.0 * UNIT * largest / side;
    // no residual of the least squares plane is larger than all heights together
    if r * side >= rounding(fit.data.size_of_heights()) {
        return false;
    }
    let measured = fit.data.measured();
    let one = RowWeights::Uniform(SiteWeights { z: 1.0, ..SiteWeights::default() });
    let mut places = vec![[0.0; 3]; sites.len()];
    let knots = sites.knots();
    let coordinate = |axis: usize| -> Vec<f64> {
        let (gx, gy) = (knots[0].greville(), knots[1].greville());
        gx.iter().flat_map(|x| gy.iter().map(move |y| if axis == 0 { *x } else { *y })).collect()
    };
    for axis in 0..2 {
        let mut rows = Vec::new();
        crate::linalg::apply_rows(sites, &one, &coordinate(axis), &mut rows);
        rows.iter().enumerate().for_each(|(r, row)| places[r][axis] = row[0]);
    }
    let heights = places.iter().enumerate().filter(|(r, _)| measured.z_weight[*r] != 0.0);
    let (_, deviation) = best_plane(heights.map(|(r, p)| [p[0], p[1], measured.z[r]]));
    r * side < rounding(deviation)
}
