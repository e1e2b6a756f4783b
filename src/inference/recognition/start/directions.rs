//! Normals in an orthogonal distance fit: where positions alone do not determine a surface, as on one ring or two rows.
//!
//! ```text
//! minimise sum_i w_i d(theta; X_i)^2 + b^2 sum_i v_i |n_i - n(theta; X_i)|^2         tangential parts, on two axes across n_i
//! b = `Tuning::place_over_normal`
//! v_i = min(1, 1.345 s/|n_i - n|)                                                        s = mad |n_i - n|
//! ```
//!
//! Lengths are in units of the patch's size. The fit only says where the equations of the evidence are placed and which contacts do
//! not belong; how much normals count beside positions, the evidence finds from the contacts.

use crate::bodies::Tuning;
use crate::recognition::kinds::Model;
use palpate_numeric::statistics::{huber_weight, mad};
use palpate_numeric::vector::{Vector, cross, dot, minus, norm, unit};

/// Step of the differences, in units of the patch.
const STEP_OF_DIFFERENCES: f64 = 1e-6;

/// Measured normals with two axes across each, and their weights.
#[derive(Clone, Debug)]
pub(super) struct Directions {
    measured: Vec<Vector>,
    across: Vec<[Vector; 2]>,
    weights: Vec<f64>,
    /// No scale of their errors is below this.
    floor: f64,
    /// Error of a position over that of a normal.
    of_normal: f64,
}

impl Directions {
    /// Of unit normals, zero where unknown, that err by `floor` at least.
    pub(super) fn new(normals: &[Vector], floor: f64, tuning: &Tuning) -> Directions {
        let across = |n: &Vector| {
            let axis = if n[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let first = cross(*n, axis);
            let first = if norm(first) > 0.0 { unit(first) } else { first };
            [first, cross(*n, first)]
        };
        let weights = normals.iter().map(|n| if norm(*n) > 0.0 { 1.0 } else { 0.0 }).collect();
        let (measured, across) = (normals.to_vec(), normals.iter().map(across).collect());
        Directions { measured, across, weights, floor, of_normal: tuning.place_over_normal }
    }

    fn parts(&self, i: usize, normal: Vector) -> [f64; 2] {
        self.across[i].map(|axis| dot(minus(self.measured[i], normal), axis))
    }

    /// By how much each known normal is off, as a chord.
    pub(super) fn errors(&self, model: &Model, points: &[Vector]) -> Vec<f64> {
        let known = (0..points.len()).filter(|&i| self.measured[i] != [0.0; 3]);
        known.map(|i| norm(minus(self.measured[i], model.distance_and_normal(points[i]).1))).collect()
    }

    /// Weighs every normal by how far it is off.
    pub(super) fn weigh(&mut self, model: &Model, points: &[Vector]) {
        let scale = mad(self.errors(model, points)).max(self.floor) + 1e-12;
        for (i, point) in points.iter().enumerate().filter(|(i, _)| self.measured[*i] != [0.0; 3]) {
            let off = norm(minus(self.measured[i], model.distance_and_normal(*point).1));
            self.weights[i] = huber_weight(off, scale);
        }
    }

    /// Their part of what is minimised.
    pub(super) fn cost(&self, model: &Model, points: &[Vector]) -> f64 {
        let one = |(i, point): (usize, &Vector)| {
            let [a, b] = self.parts(i, model.distance_and_normal(*point).1);
            self.weights[i] * (a * a + b * b)
        };
        self.of_normal * self.of_normal * points.iter().enumerate().map(one).sum::<f64>()
    }

    /// Adds their equations to the lower triangle of the normal matrix and to the right-hand side.
    pub(super) fn add(&self, model: &Model, points: &[Vector], normal: &mut [[f64; 6]; 6], right: &mut [f64; 6]) {
        let p = model.kind().unknowns();
        let moved = |j: usize, by: f64| {
            let mut step = [0.0; 6];
            step[j] = by;
            Model::new(model.kind(), model.kind().moved(model.theta(), &step[..p]))
        };
        let beside: Vec<[Model; 2]> =
            (0..p).map(|j| [moved(j, STEP_OF_DIFFERENCES), moved(j, -STEP_OF_DIFFERENCES)]).collect();
        for (i, point) in points.iter().enumerate().filter(|(i, _)| self.weights[*i] > 0.0) {
            let weight = self.of_normal * self.of_normal * self.weights[i];
            let here = self.parts(i, model.distance_and_normal(*point).1);
            let mut by = [[0.0; 6]; 2];
            for (j, pair) in beside.iter().enumerate() {
                let [ahead, behind] = pair.each_ref().map(|m| self.parts(i, m.distance_and_normal(*point).1));
                (0..2).for_each(|side| by[side][j] = (ahead[side] - behind[side]) / (2.0 * STEP_OF_DIFFERENCES));
            }
            for (by, here) in by.iter().zip(here) {
                for a in 0..p {
                    right[a] -= weight * by[a] * here;
                    (0..=a).for_each(|b| normal[a][b] += weight * by[a] * by[b]);
                }
            }
        }
    }
}
