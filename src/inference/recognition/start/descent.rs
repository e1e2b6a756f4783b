//! Orthogonal distance fits by Levenberg-Marquardt, plain or robust (Huber's weights, found again at every round).
//!
//! ```text
//! minimise sum_i w_i d(theta; X_i)^2           (J'WJ + lambda diag) step = -J'W d
//! w_i = min(1, 1.345 s/|d_i|)                  s = mad(d - median d)
//! ```
//!
//! J. J. More, *The Levenberg-Marquardt algorithm*, 1978. P. J. Huber, *Robust Statistics*, 1981.

use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::levenberg_marquardt::{self, ResidualModel, Settings};
use palpate_numeric::linalg::small::{NotPositiveDefinite, solve_leading};
use palpate_numeric::statistics::{huber_weight, mad_about_median};
use palpate_numeric::threads;
use palpate_numeric::vector::Vector;

use super::directions::Directions;

/// Rounds of reweighting.
const ROUNDS: usize = 25;

/// Steps tried for one set of weights in a plain fit.
const STEPS: usize = 60;

/// Damping and budget of a plain fit.
const SETTINGS: Settings = Settings {
    first: 1e-4,
    most: 1e12_f64.next_down(),
    fall: |damping| (damping * 0.1).max(1e-14),
    rounding: 0.0,
    steps: STEPS,
    trials: usize::MAX,
};

/// Steps for one set of weights in a robust fit.
const BETWEEN_WEIGHTS: usize = 3;

/// Points of one task; fewer, at 30 ns each, take less than handing them over.
pub(super) const TASK: usize = 1 << 13;

/// A fit with its distances and their robust scale.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub(crate) model: Model,
    pub(crate) distances: Vec<f64>,
    pub(super) scale: f64,
}

/// Robust fit from a start, to positions, or to positions and normals; no scale of distances is below `floor`.
pub(super) fn robust(
    points: &[Vector],
    mut normals: Option<Directions>,
    kind: Kind,
    theta: [f64; 6],
    floor: f64,
) -> Fitted {
    let mut model = Model::new(kind, kind.restricted(theta));
    let (mut last, mut damping) = (f64::INFINITY, SETTINGS.first);
    let mut weights = vec![1.0; points.len()];
    let mut distances = distances_of(&model, points);
    for _ in 0..ROUNDS {
        let between = Settings { steps: BETWEEN_WEIGHTS, ..SETTINGS };
        descend(&mut model, (points, normals.as_ref()), &weights, &mut damping, &between);
        distances = distances_of(&model, points);
        let scale = scale_of(&distances, floor);
        if (scale - last).abs() < 1e-4 * scale {
            break;
        }
        last = scale;
        weights.iter_mut().zip(&distances).for_each(|(w, d)| *w = huber_weight(*d, scale));
        normals.iter_mut().for_each(|normals| normals.weigh(&model, points));
    }
    let scale = scale_of(&distances, floor);
    Fitted { model, distances, scale }
}

/// Least squares with given weights; also the weighted sum of squares.
pub(super) fn plain(
    points: &[Vector],
    normals: Option<&Directions>,
    weights: &[f64],
    kind: Kind,
    theta: [f64; 6],
) -> (Model, f64) {
    let mut model = Model::new(kind, kind.restricted(theta));
    descend(&mut model, (points, normals), weights, &mut SETTINGS.first.clone(), &SETTINGS);
    let cost = cost(&model, (points, normals), weights);
    (model, cost)
}

pub(super) fn distances_of(model: &Model, points: &[Vector]) -> Vec<f64> {
    if points.len() <= TASK {
        return points.iter().map(|p| model.distance(*p)).collect();
    }
    threads::map(points.len(), TASK, |k| model.distance(points[k]))
}

/// The standard deviation by the median distance from the median, not below `floor` and never 0.
pub(super) fn scale_of(distances: &[f64], floor: f64) -> f64 {
    mad_about_median(distances).max(floor) + 1e-12
}

