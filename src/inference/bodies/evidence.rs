//! How probable contacts are under a kind of primitive with a departure of one length and size, and what theta then is.
//!
//! ```text
//! d + J x - Phi w = e,  e ~ N(0, s^2 (1, 1/v)),  w ~ N(0, (rho s)^2)         x: moves of the primitive, v = s^2 / s_n^2
//! A = G_d + v G_n + diag(1/rho^2, s^2 / width^2)                              G: Gram matrices of the rows of distances and normals
//! ln p = N_n/2 ln v - nu/2 ln(pi RSS) + ln Gamma(nu/2) - ln|A| / 2 - M ln rho + ln p(theta) + ln p(false),   nu = N - k
//! RSS >= nu floor^2
//! ```
//!
//! The prior of s is 1/s, and s is integrated. ln v has a gaussian prior, and is integrated by Laplace's method about the v where
//! ln p is largest: few distances could otherwise be followed exactly while the normals pay. w and x are drawn together from A.

use std::f64::consts::PI;
use std::sync::Arc;

use faer::Mat;
use statrs::function::beta::ln_beta;
use statrs::function::gamma::ln_gamma;

use super::departure::DepartureProcess;
use super::mode::{Mode, aligned, log_false};
use super::prior::{log_prior, widths};
use super::sample::BodySample;
use super::tuning::Tuning;
use crate::dense;
use crate::primitives::descent::rows;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive, axes_along};
use palpate_numeric::vector::{along, dot};

/// Steps of the golden section over ln v, and how far to both sides of the mode's v it looks.
const SECTIONS: usize = 11;
const SPAN: f64 = 4.0;

/// Step of ln v by which the curvature of ln p is taken.
const STEP_OF_V: f64 = 0.2;

/// What one hypothesis says.
#[derive(Clone, Debug)]
pub(crate) struct BodyHypothesis {
    /// Number of the kind's linearisation.
    pub(super) of: usize,
    /// Length of the departure and its size over the sd of a contact; `None` without one.
    pub(super) departure: Option<[f64; 2]>,
    pub(super) log_evidence: f64,
    /// The departure's weights, then the move to the likeliest primitive by the kind's free unknowns.
    pub(super) solution: Vec<f64>,
    /// Lower factor of their precision in units of one over the sd.
    pub(super) lower: Mat<f64>,
    /// What the weights are those of.
    pub(super) process: Option<Arc<DepartureProcess>>,
    /// Sds of distances and normals.
    pub(super) sd: [f64; 2],
    /// Root mean square of the departure at the contacts.
    pub(super) departure_rms: f64,
    /// Degrees of freedom of the sd.
    pub(super) freedom: f64,
}

impl BodyHypothesis {
    /// The move to the likeliest primitive.
    pub(super) fn step(&self) -> &[f64] {
        &self.solution[self.process.as_ref().map_or(0, |process| process.len())..]
    }

    /// ln of the factor's determinant.
    #[cfg(test)]
    pub(super) fn lower_determinant(&self) -> f64 {
        0.5 * dense::log_det(&self.lower)
    }

    /// Sd of a single contact.
    pub(crate) fn scatter(&self) -> f64 {
        self.sd[0]
    }

    /// Sd of a normal in each tangent direction, radians.
    pub(crate) fn sd_of_normals(&self) -> f64 {
        self.sd[1]
    }

    /// Root mean square of the departure at the contacts.
    pub(crate) fn departure_size(&self) -> f64 {
        self.departure_rms
    }

    /// Length of the departure.
    pub(crate) fn length(&self) -> Option<f64> {
        self.departure.map(|[length, _]| length)
    }

    /// Degrees of freedom of the sd.
    pub(crate) fn freedom(&self) -> f64 {
        self.freedom
    }
}

/// The rows of one kind about one primitive, with their Gram matrices for a length of the departure.
pub(super) struct LinearisedBase<'a> {
    pub(super) primitive: Primitive,
    pub(super) members: Vec<usize>,
    sample: &'a BodySample,
    sd: [f64; 2],
    /// ln p of what does not depend on the departure.
    constant: f64,
    rows: [f64; 2],
}

