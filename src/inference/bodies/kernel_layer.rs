//! A gaussian process of one length, carried by a few places.
//!
//! ```text
//! f(q) = phi(q)' w,   phi(q)' = k(q, c) L^-T,   L L' = k(c, c)          k(q, c) = exp(-|q - c|^2 / 2 l^2)
//! ```
//!
//! The places c are chosen farthest from each other among the contacts (T. Gonzalez, *Theor. Comput. Sci.* 38 (1985) 293).
//! C. Rasmussen and C. Williams, *Gaussian Processes for Machine Learning*, section 8.3.2.

use faer::{Mat, MatMut};

use super::coordinates::{DepartureJet, DepartureOver};
use crate::dense;
use palpate_numeric::vector::{Vector, dot, minus};

/// Places nearer than this many lengths tell nothing that their neighbour does not: of a departure that is small beside the body, and of
/// one that is as large, where a share of it is as much as the noise.
const APART: [f64; 2] = [0.7, 0.4];

/// Added to the variance of every place, so that the factor exists.
const JITTER: f64 = 1e-8;

/// One length of a departure.
#[derive(Debug)]
pub(super) struct KernelLayer {
    over: DepartureOver,
    places: Vec<Vector>,
    lower: Mat<f64>,
    length: f64,
}

impl KernelLayer {
    pub(super) fn new(at: &[Vector], over: DepartureOver, length: f64, most: usize) -> Option<KernelLayer> {
        let places = spread(at, APART[usize::from(over != DepartureOver::Feet)] * length, most);
        let count = places.len();
        let value = |q: Vector, c: Vector| over.images(c).map(|c| correlation(minus(q, c), length)).sum::<f64>();
        let kernel = Mat::from_fn(count, count, |i, j| value(places[i], places[j]) + if i == j { JITTER } else { 0.0 });
        Some(KernelLayer { over, lower: dense::cholesky(&kernel)?, places, length })
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// `k(q, c)` at a place for all carriers c.
    pub(super) fn values(&self, q: Vector) -> impl Iterator<Item = f64> + '_ {
        let value = move |c: Vector| correlation(minus(q, c), self.length);
        self.places.iter().map(move |c| self.over.images(*c).map(value).sum())
    }

    /// Derivatives of `k(q, c)` along two directions.
    pub(super) fn slopes(&self, q: Vector, directions: [Vector; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        let square = self.length * self.length;
        self.places.iter().map(move |c| {
            self.over.images(*c).fold([0.0; 2], |[a, b], c| {
                let from = minus(q, c);
                let value = correlation(from, self.length) / square;
                [a - dot(from, directions[0]) * value, b - dot(from, directions[1]) * value]
            })
        })
    }

    /// Rows of `k` made rows of `phi = k L^-T`, in place.
    pub(super) fn whiten(&self, rows: MatMut<'_, f64>) {
        dense::whiten(&self.lower, rows.transpose_mut());
    }

    /// `L^-T w`, in place: the departure is `k(q, c)` times it.
    pub(super) fn carry(&self, weights: &mut [f64]) {
        dense::backward(&self.lower, weights);
    }

    /// Adds value, gradient and the lower half of the Hessian in the coordinates that the departure is a function of.
    pub(super) fn add(&self, coefficients: &[f64], q: Vector, jet: &mut DepartureJet) {
        let over = 1.0 / (self.length * self.length);
        let images = self.places.iter().zip(coefficients).flat_map(|(c, w)| self.over.images(*c).map(move |c| (c, w)));
        for (c, weight) in images {
            let from = minus(q, c).map(|v| v * over);
            let value = weight * (-0.5 * dot(from, from) / over).exp();
            jet.value += value;
            for i in 0..3 {
                jet.gradient[i] -= value * from[i];
                (0..=i).for_each(|j| jet.hessian[i][j] += value * from[i] * from[j]);
                jet.hessian[i][i] -= value * over;
            }
        }
    }
}

fn correlation(between: Vector, length: f64) -> f64 {
    (-0.5 * dot(between, between) / (length * length)).exp()
}

/// Places far from each other, at least `apart`.
fn spread(feet: &[Vector], apart: f64, most: usize) -> Vec<Vector> {
    let Some(first) = feet.first() else { return Vec::new() };
    let mut places = vec![*first];
    let square = |a: &Vector, b: &Vector| dot(minus(*a, *b), minus(*a, *b));
    let mut distance: Vec<f64> = feet.iter().map(|q| square(q, first)).collect();
    while places.len() < most {
        let farthest = (0..feet.len()).max_by(|a, b| distance[*a].total_cmp(&distance[*b]).then(b.cmp(a)));
        let Some(next) = farthest.filter(|i| distance[*i] > apart * apart) else { break };
        let place = feet[next];
        places.push(place);
        distance.iter_mut().zip(feet).for_each(|(d, q)| *d = d.min(square(q, &place)));
    }
    places
}
