//! Uncertainties of a surface point by point, as they are saved with it.

use crate::io::{PointUncertainty, UNCERTAINTY_POINTS, UncertaintyMap};
use palpate_geometry::shape::PointSds;
use palpate_numeric::bspline::{Knots, linspace};

use super::document::ShapePart;

/// The places at which they are known, along both directions.
pub(super) fn places(knots: [&Knots; 2]) -> [Vec<f64>; 2] {
    knots.map(|axis| {
        let [lo, hi] = axis.domain();
        linspace(lo, hi, UNCERTAINTY_POINTS)
    })
}

/// The map of what is known at these places, with what the means say of the kind of surface added to every point: noise at a
/// point knows nothing of it. `None` where nothing is known anywhere.
pub(super) fn map(at: [Vec<f64>; 2], sds: &[Option<PointSds>], shape: &ShapePart) -> Option<UncertaintyMap> {
    let model = [&shape.shape_index, &shape.curvedness].map(|part| part.u_model.unwrap_or(0.0));
    let flat = shape.shape_index.mean.is_none();
    let one = |sds: &Option<PointSds>| {
        let Some(sds) = sds else { return PointUncertainty::default() };
        PointUncertainty {
            position: Some(sds.position),
            normal_deg: Some(sds.normal.to_degrees()),
            shape_index: sds.shape_index.filter(|_| !flat).map(|u| u.hypot(model[0]).min(1.0)),
            curvedness: sds.curvedness.map(|u| u.hypot(model[1])),
            k1: sds.curvatures.map(|[u, _]| u.hypot(model[1])),
            k2: sds.curvatures.map(|[_, u]| u.hypot(model[1])),
        }
    };
    let values: Vec<PointUncertainty> = sds.iter().map(one).collect();
    sds.iter().any(Option::is_some).then(|| UncertaintyMap::of(at, &values))
}
