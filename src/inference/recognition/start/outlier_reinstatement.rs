//! Contacts that lie far off the surface of constant curvatures and belong to it all the same: neighbours lie off it alike,
//! because the surface departs from constant curvatures there.
//!
//! ```text
//! d_i = f(u_i, v_i) + e_i        f: degrees 0 to 2 free, degrees 3 and 4 of natural size, f = sum_j z_j s_j u^a v^b
//! minimise sum_i w_i (d_i - f_i)^2 / s^2 + sum_j z_j^2 (degrees 3 and 4)       w: Huber's weights, s their robust scale
//! taken back: |d_i - f_i| < limit, the distance from which on a contact is an outlier
//! ```
//!
//! The corners of a bump bend the other way than its middle. Without this step they were left out, and with them what told
//! S there. A blunder stays out: no neighbour lies off the surface as it does, and the departure is held to its natural size
//! (`discrepancy/polynomial_prior.rs`). Huber's weights: P. J. Huber, *Robust Statistics*, 1981.

use faer::Mat;

use crate::bodies::Tuning;
use crate::dense;
use crate::recognition::discrepancy::{NATURAL_TERMS, POLE, natural_size};
use crate::recognition::kinds::ConstantCurvature;
use palpate_numeric::statistics::huber_weight;

use super::descent::scale_of;

use palpate_numeric::vector::Vector;

/// Powers of degrees 0 to 2, whose size is free: the robust surface is moved by what it takes for outliers.
const FREE: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Rounds of reweighting; the weights of contacts that are far off settle in a few.
const ROUNDS: usize = 20;

/// Marks as belonging what the departure explains; `sample` are the contacts that it is fitted to, and `distances` those of
/// all contacts from `surface`; the scale of what it leaves is not below `floor`.
pub(super) fn take_back(
    surface: &ConstantCurvature,
    points: &[Vector],
    distances: &[f64],
    sample: &[usize],
    (limit, floor): (f64, f64),
    belongs: &mut [bool],
    tuning: &Tuning,
) {
    let off: Vec<usize> = (0..points.len()).filter(|&i| !belongs[i]).collect();
    if off.is_empty() || sample.len() < tuning.taken_back_from {
        return;
    }
    let charts: Vec<[f64; 2]> = sample.iter().map(|&i| surface.chart(points[i])).collect();
    if charts.iter().any(|c| surface.form().width(c[0]).abs() < POLE) {
        return;
    }
    let given: Vec<f64> = sample.iter().map(|&i| distances[i]).collect();
    let Some(departure) = Departure::fitted(surface, &charts, &given, floor) else { return };
    let explained = |i: &usize| (distances[*i] - departure.at(surface.chart(points[*i]))).abs() < limit;
    let back: Vec<usize> = off.iter().copied().filter(explained).collect();
    if back.len() as f64 >= tuning.taken_back * off.len() as f64 {
        back.into_iter().for_each(|i| belongs[i] = true);
    }
}

/// A polynomial of fourth degree over the chart.
struct Departure {
    /// Middle of the chart.
    middle: [f64; 2],
    /// Prior standard deviation of every term; infinite where the size is free.
    sizes: [f64; FREE.len() + NATURAL_TERMS.len()],
    /// Coefficients of the terms, each times its power.
    coefficients: Vec<f64>,
}

impl Departure {
    /// The departure that most contacts follow; `None` where they do not determine one.
    fn fitted(surface: &ConstantCurvature, charts: &[[f64; 2]], distances: &[f64], floor: f64) -> Option<Departure> {
        let middle = [0, 1].map(|k| {
            let along = charts.iter().map(|c| c[k]);
            0.5 * (along.clone().fold(f64::INFINITY, f64::min) + along.fold(f64::NEG_INFINITY, f64::max))
        });
        let sizes = std::array::from_fn(|j| {
            if j < FREE.len() { f64::INFINITY } else { natural_size(surface, NATURAL_TERMS[j - FREE.len()]) }
        });
        let mut found = Departure { middle, sizes, coefficients: vec![0.0; FREE.len() + NATURAL_TERMS.len()] };
        let rows: Vec<_> = charts.iter().map(|c| found.terms(*c)).collect();
        let mut left = distances.to_vec();
        let mut last = f64::INFINITY;
        for _ in 0..ROUNDS {
            let scale = scale_of(&left, floor);
            if (scale - last).abs() < 1e-4 * scale {
                break;
            }
            last = scale;
            let weights: Vec<f64> = left.iter().map(|d| huber_weight(*d, scale)).collect();
            found.coefficients = found.weighted(&rows, distances, &weights, scale)?;
            left = charts.iter().zip(distances).map(|(c, d)| d - found.at(*c)).collect();
        }
        Some(found)
    }

