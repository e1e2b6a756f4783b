//! What a recognition tells of the shape, in the words of every other kind of surface.

use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{Interval, ShapeReport, Spread, Statistic, every_class, spread};
use palpate_numeric::vector::Vector;

use super::{Estimate, Hypothesis, MapPoint, Recognition};

impl From<&Estimate> for Statistic {
    fn from(e: &Estimate) -> Statistic {
        let [lo, hi] = e.interval;
        Statistic {
            mean: Some(e.mean),
            sd: Some(e.sd),
            u: Some(e.u),
            interval: Some(Interval { lo, hi }),
            u_noise: Some(e.u_noise),
            u_model: Some(e.u_model),
            dof: Some(e.dof),
            coverage_factor: None,
        }
    }
}

impl Recognition {
    /// S, R, class, radius and directions with their uncertainty, over the recognition's own map.
    pub fn shape(&self) -> ShapeReport<&[MapPoint]> {
        let over_map = |pick: fn(&MapPoint) -> f64, mean: f64| {
            let values: Vec<f64> =
                self.map.iter().filter(|p| p.supported).map(pick).filter(|k| k.is_finite()).collect();
            Spread { mean: Some(mean), ..spread(values.into_iter()) }
        };
        let level = self.over.is_some();
        let curved = self.class != ShapeClass::Plane;
        ShapeReport {
            shape_index: self.shape_index.as_ref().filter(|_| curved).map(Statistic::from).unwrap_or_default(),
            curvedness: Statistic::from(&self.curvedness),
            class: self.class,
            other_class: Some(self.class.mirrored()).filter(|other| !self.side_known && *other != self.class),
            class_probability: every_class(&self.class_probability),
            radius: self.radius,
            radius_interval: self.radius.and(self.radius_interval),
            radii: self.radii,
            k1: over_map(|p| p.k1, self.k1),
            k2: over_map(|p| p.k2, self.k2),
            direction_deg: self.direction.filter(|_| level).map(from_x_to_y),
            direction: self.direction.filter(|_| !level),
            axis_deg: self.axis.filter(|_| level).map(from_x_to_y),
            axis: self.axis.filter(|_| !level),
            axis_within_deg: self.axis_within_deg,
            centre: self.centre(),
            support: self.support.0 as f64 / self.support.1.max(1) as f64,
            ..ShapeReport::of_maps(self.map.as_slice())
        }
    }

    /// Centre of curvature in the middle of the patch, across: the centre of a ball, a point on the axis of a pipe or bar. Of other
    /// surfaces it is one of many, and says nothing.
    fn centre(&self) -> Option<Vector> {
        if !matches!(self.hypothesis, Hypothesis::Sphere | Hypothesis::Cylinder) || self.radius.is_none() {
            return None;
        }
        let [u, v] = [self.surface.u, self.surface.v].map(|[lo, hi]| 0.5 * (lo + hi));
        let (place, normal) = self.surface.at(u, v);
        // towards the free side where the surface is hollow
        let [k1, k2] = self.surface.curvatures_at(u, v)?;
        let k = if k1.abs() > k2.abs() { k1 } else { k2 };
        let centre = [0, 1, 2].map(|axis| place[axis] + normal[axis] / k);
        centre.iter().all(|v| v.is_finite()).then_some(centre)
    }
}

/// A direction projected to x and y, degrees in [0, 180).
fn from_x_to_y([x, y, _]: Vector) -> f64 {
    let angle = y.atan2(x).to_degrees().rem_euclid(180.0);
    // rounding may leave 180 itself
    if angle < 180.0 { angle } else { 0.0 }
}
