//! How far the patch is from a plane, and how far the cells are from a model.
//!
//! ```text
//! relief = sd of d_plane(P) - d_general(P) over the cells P        misfit = sd of sqrt(w) d(P), w the cells' weights
//! ```

use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::statistics::standard_deviation;

/// Standard deviation of the heights that curvature accounts for, with a floor so that planes have one too.
pub(crate) fn relief(cells: &Cells, models: &[Model], tuning: &Tuning) -> f64 {
    let of = |kind: Kind| models.iter().find(|m| m.kind() == kind);
    let (Some(plane), Some(general)) = (of(Kind::Plane), of(Kind::General)) else { return tuning.least_relief };
    let heights: Vec<f64> = cells.points.iter().map(|p| plane.distance(*p) - general.distance(*p)).collect();
    standard_deviation(&heights).hypot(tuning.least_relief)
}

/// Root mean square distance of the cells from a model, about the mean distance.
pub(crate) fn weighted_rms(cells: &Cells, model: &Model) -> f64 {
    let weighted: Vec<f64> =
        cells.points.iter().zip(&cells.weights).map(|(p, w)| w.sqrt() * model.distance(*p)).collect();
    standard_deviation(&weighted)
}
