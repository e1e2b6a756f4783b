//! A gaussian process of one length, carried by a few places.
//!
//! ```text
//! f(q) = phi(q)' w,   phi(q)' = k(q, c) L^-T,   L L' = k(c, c)          k: `departure_kernel`
//! ```
//!
//! The places c are chosen farthest from each other among the contacts (T. Gonzalez, *Theor. Comput. Sci.* 38 (1985) 293).
//! C. Rasmussen and C. Williams, *Gaussian Processes for Machine Learning*, section 8.3.2.

use faer::{Mat, MatMut};

use super::coordinates::{DepartureJet, DepartureOver};
use super::departure_kernel::DepartureKernel;
use crate::dense;
use palpate_numeric::vector::{Vector, dot, minus};

/// Added to the variance of every place, so that the factor exists.
const JITTER: f64 = 1e-8;

/// One length of a departure.
#[derive(Debug)]
pub(super) struct KernelLayer {
    over: DepartureOver,
    places: Vec<Vector>,
    lower: Mat<f64>,
    kernel: DepartureKernel,
}

impl KernelLayer {
    pub(super) fn new(at: &[Vector], over: DepartureOver, of: DepartureKernel, most: usize) -> Option<KernelLayer> {
        let places = spread(at, of.apart * of.length, most);
        let count = places.len();
        let value = |q: Vector, c: Vector| over.images(c).map(|c| of.at(square(q, c))[0]).sum::<f64>();
        let kernel = Mat::from_fn(count, count, |i, j| value(places[i], places[j]) + if i == j { JITTER } else { 0.0 });
        Some(KernelLayer { over, lower: dense::cholesky(&kernel)?, places, kernel: of })
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    pub(super) fn kernel(&self) -> DepartureKernel {
        self.kernel
    }

    /// `k(q, c)` at a place for all carriers c.
    pub(super) fn values(&self, q: Vector) -> impl Iterator<Item = f64> + '_ {
        let value = move |c: Vector| self.kernel.at(square(q, c))[0];
        self.places.iter().map(move |c| self.over.images(*c).map(value).sum())
    }

    /// Derivatives of `k(q, c)` along two directions.
    pub(super) fn slopes(&self, q: Vector, directions: [Vector; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.places.iter().map(move |c| {
            self.over.images(*c).fold([0.0; 2], |[a, b], c| {
                let from = minus(q, c);
                let first = self.kernel.at(dot(from, from))[1];
                [a + dot(from, directions[0]) * first, b + dot(from, directions[1]) * first]
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
        let images = self.places.iter().zip(coefficients).flat_map(|(c, w)| self.over.images(*c).map(move |c| (c, w)));
        for (c, weight) in images {
            let from = minus(q, c);
            let [value, first, second] = self.kernel.at(dot(from, from)).map(|k| weight * k);
            jet.value += value;
            for i in 0..3 {
                jet.gradient[i] += first * from[i];
                (0..=i).for_each(|j| jet.hessian[i][j] += second * from[i] * from[j]);
                jet.hessian[i][i] += first;
            }
        }
    }
}

fn square(q: Vector, c: Vector) -> f64 {
    dot(minus(q, c), minus(q, c))
}

/// Places far from each other, at least `apart`.
pub(super) fn spread(feet: &[Vector], apart: f64, most: usize) -> Vec<Vector> {
    let Some(first) = feet.first() else { return Vec::new() };
    let mut places = vec![*first];
    let mut distance: Vec<f64> = feet.iter().map(|q| square(*q, *first)).collect();
    while places.len() < most {
        let farthest = (0..feet.len()).max_by(|a, b| distance[*a].total_cmp(&distance[*b]).then(b.cmp(a)));
        let Some(next) = farthest.filter(|i| distance[*i] > apart * apart) else { break };
        let place = feet[next];
        places.push(place);
        distance.iter_mut().zip(feet).for_each(|(d, q)| *d = d.min(square(*q, place)));
    }
    places
}
