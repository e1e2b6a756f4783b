//! Orthogonal distance fits by Levenberg-Marquardt, plain or robust (Huber's weights, found again at every round).
//!
//! ```text
//! minimise sum_i w_i d(theta; X_i)^2           (J'WJ + lambda diag) step = -J'W d
//! w_i = min(1, 1.345 s/|d_i|)                  s = mad(d - median d)
//! ```
//!
//! J. J. More, *The Levenberg-Marquardt algorithm*, 1978. P. J. Huber, *Robust Statistics*, 1981.

use crate::recognition::dense;
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::statistics::{huber_weight, mad_about_median};
use palpate_numeric::threads;
use palpate_numeric::vector::Vector;

use super::directions::Directions;

/// Rounds of reweighting.
const ROUNDS: usize = 25;

/// Steps tried for one set of weights in a plain fit.
const STEPS: usize = 60;

/// Levenberg-Marquardt damping at the start, and where a fit gives up.
const DAMPING: [f64; 2] = [1e-4, 1e12];

/// Points of one task; fewer, at 30 ns each, take less than handing them over.
pub(super) const TASK: usize = 1 << 13;

/// A fit with its distances and their robust scale.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub(in crate::recognition) model: Model,
    pub(in crate::recognition) distances: Vec<f64>,
    pub(super) scale: f64,
}

/// Robust fit from a start, to positions, or to positions and normals.
pub(super) fn robust(points: &[Vector], mut normals: Option<Directions>, kind: Kind, theta: [f64; 6]) -> Fitted {
    let mut model = Model::new(kind, kind.restricted(theta));
    let (mut last, mut damping) = (f64::INFINITY, DAMPING[0]);
    let mut weights = vec![1.0; points.len()];
    let mut distances = distances_of(&model, points);
    for _ in 0..ROUNDS {
        for _ in 0..3 {
            if !step(&mut model, (points, normals.as_ref()), &weights, &mut damping) {
                break;
            }
        }
        distances = distances_of(&model, points);
        let scale = scale_of(&distances);
        if (scale - last).abs() < 1e-4 * scale {
            break;
        }
        last = scale;
        weights.iter_mut().zip(&distances).for_each(|(w, d)| *w = huber_weight(*d, scale));
        normals.iter_mut().for_each(|normals| normals.weigh(&model, points));
    }
    let scale = scale_of(&distances);
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
    let mut damping = DAMPING[0];
    for _ in 0..STEPS {
        if !step(&mut model, (points, normals), weights, &mut damping) {
            break;
        }
    }
    let cost = cost(&model, (points, normals), weights);
    (model, cost)
}

pub(super) fn distances_of(model: &Model, points: &[Vector]) -> Vec<f64> {
    if points.len() <= TASK {
        return points.iter().map(|p| model.distance(*p)).collect();
    }
    threads::map(points.len(), TASK, |k| model.distance(points[k]))
}

/// The standard deviation by the median distance from the median, never 0.
pub(super) fn scale_of(distances: &[f64]) -> f64 {
    mad_about_median(distances) + 1e-12
}

/// Positions, and normals where they take part.
type Measured<'a> = (&'a [Vector], Option<&'a Directions>);

fn cost(model: &Model, (points, normals): Measured, weights: &[f64]) -> f64 {
    let of_positions: f64 = points.iter().zip(weights).map(|(p, w)| w * model.distance(*p).powi(2)).sum();
    normals.map_or(of_positions, |normals| of_positions + normals.cost(model, points))
}

/// One accepted step; `false` when none lowers the cost by more than rounding.
fn step(model: &mut Model, (points, normals): Measured, weights: &[f64], damping: &mut f64) -> bool {
    let p = model.kind().unknowns();
    let mut normal = [[0.0; 6]; 6];
    let mut gradient = [0.0; 6];
    let mut before = 0.0;
    for (point, &w) in points.iter().zip(weights) {
        let (d, by) = model.distance_by_free(*point);
        before += w * d * d;
        for i in 0..p {
            let weighted = w * by[i];
            gradient[i] -= weighted * d;
            (0..=i).for_each(|j| normal[i][j] += weighted * by[j]);
        }
    }
    if let Some(normals) = normals {
        before += normals.cost(model, points);
        normals.add(model, points, &mut normal, &mut gradient);
    }
    if !before.is_finite() {
        return false;
    }
    let floor = (0..p).map(|i| normal[i][i]).fold(0.0, f64::max) * 1e-10 + f64::MIN_POSITIVE;
    while *damping < DAMPING[1] {
        let mut damped = normal;
        (0..p).for_each(|i| damped[i][i] += *damping * (normal[i][i] + floor));
        let step = dense::solve_small(damped, gradient, p);
        let moved = step.map(|step| Model::new(model.kind(), model.kind().moved(model.theta(), &step[..p])));
        if let Some(moved) = moved {
            let after = cost(&moved, (points, normals), weights);
            if after < before {
                *model = moved;
                *damping = (*damping * 0.1).max(1e-14);
                return after < before * (1.0 - 1e-12);
            }
        }
        *damping *= 10.0;
    }
    *damping = DAMPING[0];
    false
}
