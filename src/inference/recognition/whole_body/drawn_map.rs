//! The map of a body, with what every drawn surface says over it.

use crate::bodies::BodyChart;
use crate::recognition::{MapPoint, RecognitionOptions};
use palpate_geometry::curvature::{curvedness, shape_index};
use palpate_geometry::shape::ShapeGrid;

/// The map, how many of its points are supported, and the means of S and R of every draw over these.
pub(super) struct DrawnMap {
    pub(super) map: Vec<MapPoint>,
    pub(super) supported: usize,
    pub(super) shapes: Vec<Option<[f64; 2]>>,
}

impl DrawnMap {
    /// The map over the chart, and what every draw says over those of its points that contacts support: all of them where they
    /// support none.
    pub(super) fn over(chart: &BodyChart, options: &RecognitionOptions) -> DrawnMap {
        let ShapeGrid { x: u, y: v } = ShapeGrid::over([chart.u, chart.v], options.grid, options.inset);
        let over: Vec<[f64; 2]> = u.iter().flat_map(|u| v.iter().map(|v| [*u, *v])).collect();
        let mut is_supported: Vec<bool> = over.iter().map(|[u, v]| chart.supported_at(*u, *v)).collect();
        if !is_supported.contains(&true) {
            is_supported.fill(true);
        }
        let mut sums = vec![[0.0; 2]; chart.draws.len()];
        let one = |([u, v], supported): (&[f64; 2], &bool)| {
            let (point, readings) = point_of(chart, *u, *v, *supported);
            if *supported {
                sums.iter_mut().zip(&readings).for_each(|(sum, [_, _, s, r, ..])| *sum = [sum[0] + s, sum[1] + r]);
            }
            point
        };
        let map: Vec<MapPoint> = over.iter().zip(&is_supported).map(one).collect();
        let supported = map.iter().filter(|p| p.supported).count();
        let mean = |sum: [f64; 2]| Some(sum.map(|v| v / supported as f64)).filter(|m| m.iter().all(|v| v.is_finite()));
        DrawnMap { map, supported, shapes: sums.into_iter().map(mean).collect() }
    }
}

/// A point of the map, and what the draws say there.
fn point_of(chart: &BodyChart, u: f64, v: f64, supported: bool) -> (MapPoint, Vec<[f64; 6]>) {
    let (position, normal) = chart.at(u, v);
    let [k1, k2] = chart.curvatures_at(u, v).unwrap_or([f64::NAN; 2]);
    let readings = chart.readings_at(position);
    let [u_position, u_normal, u_shape_index, u_curvedness, u_k1, u_k2] = chart.sds_of(&readings);
    let point = MapPoint {
        position,
        normal,
        shape_index: shape_index(k1 + k2, k1 - k2),
        curvedness: curvedness(k1, k2),
        k1,
        k2,
        supported,
        u_shape_index,
        u_curvedness,
        u_curvatures: [u_k1, u_k2],
        u_position,
        u_normal,
    };
    (point, readings)
}
