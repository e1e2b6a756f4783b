//! What the moved draws make of the answer.
//!
//! ```text
//! mean    = mean at the recognition + (mean of the draws now - at the recognition)
//! u       = u at the recognition  (sd of the draws now / at the recognition)       the interval's two arms alike
//! P(kind) ~ P(kind) at the recognition  (share of its draws now / then)            of classes likewise
//! ```

use crate::recognition::result::Estimate;
use crate::recognition::{Hypothesis, Recognition, Tried};
use palpate_geometry::curvature::{ShapeClass, principal_curvatures};
use palpate_geometry::shape::radius_of;

use super::ensemble::{DrawnEnsemble, EnsembleDraw};

/// Shares below which a kind has too few draws to be told by them.
const SMALLEST_SHARE: f64 = 1e-6;

/// The answer as it was recognised.
#[derive(Clone, Debug)]
pub(super) struct FirstAnswer {
    shape_index: Option<Estimate>,
    curvedness: Estimate,
    curvatures: [f64; 2],
    radius: Option<(f64, Option<[f64; 2]>)>,
    classes: Vec<(ShapeClass, f64)>,
    tried: Vec<Tried>,
    ensemble: DrawnEnsemble,
}

/// The answer as touches have moved it.
pub(super) struct MovedAnswer {
    answer: FirstAnswer,
    plane: f64,
}

/// Mean under the shares of estimates, and standard deviation under those of intervals.
#[derive(Clone, Copy)]
struct Moments {
    mean: f64,
    sd: f64,
}

/// How a number has moved: by so much, and its uncertainty by a factor.
#[derive(Clone, Copy)]
struct DrawnMove {
    by: f64,
    factor: f64,
}

impl FirstAnswer {
    pub(super) fn of(found: &Recognition, ensemble: &DrawnEnsemble) -> FirstAnswer {
        FirstAnswer {
            shape_index: found.shape_index,
            curvedness: found.curvedness,
            curvatures: [found.k1, found.k2],
            radius: found.radius.map(|radius| (radius, found.radius_interval)),
            classes: found.class_probability.clone(),
            tried: found.tried.clone(),
            ensemble: ensemble.clone(),
        }
    }

    /// By these draws.
    pub(super) fn moved(&self, found: &Recognition, now: &DrawnEnsemble) -> MovedAnswer {
        // where no side is known, S is given by its size
        let size = |s: f64| if found.side_known { s } else { s.abs() };
        let shape_index = |draw: &EnsembleDraw| draw.shape_index().map(size);
        let of = |value: &dyn Fn(&EnsembleDraw) -> Option<f64>| change(&self.ensemble, now, value);
        let s = self.shape_index.map(|s| moved(s, of(&shape_index), [-1.0, 1.0]));
        let r = moved(self.curvedness, of(&|draw| Some(draw.curvedness())), [0.0, f64::INFINITY]);
        let curvature = |k: usize| {
            let one = |draw: &EnsembleDraw| {
                Some(principal_curvatures([draw.shape_index().unwrap_or(0.0), draw.curvedness()])[k])
            };
            self.curvatures[k] + of(&one).by
        };
        let mut tried = self.tried.clone();
        let kinds = tried.iter().map(|t| (t.hypothesis, t.weight));
        let kinds = reweighed(&self.ensemble, now, kinds, |draw| draw.hypothesis);
        tried.iter_mut().zip(kinds).for_each(|(tried, weight)| tried.weight = weight);
        tried.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let plane = tried.iter().find(|t| t.hypothesis == Hypothesis::Plane).map_or(0.0, |t| t.weight);
        let radius = self.radius.map(|known| radius(found, known, &r, of(&EnsembleDraw::radius)));
        let answer = FirstAnswer {
            shape_index: s,
            curvedness: r,
            curvatures: [curvature(0), curvature(1)],
            radius,
            classes: self.classes(found, now, shape_index),
            tried,
            ensemble: DrawnEnsemble::default(),
        };
        MovedAnswer { answer, plane }
    }

    fn classes(
        &self,
        found: &Recognition,
        now: &DrawnEnsemble,
        shape_index: impl Fn(&EnsembleDraw) -> Option<f64>,
    ) -> Vec<(ShapeClass, f64)> {
        let class_of = |draw: &EnsembleDraw| shape_index(draw).map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
        let convex = |class: ShapeClass| if found.side_known { class } else { class.max(class.mirrored()) };
        let before = self.classes.iter().map(|(class, p)| (convex(*class), *p));
        let probabilities = reweighed(&self.ensemble, now, before, class_of);
        let mut classes: Vec<(ShapeClass, f64)> =
            self.classes.iter().zip(probabilities).map(|((class, _), p)| (*class, p)).collect();
        classes.sort_by(|a, b| b.1.total_cmp(&a.1));
        classes
    }
}