/// Gram matrices over columns `w, x, residual`.
struct RowGrams {
    /// Of distances and of normals.
    of: [Mat<f64>; 2],
    places: usize,
}

impl<'a> LinearisedBase<'a> {
    pub(super) fn new(mode: &Mode, sample: &'a BodySample, tuning: &Tuning) -> LinearisedBase<'a> {
        let members = mode.members();
        let away = mode.others();
        let normals = members.iter().filter(|i| sample.normal(**i).is_some()).count() as f64;
        let falsely: f64 = away.iter().map(|i| log_false(tuning, sample.normal(*i).is_some())).sum();
        let (count, strays) = (sample.len() as f64, away.len() as f64);
        let share = ln_beta(1.0 + strays, tuning.false_prior + count - strays) - ln_beta(1.0, tuning.false_prior);
        let constant = log_prior(&mode.primitive) + falsely + share;
        let rows = [members.len() as f64, 2.0 * normals];
        LinearisedBase { primitive: mode.primitive, members, sample, sd: mode.sd, constant, rows }
    }

    /// The same about a primitive moved by a node's step.
    pub(super) fn moved(self, step: &[f64]) -> LinearisedBase<'a> {
        let primitive = moved(&self.primitive, step).about([0.0; 3]);
        let constant = self.constant - log_prior(&self.primitive) + log_prior(&primitive);
        LinearisedBase { primitive, constant, ..self }
    }

    /// ln p of what the contacts left out add; of none of them false, the prior of that alone.
    #[cfg(test)]
    pub(super) fn of_no_false(&self) -> f64 {
        self.constant - log_prior(&self.primitive)
    }

    /// The primitive drawn by independent gaussians of one.
    #[cfg(test)]
    pub(super) fn drawn(&self, node: &BodyHypothesis, gaussians: &[f64]) -> Primitive {
        let mut step = gaussians.to_vec();
        dense::backward(&node.lower, &mut step);
        step.iter_mut().zip(&node.solution).for_each(|(s, mean)| *s = mean + node.sd[0] * *s);
        moved(&self.primitive, &step)
    }

    /// Log evidence where there is no departure.
    pub(super) fn without_departure(&self, tuning: &Tuning) -> Option<f64> {
        Some(self.node(0, &self.grams(None), None, tuning.exact.ln(), tuning)?.log_evidence)
    }

    /// Nodes without a departure and with departures of all lengths and sizes.
    pub(super) fn nodes(&self, of: usize, tuning: &Tuning) -> Vec<BodyHypothesis> {
        let mut found: Vec<BodyHypothesis> = Vec::new();
        let plain = self.grams(None);
        found.extend(self.node(of, &plain, None, tuning.exact.ln(), tuning));
        let each = ((1.0 - tuning.exact) / (tuning.lengths.len() * tuning.departures.len()) as f64).ln();
        let feet = self.feet();
        for length in tuning.lengths {
            let Some(process) = DepartureProcess::new(&feet, length, tuning.most_features) else { continue };
            let grams = self.grams(Some(&process));
            let process = Arc::new(process);
            let of_size = |size: &f64| {
                let node = self.node(of, &grams, Some([length, *size]), each, tuning)?;
                Some(BodyHypothesis { process: Some(process.clone()), ..node })
            };
            found.extend(tuning.departures.iter().filter_map(of_size));
        }
        found
    }

    fn feet(&self) -> Vec<[f64; 3]> {
        let foot = |i: &usize| {
            let (d, normal) = self.primitive.nearest(self.sample.points[*i]);
            along(self.sample.points[*i], -d, normal)
        };
        self.members.iter().map(foot).collect()
    }