    /// The terms at a chart point.
    fn terms(&self, [u, v]: [f64; 2]) -> [f64; FREE.len() + NATURAL_TERMS.len()] {
        let [u, v] = [u - self.middle[0], v - self.middle[1]];
        std::array::from_fn(|j| {
            let [a, b] = if j < FREE.len() { FREE[j] } else { NATURAL_TERMS[j - FREE.len()] };
            u.powi(a as i32) * v.powi(b as i32)
        })
    }

    fn at(&self, chart: [f64; 2]) -> f64 {
        self.terms(chart).iter().zip(&self.coefficients).map(|(t, c)| t * c).sum()
    }

    /// Coefficients under these weights and a noise of `scale`.
    fn weighted(
        &self,
        rows: &[[f64; FREE.len() + NATURAL_TERMS.len()]],
        distances: &[f64],
        weights: &[f64],
        scale: f64,
    ) -> Option<Vec<f64>> {
        let count = self.sizes.len();
        let mut normal = Mat::<f64>::zeros(count, count);
        let mut right = vec![0.0; count];
        for ((row, d), w) in rows.iter().zip(distances).zip(weights) {
            for i in 0..count {
                right[i] += w * row[i] * d;
                (0..=i).for_each(|j| normal[(i, j)] += w * row[i] * row[j]);
            }
        }
        (0..count).for_each(|i| normal[(i, i)] = normal[(i, i)] * (1.0 + 1e-12) + (scale / self.sizes[i]).powi(2));
        let lower = dense::cholesky(&normal)?;
        dense::solve(&lower, &mut right);
        right.iter().all(|c| c.is_finite()).then_some(right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 49 places of a patch of radius 2, and what lies off it.
    fn belongs(off: impl Fn(f64, f64) -> f64, blunder: Option<usize>) -> Vec<bool> {
        let surface = ConstantCurvature::new([0.0, 0.0, 0.0, 0.5, 0.5, 0.0]);
        let limit = 0.02;
        let flat: Vec<[f64; 2]> = (0..49).map(|k| [(k % 7) as f64 / 3.0 - 1.0, (k / 7) as f64 / 3.0 - 1.0]).collect();
        let mut distances: Vec<f64> = flat.iter().map(|[u, v]| off(*u, *v)).collect();
        distances.iter_mut().enumerate().for_each(|(i, d)| *d += 1e-3 * ((i * 7919) as f64).sin());
        blunder.into_iter().for_each(|i| distances[i] += 0.3);
        let points: Vec<Vector> = flat.iter().map(|[u, v]| surface.point(*u, *v, 0.0)).collect();
        let mut belongs: Vec<bool> = distances.iter().map(|d| d.abs() < limit).collect();
        let sample: Vec<usize> = (0..49).collect();
        take_back(&surface, &points, &distances, &sample, (limit, 0.0), &mut belongs, &Tuning::default());
        belongs
    }

    #[test]
    fn corners_that_bend_otherwise_are_taken_back_and_blunders_are_not() {
        let quartic = |u: f64, v: f64| 0.02 * (u * u + v * v).powi(2);
        assert!(belongs(quartic, None).iter().all(|b| *b));
        let found = belongs(quartic, Some(20));
        assert!((0..49).all(|i| found[i] == (i != 20)), "{found:?}");
        let found = belongs(quartic, Some(48));
        assert!(!found[48] && found.iter().filter(|b| !**b).count() == 1, "a blunder in a corner: {found:?}");
    }

    #[test]
    fn departures_beyond_their_natural_size_stay_out() {
        let found = belongs(|u, v| 5.0 * u * v * v * v, None);
        assert!(found.iter().any(|b| !b));
    }
}