/// The radius of a body by its draws, that of a patch by R.
fn radius(
    found: &Recognition,
    (radius, interval): (f64, Option<[f64; 2]>),
    r: &Estimate,
    by_draws: DrawnMove,
) -> (f64, Option<[f64; 2]>) {
    if found.surface.body().is_none() {
        let of = |r: f64| radius_of(found.class, r);
        let ends = [1, 0].map(|k| of(r.interval[k]));
        return (of(r.mean).unwrap_or(radius), ends[0].zip(ends[1]).map(<[f64; 2]>::from));
    }
    let end = |end: f64| (radius + by_draws.by + by_draws.factor * (end - radius)).max(0.0);
    (radius + by_draws.by, interval.map(|ends| ends.map(end)))
}

impl MovedAnswer {
    /// Whether kind and class are still the reported ones.
    pub(super) fn keeps_kind_of(&self, found: &Recognition) -> bool {
        let class = match self.answer.shape_index {
            Some(s) if self.plane <= 0.5 => ShapeClass::of_shape_index(s.mean),
            _ => ShapeClass::Plane,
        };
        let likeliest = self.answer.tried.first().map(|t| t.hypothesis);
        let first = found.tried.first().map(|t| t.hypothesis);
        likeliest == first && class == found.class && self.answer.shape_index.is_some() == found.shape_index.is_some()
    }

    /// Puts it in the answer's place.
    pub(super) fn replace(self, found: &mut Recognition) {
        let FirstAnswer { shape_index, curvedness, curvatures: [k1, k2], radius, classes, tried, .. } = self.answer;
        (found.shape_index, found.curvedness) = (shape_index, curvedness);
        (found.k1, found.k2) = (k1, k2);
        if let Some((radius, interval)) = radius {
            (found.radius, found.radius_interval) = (Some(radius), interval);
        }
        found.radii = found.radii.map(|_| {
            let [large, small] = [k1.abs().max(k2.abs()), k1.abs().min(k2.abs())];
            [1.0 / large, 1.0 / small]
        });
        (found.class_probability, found.tried, found.plane_probability) = (classes, tried, self.plane);
    }
}

/// Moments of a number over the draws that have it.
fn moments(ensemble: &DrawnEnsemble, value: &dyn Fn(&EnsembleDraw) -> Option<f64>) -> Option<Moments> {
    let known: Vec<(f64, [f64; 2])> =
        ensemble.draws.iter().filter_map(|draw| Some((value(draw)?, draw.shares))).collect();
    let about = known.first()?.0;
    let mean_of = |k: usize, of: &dyn Fn(f64) -> f64| {
        let (sum, all) =
            known.iter().fold((0.0, 0.0), |(sum, all), (v, shares)| (sum + shares[k] * of(*v), all + shares[k]));
        (all > 0.0).then_some(sum / all)
    };
    let off = |v: f64| v - about;
    let centre = mean_of(1, &off)?;
    let variance = mean_of(1, &|v| (v - about - centre).powi(2))?;
    Some(Moments { mean: about + mean_of(0, &off).unwrap_or(centre), sd: variance.sqrt() })
}

/// How a number moves from some draws to the same draws after touches.
fn change(first: &DrawnEnsemble, now: &DrawnEnsemble, value: &dyn Fn(&EnsembleDraw) -> Option<f64>) -> DrawnMove {
    match (moments(first, value), moments(now, value)) {
        (Some(before), Some(after)) if before.sd > 0.0 => {
            DrawnMove { by: after.mean - before.mean, factor: after.sd / before.sd }
        }
        _ => DrawnMove { by: 0.0, factor: 1.0 },
    }
}

/// An estimate after a move, within the range of the quantity.
fn moved(e: Estimate, DrawnMove { by, factor }: DrawnMove, [least, most]: [f64; 2]) -> Estimate {
    let mean = (e.mean + by).clamp(least, most);
    let end = |end: f64| (mean + factor * (end - e.mean)).clamp(least, most);
    Estimate {
        mean,
        u_noise: factor * e.u_noise,
        u_model: factor * e.u_model,
        u: factor * e.u,
        interval: e.interval.map(end),
        ..e
    }
}

/// Probabilities by what touches made of the shares of each group's draws; a group without draws keeps pace with all together.
fn reweighed<K: PartialEq + Copy>(
    first: &DrawnEnsemble,
    now: &DrawnEnsemble,
    before: impl Iterator<Item = (K, f64)>,
    group_of: impl Fn(&EnsembleDraw) -> K,
) -> Vec<f64> {
    let share = |ensemble: &DrawnEnsemble, group: K| -> f64 {
        ensemble.draws.iter().filter(|draw| group_of(draw) == group).map(|draw| draw.shares[1]).sum()
    };
    let one = |(group, p): (K, f64)| match share(first, group) {
        old if old > SMALLEST_SHARE => p * share(now, group) / old,
        _ => p,
    };
    let raw: Vec<f64> = before.map(one).collect();
    let sum: f64 = raw.iter().sum();
    raw.into_iter().map(|p| p / sum).collect()
}