    fn grams(&self, departure: Option<&DepartureProcess>) -> RowGrams {
        let places = departure.map_or(0, DepartureProcess::len);
        let free = self.primitive.kind.free();
        let width = places + free.len() + 1;
        let known: Vec<bool> = self.members.iter().map(|i| self.sample.normal(*i).is_some()).collect();
        let normals = known.iter().filter(|k| **k).count();
        let mut distances = Mat::<f64>::zeros(self.members.len(), width);
        let mut tangential = Mat::<f64>::zeros(2 * normals, width);
        let mut next = 0;
        for (r, &i) in self.members.iter().enumerate() {
            let place = self.sample.points[i];
            let (d, normal) = self.primitive.nearest(place);
            let foot = along(place, -d, normal);
            let given = self.sample.normal(i).map(|n| aligned(n, normal));
            let all = rows(&self.primitive, place, given.unwrap_or([0.0; 3]));
            if let Some(departure) = departure {
                departure.values(foot).iter().enumerate().for_each(|(c, v)| distances[(r, c)] = -v);
            }
            free.iter().enumerate().for_each(|(c, &a)| distances[(r, places + c)] = all[0].1[a]);
            distances[(r, width - 1)] = d;
            if given.is_none() {
                continue;
            }
            // the rows of a normal are in the primitive's own axes
            let [first, second, _] = axes_along(normal);
            for tangent in [first, second] {
                let own = self.primitive.axes.map(|axis| dot(axis, tangent));
                let project = |of: &dyn Fn(usize) -> f64| (0..3).map(|k| own[k] * of(k)).sum::<f64>();
                if let Some(departure) = departure {
                    let slopes = departure.slopes(foot, tangent);
                    slopes.iter().enumerate().for_each(|(c, v)| tangential[(next, c)] = -v);
                }
                for (c, &a) in free.iter().enumerate() {
                    tangential[(next, places + c)] = project(&|k| all[1 + k].1[a]);
                }
                tangential[(next, width - 1)] = project(&|k| all[1 + k].0);
                next += 1;
            }
        }
        RowGrams { of: [distances, tangential].map(|rows| rows.transpose() * &rows), places }
    }

    fn node(
        &self,
        of: usize,
        grams: &RowGrams,
        departure: Option<[f64; 2]>,
        log_prior: f64,
        tuning: &Tuning,
    ) -> Option<BodyHypothesis> {
        let (best, of_v) = if self.rows[1] > 0.0 { self.ratio(grams, departure, tuning) } else { (0.0, 0.0) };
        let found = self.at(grams, departure, best.exp())?;
        Some(BodyHypothesis {
            of,
            departure,
            log_evidence: found.log + of_v + self.constant + log_prior,
            solution: found.solution,
            lower: found.lower,
            process: None,
            sd: [found.sd, found.sd / (0.5 * best).exp()],
            departure_rms: found.departure_rms,
            freedom: (self.rows[0] + self.rows[1] - self.primitive.kind.free().len() as f64).max(1.0),
        })
    }

    /// The likeliest ln v, and what its prior and its width add to ln p there.
    fn ratio(&self, grams: &RowGrams, departure: Option<[f64; 2]>, tuning: &Tuning) -> (f64, f64) {
        let [mean, sd] = tuning.log_ratio.map(|v| 2.0 * v);
        let prior = |log_v: f64| -0.5 * ((log_v - mean) / sd).powi(2);
        let value = |log_v: f64| Some(self.at(grams, departure, log_v.exp())?.log + prior(log_v));
        let [s, sn] = self.sd;
        let middle = (2.0 * (s / sn).ln()).clamp(mean - 3.0 * sd, mean + 3.0 * sd);
        let best = golden(middle, value);
        let beside = [best - STEP_OF_V, best, best + STEP_OF_V].map(|log_v| value(log_v).unwrap_or(f64::NEG_INFINITY));
        let curvature = (2.0 * beside[1] - beside[0] - beside[2]) / (STEP_OF_V * STEP_OF_V);
        let least = 1.0 / (sd * sd);
        let width = if curvature > least { 1.0 / curvature } else { 1.0 / least };
        (best, prior(best) + 0.5 * width.ln() - sd.ln())
    }

    /// Log evidence at the mode's own scales, the best of a few departures: enough to leave out kinds that have no chance.
    pub(super) fn rough(&self, tuning: &Tuning) -> f64 {
        let [s, sn] = self.sd;
        let v = (s / sn).powi(2);
        let of = |departure: Option<&DepartureProcess>, size: Option<[f64; 2]>| {
            self.at(&self.grams(departure), size, v).map_or(f64::NEG_INFINITY, |found| found.log)
        };
        let feet = self.feet();
        let largest = tuning.departures.iter().copied().fold(0.0, f64::max);
        let departed = tuning.lengths.iter().filter_map(|length| {
            let process = DepartureProcess::new(&feet, *length, tuning.most_features)?;
            Some(of(Some(&process), Some([*length, largest])).max(of(Some(&process), Some([*length, 0.1 * largest]))))
        });
        self.constant + departed.fold(of(None, None), f64::max)
    }

