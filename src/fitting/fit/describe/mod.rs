//! Steps 4 and 5: S and R over a grid; their means and spread, class, radius, direction, plane or not, and uncertainty.

mod direction;
mod flatness;
mod interval;
mod plane;
pub(super) mod pointwise;
pub(super) mod residuals;
mod robust_plane;
mod uncertainty;

use crate::fit::model_reading::ModelReading;
use crate::fit::solved::Solved;
use crate::observation::Data;
use direction::{Directions, directions};
use flatness::{is_flat, plane_probability};
use interval::{NoisePart, statistic};
use palpate_geometry::contact::Frame;
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{
    GridGradients, Outline, PLANE_SIGNIFICANCE, ShapeGrid, ShapeMaps, ShapeReport, Statistic, class_probabilities,
    every_class, radius_of,
};
use palpate_geometry::surface::SurfacePoint;
use uncertainty::Uncertainties;

/// Step 4: heights, derivatives, k1, k2, S and R over the grid of the options, in patch units.
pub(super) fn shape_over_grid(solved: &Solved) -> ShapeMaps {
    let domain = [solved.patch.knots[0].domain(), solved.patch.knots[1].domain()];
    let grid = ShapeGrid::over(domain, solved.options.grid, solved.options.inset);
    let mut maps = solved.surface.shape_maps(grid, &solved.fitted.solution.unsupported);
    // who names a domain asks about all of it, as streams and plans answer
    if let (Data::Scattered { contacts, .. }, None) = (&solved.data, solved.options.domain) {
        maps.leave_out_beyond(&Outline::new(&contacts.x, &contacts.y));
    }
    maps
}

/// The shape of a patch, in input units: x, y of the maps run along the frame's axes.
pub type Shape = ShapeReport<ShapeMaps>;

/// Step 5: means, class, radius, and with `model` their uncertainty and the direction, in input units; and the gradients of S and R
/// by the coefficients, for the certificate.
pub(super) fn classify(solved: &Solved, local: &ShapeMaps, model: Option<&ModelReading>) -> (Shape, GridGradients) {
    let scale = solved.patch.frame.scale;
    let s = local.spread_of_shape_index();
    let r = local.spread_of(&local.curvedness, scale);
    let plane_p = plane_probability(solved);
    let is_plane = plane_p.is_some_and(|p| p > PLANE_SIGNIFICANCE) || r.mean.is_some_and(|mean| is_flat(solved, mean));
    let u = model.map(|_| Uncertainties::new(solved, local, s.mean));
    let [u_s, u_r] = [u.as_ref().and_then(|u| u.of_shape_index), u.as_ref().and_then(|u| u.of_curvedness)];
    let u_s = u_s.map(|part| NoisePart { reaches: u.as_ref().and_then(|u| u.end_of_shape_index), ..part });
    // what passes for a plane may be one: R is a length and lies above 0 by some of the noise
    let u_r = u_r.map(|part| NoisePart { reaches: is_plane.then_some(0.0), ..part });
    let curved = s.mean.filter(|_| !is_plane);
    let class = curved.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    let level = solved.options.level;
    let other = model.and_then(ModelReading::found);
    let s_of_others = other.and_then(|other| other.shape_index);
    let r_of_others = other.map(|other| other.curvedness);
    let Directions { k1: direction_deg, axis } =
        curved.filter(|_| model.is_some()).map_or(Directions::NONE, |_| directions(solved));
    let shape = Shape {
        shape_index: curved.map_or(Statistic::default(), |_| statistic(s, u_s, s_of_others, level, [-1.0, 1.0])),
        curvedness: statistic(r, u_r, r_of_others, level, [0.0, f64::INFINITY]),
        class,
        class_probability: match (curved.zip(u_s), other) {
            (Some(_), Some(other)) => every_class(&other.classes),
            (Some((mean, u)), None) => class_probabilities(mean, u.u),
            (None, _) => Vec::new(),
        },
        radius: r.mean.and_then(|mean| radius_of(class, mean)),
        k1: local.spread_of(&local.k1, scale),
        k2: local.spread_of(&local.k2, scale),
        direction_deg,
        axis_deg: axis.filter(|_| class.has_axis()),
        support: s.count as f64 / local.grid.len() as f64,
        plane_p,
        ..ShapeReport::of_maps(in_input_units(&solved.patch.frame, local))
    };
    (shape, u.map_or_else(GridGradients::unkept, |u| u.gradients))
}

/// Covariance of the noise in mean S and mean R, 1/length in input units.
pub(super) fn covariance_of_means(solved: &Solved) -> Option<f64> {
    let local = shape_over_grid(solved);
    let gradients = GridGradients::new(&solved.surface, &local.rows);
    let of_means = palpate_geometry::shape::mean_gradients(&solved.surface, &local, &gradients);
    let found = uncertainty::covariance(solved, [&of_means.shape_index, &of_means.curvedness])?;
    Some(found / solved.patch.frame.scale)
}

/// Supported points of the grid with their heights, at most `most` each way: the middles of as many blocks.
pub(super) fn places(local: &ShapeMaps, most: usize) -> Vec<[f64; 3]> {
    let chosen = |count: usize| -> Vec<usize> {
        let blocks = count.min(most);
        (0..blocks).map(|k| (2 * k + 1) * count / (2 * blocks)).collect()
    };
    let columns = chosen(local.grid.y.len());
    let all = chosen(local.grid.x.len()).into_iter().flat_map(|i| columns.iter().map(move |j| (i, *j)));
    let held = all.filter(|&(i, j)| local.supported[[i, j]] && local.shape_index_at(i, j).is_some());
    held.map(|(i, j)| [local.grid.x[i], local.grid.y[j], local.points[[i, j]].z]).collect()
}

/// Maps in input units along the frame's axes.
fn in_input_units(frame: &Frame, local: &ShapeMaps) -> ShapeMaps {
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
