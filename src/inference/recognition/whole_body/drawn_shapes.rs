//! What drawn surfaces say of shape over many places: means, classes, and whether it is still that of their primitives.

use palpate_geometry::curvature::{ShapeClass, curvedness, shape_index};
use palpate_numeric::vector::Vector;

use super::kept_draws::is_flat;
use crate::bodies::{DrawnBase, Tuning};
use crate::recognition::MapPoint;

/// Means of S (0 on a plane) and R over places; `None` where one is not finite.
fn mean_shape(drawn: &DrawnBase, places: &[Vector]) -> Option<[f64; 2]> {
    let mut sums = [0.0; 2];
    for place in places {
        let [k1, k2] = drawn.curvatures(*place);
        sums[0] += shape_index(k1 + k2, k1 - k2).unwrap_or(0.0);
        sums[1] += curvedness(k1, k2);
    }
    let means = sums.map(|sum| sum / places.len() as f64);
    means.iter().all(|v| v.is_finite()).then_some(means)
}

pub(super) fn mean_curvatures(drawn: &DrawnBase, places: &[Vector]) -> [f64; 2] {
    let count = places.len().max(1) as f64;
    let each = places.iter().map(|place| drawn.curvatures(*place));
    each.fold([0.0; 2], |sum, k| [0, 1].map(|i| sum[i] + k[i] / count))
}

/// Standard deviations of S and R over the supported points of a map: 0 where they differ by rounding alone.
pub(super) fn variation(map: &[MapPoint]) -> [f64; 2] {
    let over = |value: fn(&MapPoint) -> f64| {
        let values: Vec<f64> = map.iter().filter(|p| p.supported).map(value).filter(|v| v.is_finite()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        if sd > 1e-9 * mean.abs() { sd } else { 0.0 }
    };
    [over(|p| p.shape_index.unwrap_or(f64::NAN)), over(|p| p.curvedness)]
}

/// Contacts at which a drawn surface is compared with its primitive.
const COMPARED: usize = 32;

/// Share of the draws whose departure makes another shape of them.
pub(super) fn free_form(draws: &[DrawnBase], members: &[Vector], tuning: &Tuning) -> f64 {
    let step = members.len().div_ceil(COMPARED).max(1);
    let places: Vec<Vector> = members.iter().step_by(step).copied().collect();
    let [of_s, of_r] = tuning.other_shape;
    let is_other = |drawn: &&DrawnBase| {
        let base = DrawnBase::of_primitive(drawn.primitive);
        match (drawn.departs(), mean_shape(drawn, &places), mean_shape(&base, &places)) {
            (true, Some(own), Some(mean)) => {
                let away = places.iter().map(|p| (drawn.distance(*p) - base.distance(*p)).powi(2)).sum::<f64>();
                (own[0] - mean[0]).abs() > of_s
                    || (own[1] - mean[1]).abs() > of_r * mean[1].max(own[1])
                    || away > tuning.other_body.powi(2) * places.len() as f64
            }
            _ => false,
        }
    };
    draws.iter().filter(is_other).map(|d| d.share).sum()
}

/// Shares of the draws in every class.
pub(super) fn classes(draws: &[DrawnBase], shapes: &[Option<[f64; 2]>]) -> Vec<(ShapeClass, f64)> {
    let mut found: Vec<(ShapeClass, f64)> = Vec::new();
    for (drawn, shape) in draws.iter().zip(shapes) {
        let Some([s, ..]) = shape else { continue };
        let flat = is_flat(drawn);
        let class = if flat { ShapeClass::Plane } else { ShapeClass::of_shape_index(*s) };
        match found.iter_mut().find(|(known, _)| *known == class) {
            Some((_, sum)) => *sum += drawn.share,
            None => found.push((class, drawn.share)),
        }
    }
    let all: f64 = found.iter().map(|(_, p)| p).sum();
    found.iter_mut().for_each(|(_, p)| *p /= all);
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
}
