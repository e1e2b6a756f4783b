//! The departure of a body from its base: a gaussian process over the feet, carried by a few places.
//!
//! ```text
//! f(q) = phi(q)' w,   phi(q)' = k(q, c) L^-T,   L L' = k(c, c),   w ~ N(0, tau^2)          k(q, c) = exp(-|q - c|^2 / 2 l^2)
//! curvatures of the displaced base = those of the base and the second derivatives of f, in an orthonormal tangent frame
//! normal of the displaced base = g - (grad f along the base)
//! ```
//!
//! The places c are chosen farthest from each other among the feet (T. Gonzalez, *Theor. Comput. Sci.* 38 (1985) 293), at least half a
//! length apart. C. Rasmussen and C. Williams, *Gaussian Processes for Machine Learning*, section 8.3.2.

use faer::Mat;

use crate::dense;
use palpate_numeric::vector::{Vector, dot, minus};

/// Places nearer than this many lengths tell nothing that their neighbour does not.
const APART: f64 = 0.7;

/// Added to the variance of every place, so that the factor exists.
const JITTER: f64 = 1e-8;

/// A process of one length.
#[derive(Debug)]
pub(super) struct DepartureProcess {
    places: Vec<Vector>,
    lower: Mat<f64>,
    length: f64,
}

impl DepartureProcess {
    pub(super) fn new(feet: &[Vector], length: f64, most: usize) -> Option<DepartureProcess> {
        let places = spread(feet, APART * length, most);
        let count = places.len();
        let kernel = Mat::from_fn(count, count, |i, j| {
            correlation(minus(places[i], places[j]), length) + if i == j { JITTER } else { 0.0 }
        });
        Some(DepartureProcess { lower: dense::cholesky(&kernel)?, places, length })
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// `phi(q)`.
    pub(super) fn values(&self, q: Vector) -> Vec<f64> {
        let mut row: Vec<f64> = self.places.iter().map(|c| correlation(minus(q, *c), self.length)).collect();
        dense::forward(&self.lower, &mut row);
        row
    }

    /// Derivatives of `phi(q)` along a direction.
    pub(super) fn slopes(&self, q: Vector, direction: Vector) -> Vec<f64> {
        let square = self.length * self.length;
        let slope = |c: &Vector| {
            let from = minus(q, *c);
            -dot(from, direction) / square * correlation(from, self.length)
        };
        let mut row: Vec<f64> = self.places.iter().map(slope).collect();
        dense::forward(&self.lower, &mut row);
        row
    }
}

impl DepartureProcess {
    /// Second derivatives of `phi(q)` along pairs of directions, weighted by w: those of the departure itself.
    pub(super) fn bending(&self, weights: &[f64], q: Vector, [first, second]: [Vector; 2]) -> [f64; 3] {
        let square = self.length * self.length;
        // phi(q)' w = k(q, c) (L^-T w)
        let mut of_places = weights.to_vec();
        dense::backward(&self.lower, &mut of_places);
        let mut sums = [0.0; 3];
        for (c, weight) in self.places.iter().zip(&of_places) {
            let from = minus(q, *c);
            let along_both = [first, second].map(|t| dot(from, t) / square);
            let value = weight * correlation(from, self.length);
            sums[0] += value * (along_both[0] * along_both[0] - 1.0 / square);
            sums[1] += value * along_both[0] * along_both[1];
            sums[2] += value * (along_both[1] * along_both[1] - 1.0 / square);
        }
        sums
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
