//! The part of the document that tells the shape, from what any kind of surface says of it.

use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{ShapeMaps, ShapeReport, Spread, Statistic, radius_of, spread};

use super::document::{FitDocument, MeasurePart, ShapePart, Shares, SpreadPart};

/// Share of the patch that the commonest class must have for the class to be said.
const SHARE_OF_CLASS: f64 = 0.5;

/// Variation of S over the patch from which on its mean may describe no part of it: two classes.
const VARIED: f64 = 0.25;

/// Share of the patch from which on a class that stands beside others is named.
const NAMED: f64 = 0.1;

/// Where S varies so much that the class of its mean is not the commonest one, or that no class has half of the patch:
/// the class is taken back and what there is said instead. `shape_index` runs over the supported points of the map.
pub(super) fn take_back_class(document: &mut FitDocument, shape_index: impl Iterator<Item = f64>) {
    let shape = &mut document.shape;
    if !shape.shape_index.sd.is_some_and(|sd| sd > VARIED) {
        return;
    }
    let mut counts: Vec<(ShapeClass, usize)> = ShapeClass::CURVED.into_iter().map(|class| (class, 0)).collect();
    for s in shape_index {
        let class = ShapeClass::of_shape_index(s);
        counts.iter_mut().filter(|(c, _)| *c == class).for_each(|(_, n)| *n += 1);
    }
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let all = counts.iter().map(|(_, n)| n).sum::<usize>().max(1) as f64;
    let (commonest, most) = counts[0];
    if shape.class.as_deref() == Some(commonest.name()) && most as f64 >= SHARE_OF_CLASS * all {
        return;
    }
    let by_area = counts.iter().map(|(class, n)| (*class, *n as f64 / all)).filter(|(_, share)| *share >= NAMED);
    shape.class_by_area = shares(&by_area.collect::<Vec<_>>());
    (shape.class, shape.class_probability, shape.radius, shape.radius_interval) = (None, None, None, None);
    shape.other_class = None;
    shape.radii = None;
}

/// Probabilities of the classes; `None` of a plane.
fn shares(list: &[(ShapeClass, f64)]) -> Option<Shares> {
    (!list.is_empty()).then(|| Shares(list.iter().map(|(c, p)| (c.name().to_string(), *p)).collect()))
}

/// The shape in the document, over a grid of so many points; `level` is that of the intervals.
pub(super) fn shape_part<M>(shape: &ShapeReport<M>, grid: [usize; 2], level: f64) -> ShapePart {
    ShapePart {
        grid,
        shape_index: measure(&shape.shape_index, level),
        curvedness: measure(&shape.curvedness, level),
        radius: shape.radius,
        radius_interval: shape.radius_interval,
        radii: shape.radii,
        class: shape.curvedness.mean.is_some().then(|| shape.class.name().to_string()),
        other_class: shape.other_class.map(|class| class.name().to_string()),
        class_probability: shares(&shape.class_probability),
        class_by_area: None,
        k1: spread_part(shape.k1),
        k2: spread_part(shape.k2),
        direction_deg: shape.direction_deg,
        direction: shape.direction,
        axis_deg: shape.axis_deg,
        axis: shape.axis,
        axis_within_deg: shape.axis_within_deg,
        centre: shape.centre,
        support: shape.support,
        plane_p: shape.plane_p,
        covariance: None,
        intervals: None,
    }
}

/// A mean with its uncertainty; `level` is that of the interval.
fn measure(statistic: &Statistic, level: f64) -> MeasurePart {
    let interval = statistic.interval.map(|i| [i.lo, i.hi]);
    MeasurePart {
        mean: statistic.mean,
        sd: statistic.sd,
        u: statistic.u,
        interval,
        u_noise: statistic.u_noise,
        u_model: statistic.u_model,
        level: interval.map(|_| level),
        coverage_factor: statistic.coverage_factor,
        dof: statistic.dof.filter(|dof| dof.is_finite()),
    }
}

fn spread_part(spread: Spread) -> SpreadPart {
    SpreadPart { mean: spread.mean, sd: spread.sd }
}

/// Puts the shape over another grid than the saved one into the document. The covariance is not saved, so everything that came from it
/// becomes undefined. Whether the patch is a plane was decided with the covariance, and stays.
pub(super) fn take_again(document: &mut FitDocument, maps: &ShapeMaps) {
    let grid = [maps.grid.x.len(), maps.grid.y.len()];
    let [s, r, k1, k2] = spreads(maps);
    let plane = document.shape.class.as_deref() == Some(ShapeClass::Plane.name());
    let class = s.mean.filter(|_| !plane).map(ShapeClass::of_shape_index);
    let measure = |spread: Spread| MeasurePart { mean: spread.mean, sd: spread.sd, ..MeasurePart::default() };
    let shape = &mut document.shape;
    shape.grid = grid;
    shape.shape_index = if plane { MeasurePart::default() } else { measure(s) };
    shape.curvedness = measure(r);
    if !plane {
        shape.class = class.map(|c| c.name().to_string());
    }
    shape.class_probability = None;
    (shape.covariance, shape.intervals) = (None, None);
    (shape.radius_interval, shape.radii) = (None, None);
    shape.radius = class.zip(r.mean).and_then(|(class, mean)| radius_of(class, mean));
    (shape.k1, shape.k2) = (spread_part(k1), spread_part(k2));
    shape.support = s.count as f64 / (grid[0] * grid[1]) as f64;
    document.truth = None;
    // a CAD file never had any
    if document.contacts > 0 {
        document.fit.notes.push("shape taken again over another grid: its uncertainty is not saved".into());
    }
}

/// Means and spreads of S, R, k1 and k2 over the supported points.
fn spreads(maps: &ShapeMaps) -> [Spread; 4] {
    let places: Vec<(usize, usize)> = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at).collect();
    let over = |value: &dyn Fn(usize, usize) -> Option<f64>| -> Spread {
        spread(places.iter().filter_map(|(i, j)| value(*i, *j)).collect::<Vec<_>>().into_iter())
    };
    [
        over(&|i, j| maps.shape_index_at(i, j)),
        over(&|i, j| maps.curvedness_at(i, j)),
        over(&|i, j| Some(maps.k1[[i, j]])),
        over(&|i, j| Some(maps.k2[[i, j]])),
    ]
}