/// Positions, and normals where they take part.
type Measured<'a> = (&'a [Vector], Option<&'a Directions>);

fn cost(model: &Model, (points, normals): Measured, weights: &[f64]) -> f64 {
    let of_positions: f64 = points.iter().zip(weights).map(|(p, w)| w * model.distance(*p).powi(2)).sum();
    normals.map_or(of_positions, |normals| of_positions + normals.cost(model, points))
}

/// Steps downwards; equations without a solution end them where they are.
fn descend(model: &mut Model, measured: Measured, weights: &[f64], damping: &mut f64, settings: &Settings) {
    let mut distances = Distances { measured, weights, normal: [[0.0; 6]; 6], gradient: [0.0; 6], unknowns: 0 };
    let _ = levenberg_marquardt::descend(&mut distances, model, damping, settings);
}

/// Weighted distances, one row a point and two a normal, with their normal equations at the last point.
struct Distances<'a> {
    measured: Measured<'a>,
    weights: &'a [f64],
    normal: [[f64; 6]; 6],
    gradient: [f64; 6],
    unknowns: usize,
}

impl ResidualModel for Distances<'_> {
    type Point = Model;
    type Step = [f64; 6];
    type Error = NotPositiveDefinite;

    fn linearise(&mut self, model: &Model) -> f64 {
        let (points, normals) = self.measured;
        let p = model.kind().unknowns();
        self.unknowns = p;
        (self.normal, self.gradient) = ([[0.0; 6]; 6], [0.0; 6]);
        let mut before = 0.0;
        for (point, &w) in points.iter().zip(self.weights) {
            let (d, by) = model.distance_by_free(*point);
            before += w * d * d;
            for i in 0..p {
                let weighted = w * by[i];
                self.gradient[i] -= weighted * d;
                (0..=i).for_each(|j| self.normal[i][j] += weighted * by[j]);
            }
        }
        if let Some(normals) = normals {
            before += normals.cost(model, points);
            normals.add(model, points, &mut self.normal, &mut self.gradient);
        }
        before
    }

    fn solve(&mut self, damping: f64) -> Result<[f64; 6], NotPositiveDefinite> {
        let p = self.unknowns;
        let floor = (0..p).map(|i| self.normal[i][i]).fold(0.0, f64::max) * 1e-10 + f64::MIN_POSITIVE;
        let mut damped = self.normal;
        (0..p).for_each(|i| damped[i][i] += damping * (self.normal[i][i] + floor));
        solve_leading(damped, self.gradient, p).ok_or(NotPositiveDefinite)
    }

    fn moved(&mut self, from: &Model, step: &[f64; 6]) -> Option<(Model, f64)> {
        let moved = Model::new(from.kind(), from.kind().moved(from.theta(), &step[..self.unknowns]));
        if !moved.is_possible() {
            return None;
        }
        let after = cost(&moved, self.measured, self.weights);
        Some((moved, after))
    }

    fn is_settled(&mut self, _: &[f64; 6], before: f64, after: f64) -> bool {
        // the cost is rounded to about this
        after >= before * (1.0 - 1e-12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    /// Contacts that lie on no surface lead a descent to a point, which has no extent that S and R could be told over.
    #[test]
    fn no_surface_shrinks_to_a_point() {
        let mut generator = Lcg::new(3);
        for _ in 0..20 {
            let mut off = || 2.0 * generator.uniform() - 1.0;
            let points: Vec<Vector> = (0..60).map(|_| [off(), off(), off()]).collect();
            for curvature in [0.0, 5.0, 400.0] {
                let start = [0.1, 0.0, 0.0, curvature, -0.9 * curvature, 0.3];
                let (found, _) = plain(&points, None, &[1.0; 60], Kind::General, start);
                assert!(found.is_possible(), "{:?}", found.theta());
            }
        }
    }
}