    fn at(&self, grams: &RowGrams, departure: Option<[f64; 2]>, v: f64) -> Option<HypothesisSolution> {
        let free = self.primitive.kind.free();
        let (places, unknowns) = (grams.places, free.len());
        let size = places + unknowns;
        let ratio = departure.map_or(1.0, |[_, ratio]| ratio);
        let [distances, normals] = &grams.of;
        let full = |i: usize, j: usize| distances[(i, j)] + v * normals[(i, j)];
        let width = widths(&self.primitive);
        let mut matrix = Mat::from_fn(size, size, full);
        (0..places).for_each(|i| matrix[(i, i)] += 1.0 / (ratio * ratio));
        (0..unknowns).for_each(|i| matrix[(places + i, places + i)] += (self.sd[0] / width[free[i]]).powi(2));
        let lower = dense::cholesky(&matrix)?;
        let mut reduced: Vec<f64> = (0..size).map(|i| -full(i, size)).collect();
        dense::forward(&lower, &mut reduced);
        let square = full(size, size);
        let sum = (square - reduced.iter().map(|b| b * b).sum::<f64>()).max(0.0);
        let [nd, nn] = self.rows;
        let count = nd + nn;
        let freedom = (count - unknowns as f64).max(1.0);
        let floor = self.sample.floor[0].max(self.sample.floor[1] * v.sqrt());
        let sum = sum.max(freedom * floor * floor);
        let log = 0.5 * nn * v.ln() - 0.5 * freedom * PI.ln() + ln_gamma(0.5 * freedom)
            - 0.5 * freedom * sum.ln()
            - 0.5 * dense::log_det(&lower)
            - places as f64 * ratio.ln();
        let variance = sum / freedom;
        let mut solution = reduced;
        dense::backward(&lower, &mut solution);
        let departure_rms = (self.departure_square(grams, &solution) / nd.max(1.0)).sqrt();
        Some(HypothesisSolution { log, solution, lower, sd: variance.sqrt(), departure_rms })
    }

    /// Sum over the contacts of the squared departure.
    fn departure_square(&self, grams: &RowGrams, solution: &[f64]) -> f64 {
        let count = grams.places;
        let product = |i: usize| (0..count).map(|j| grams.of[0][(i, j)] * solution[j]).sum::<f64>();
        (0..count).map(|i| solution[i] * product(i)).sum::<f64>().max(0.0)
    }
}

struct HypothesisSolution {
    log: f64,
    solution: Vec<f64>,
    lower: Mat<f64>,
    sd: f64,
    departure_rms: f64,
}

/// A primitive moved by its free unknowns.
pub(super) fn moved(primitive: &Primitive, step: &[f64]) -> Primitive {
    let mut all = [0.0; MOST_UNKNOWNS];
    primitive.kind.free().iter().zip(step).for_each(|(i, s)| all[*i] = *s);
    primitive.moved(&all)
}

/// Where a function of one number is largest about `middle`; values that are not known count as the least.
fn golden(middle: f64, value: impl Fn(f64) -> Option<f64>) -> f64 {
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let at = |x: f64| value(x).unwrap_or(f64::NEG_INFINITY);
    let (mut lo, mut hi) = (middle - SPAN, middle + SPAN);
    let (mut a, mut b) = (hi - section * (hi - lo), lo + section * (hi - lo));
    let (mut of_a, mut of_b) = (at(a), at(b));
    for _ in 0..SECTIONS {
        if of_a >= of_b {
            (hi, b, of_b) = (b, a, of_a);
            a = hi - section * (hi - lo);
            of_a = at(a);
        } else {
            (lo, a, of_a) = (a, b, of_b);
            b = lo + section * (hi - lo);
            of_b = at(b);
        }
    }
    if of_a >= of_b { a } else { b }
}
