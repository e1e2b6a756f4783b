//! The departure of a body from its base: a gaussian process over the base's feet or in space, carried by a few places.
//!
//! ```text
//! F(p) = d(p) - f(q) = 0                  the surface; d the distance from the base; q the foot of p, or p itself
//! f(q) = phi(q)' w,   phi(q)' = k(q, c) L^-T,   L L' = k(c, c),   w ~ N(0, tau^2)          k(q, c) = exp(-|q - c|^2 / 2 l^2)
//! normal grad F / |grad F|         shape operator -T' (hess d - hess f) T / |grad F|, T: two directions across the normal
//! ```
//!
//! Over the feet nothing that lies above another place can be followed, which is why noise is told from shape; derivatives of f count along
//! the base. In space it holds for departures as large as the body, where errors are small beside l. The places c are chosen farthest from each other among the contacts (T. Gonzalez, *Theor. Comput. Sci.* 38 (1985) 293), at least half a
//! length apart. C. Rasmussen and C. Williams, *Gaussian Processes for Machine Learning*, section 8.3.2.

use faer::{Mat, MatMut};

use crate::dense;
use palpate_numeric::vector::{Vector, along, dot, minus};

/// Places nearer than this many lengths tell nothing that their neighbour does not.
const APART: f64 = 0.7;

/// Added to the variance of every place, so that the factor exists.
const JITTER: f64 = 1e-8;

/// What a departure is a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepartureOver {
    /// The foot of a place on the base.
    Feet,
    /// The place itself.
    Space,
}

/// A process of one length.
#[derive(Debug)]
pub(super) struct DepartureProcess {
    pub(super) over: DepartureOver,
    places: Vec<Vector>,
    lower: Mat<f64>,
    length: f64,
}

impl DepartureProcess {
    pub(super) fn new(feet: &[Vector], over: DepartureOver, length: f64, most: usize) -> Option<DepartureProcess> {
        let places = spread(feet, APART * length, most);
        let count = places.len();
        let kernel = Mat::from_fn(count, count, |i, j| {
            correlation(minus(places[i], places[j]), length) + if i == j { JITTER } else { 0.0 }
        });
        Some(DepartureProcess { over, lower: dense::cholesky(&kernel)?, places, length })
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// `k(q, c)` at a place for all carriers c.
    pub(super) fn values(&self, q: Vector) -> impl Iterator<Item = f64> + '_ {
        self.places.iter().map(move |c| correlation(minus(q, *c), self.length))
    }

    /// Derivatives of `k(q, c)` along two directions.
    pub(super) fn slopes(&self, q: Vector, directions: [Vector; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        let square = self.length * self.length;
        self.places.iter().map(move |c| {
            let from = minus(q, *c);
            let value = correlation(from, self.length) / square;
            directions.map(|direction| -dot(from, direction) * value)
        })
    }

    /// Rows of `k` made rows of `phi = k L^-T`, in place.
    pub(super) fn whiten(&self, rows: MatMut<'_, f64>) {
        dense::whiten(&self.lower, rows.transpose_mut());
    }

    /// `L^-T w`: the departure is `k(q, c)` times it.
    pub(super) fn coefficients(&self, weights: &[f64]) -> Vec<f64> {
        let mut of_places = weights.to_vec();
        dense::backward(&self.lower, &mut of_places);
        of_places
    }

    /// The departure of such coefficients at a place, its gradient and its Hessian.
    pub(super) fn jet(&self, coefficients: &[f64], p: Vector) -> DepartureJet {
        let over = 1.0 / (self.length * self.length);
        let mut jet = DepartureJet { value: 0.0, gradient: [0.0; 3], hessian: [[0.0; 3]; 3] };
        for (c, weight) in self.places.iter().zip(coefficients) {
            let from = minus(p, *c).map(|v| v * over);
            let value = weight * (-0.5 * dot(from, from) / over).exp();
            jet.value += value;
            for i in 0..3 {
                jet.gradient[i] -= value * from[i];
                (0..=i).for_each(|j| jet.hessian[i][j] += value * from[i] * from[j]);
                jet.hessian[i][i] -= value * over;
            }
        }
        (0..3).for_each(|i| (0..i).for_each(|j| jet.hessian[j][i] = jet.hessian[i][j]));
        jet
    }
}

/// A departure at one place.
pub(super) struct DepartureJet {
    pub(super) value: f64,
    pub(super) gradient: Vector,
    pub(super) hessian: [Vector; 3],
}

impl DepartureJet {
    /// Derivatives along the surface across a normal alone.
    pub(super) fn across(self, normal: Vector) -> DepartureJet {
        let level = |v: Vector| along(v, -dot(v, normal), normal);
        let rows = self.hessian.map(level);
        let columns = [0, 1, 2].map(|j| level([rows[0][j], rows[1][j], rows[2][j]]));
        let hessian = [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i]]);
        DepartureJet { gradient: level(self.gradient), hessian, ..self }
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
