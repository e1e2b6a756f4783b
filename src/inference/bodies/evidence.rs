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

use std::f64::consts::{LN_2, PI};
use std::sync::Arc;

use faer::Mat;
use statrs::function::beta::ln_beta;
use statrs::function::gamma::ln_gamma;

use super::departure::{DepartureOver, DepartureProcess};
use super::division::log_division;
use super::mode::{Mode, is_possible, log_false};
use super::prior::{log_prior, widths};
use super::rows::{BaseRows, RowGrams};
use super::sample::BodySample;
use super::tuning::Tuning;
use crate::dense;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::brent;

/// How far to both sides of the mode's ln v its peak is looked for, how exactly, and values that are asked for at most.
const SPAN: f64 = 4.0;
const EXACTLY: f64 = 0.03;
const VALUES: usize = 14;

/// Sd of a move that is none.
const HELD: f64 = 1e-6;

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

/// The rows of one kind about one primitive, with their Gram matrices for every length of the departure.
pub(super) struct LinearisedBase<'a> {
    pub(super) primitive: Primitive,
    pub(super) members: Vec<usize>,
    sample: &'a BodySample,
    sd: [f64; 2],
    /// ln p of what does not depend on the departure.
    constant: f64,
    /// Numbers of rows of distances and of normals.
    rows: [f64; 2],
    over: DepartureOver,
    /// Sds of the prior of the unknowns' moves.
    widths: [f64; MOST_UNKNOWNS],
    plain: RowGrams,
    /// By length.
    departed: Vec<(f64, RowGrams)>,
}

impl<'a> LinearisedBase<'a> {
    pub(super) fn new(mode: &Mode, sample: &'a BodySample, tuning: &Tuning) -> LinearisedBase<'a> {
        let members = mode.members();
        let away = mode.others();
        let normals = members.iter().filter(|i| sample.normal(**i).is_some()).count() as f64;
        let falsely: f64 = away.iter().map(|i| log_false(tuning, sample.normal(*i).is_some())).sum();
        let constant = log_prior(&mode.primitive) + falsely + log_share(away.len(), sample.len(), tuning);
        let rows = [members.len() as f64, 2.0 * normals];
        let base = BaseRows::new(&mode.primitive, &members, sample, DepartureOver::Feet);
        let (plain, departed, primitive) = (base.grams(), Vec::new(), mode.primitive);
        let widths = widths(&primitive);
        let over = DepartureOver::Feet;
        LinearisedBase { primitive, members, sample, sd: mode.sd, constant, rows, over, widths, plain, departed }
    }

    /// The same with a primitive that does not move and departures in space, which carry all.
    pub(super) fn in_space(self) -> LinearisedBase<'a> {
        LinearisedBase { widths: [HELD; MOST_UNKNOWNS], over: DepartureOver::Space, ..self }
    }

    /// The same where the contacts left out are false, or belong to another thing.
    pub(super) fn beside_others(mut self, tuning: &Tuning) -> LinearisedBase<'a> {
        let by_share = log_share(self.sample.len() - self.members.len(), self.sample.len(), tuning);
        let by_place = log_division(self.sample, &self.members);
        self.constant += by_share.max(by_place) + (-(by_share - by_place).abs()).exp().ln_1p() - LN_2 - by_share;
        self
    }

    /// With departures of all lengths.
    pub(super) fn departing(self, tuning: &Tuning) -> LinearisedBase<'a> {
        self.with_lengths(&tuning.lengths, tuning.most_features)
    }

    /// With departures of these lengths, each carried by so many places at most.
    pub(super) fn with_lengths(mut self, lengths: &[f64], most: usize) -> LinearisedBase<'a> {
        let base = BaseRows::new(&self.primitive, &self.members, self.sample, self.over);
        let of_length = |length: &f64| Some((*length, base.grams_with(*length, most)?));
        self.departed = lengths.iter().filter_map(of_length).collect();
        self
    }

    /// The same about a primitive moved by a node's step.
    pub(super) fn moved(self, step: &[f64], tuning: &Tuning) -> LinearisedBase<'a> {
        let primitive = moved(&self.primitive, step).about([0.0; 3]);
        let constant = self.constant - log_prior(&self.primitive) + log_prior(&primitive);
        let plain = BaseRows::new(&primitive, &self.members, self.sample, self.over).grams();
        let widths = widths(&primitive);
        LinearisedBase { primitive, constant, plain, widths, ..self }.departing(tuning)
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
        Some(self.node(0, &self.plain, None, tuning.exact.ln(), tuning)?.log_evidence)
    }

    /// Nodes without a departure and with departures of all lengths and sizes.
    pub(super) fn nodes(&self, of: usize, tuning: &Tuning) -> Vec<BodyHypothesis> {
        let mut found: Vec<BodyHypothesis> = Vec::new();
        found.extend(self.node(of, &self.plain, None, tuning.exact.ln(), tuning));
        let each = ((1.0 - tuning.exact) / (tuning.lengths.len() * tuning.departures.len()) as f64).ln();
        found.extend(self.departed_nodes(of, &tuning.departures, each, tuning));
        found
    }

    /// Nodes with departures of these sizes and of all lengths, each with a log prior.
    pub(super) fn departed_nodes<'b>(
        &'b self,
        of: usize,
        sizes: &'b [f64],
        log_prior: f64,
        tuning: &'b Tuning,
    ) -> impl Iterator<Item = BodyHypothesis> + 'b {
        self.departed.iter().flat_map(move |(length, grams)| {
            sizes.iter().filter_map(move |size| self.node(of, grams, Some([*length, *size]), log_prior, tuning))
        })
    }

    fn node(
        &self,
        of: usize,
        grams: &RowGrams,
        departure: Option<[f64; 2]>,
        log_prior: f64,
        tuning: &Tuning,
    ) -> Option<BodyHypothesis> {
        let size = departure.map(|[_, size]| size);
        let (best, of_v) = if self.rows[1] > 0.0 { self.ratio(grams, size, tuning) } else { (0.0, 0.0) };
        let found = self.factored(grams, size, best.exp())?;
        let sd = (found.sum / self.freedom()).sqrt();
        let mut solution = found.reduced;
        dense::backward(&found.lower, &mut solution);
        let departure_rms = (departure_square(grams, &solution).unwrap_or(0.0) / self.rows[0].max(1.0)).sqrt();
        Some(BodyHypothesis {
            of,
            departure,
            log_evidence: found.log + of_v + self.constant + log_prior,
            solution,
            lower: found.lower,
            process: grams.process.clone(),
            sd: [sd, sd / (0.5 * best).exp()],
            departure_rms,
            freedom: self.freedom(),
        })
    }

    /// Whether distances are linear over a node's step, so that its evidence is that of a body: where they are not what the equations say
    /// they are, by so much that contacts would no longer belong, the step leads elsewhere.
    pub(super) fn is_linear(&self, node: &BodyHypothesis, tuning: &Tuning) -> bool {
        let (step, rows) = (node.step(), &self.plain.of[0]);
        let primitive = moved(&self.primitive, step);
        if !is_possible(&primitive) {
            return false;
        }
        let unknowns = step.len();
        let of_squares = |i: usize| {
            let own: f64 = step.iter().enumerate().map(|(j, s)| s * rows[(i, j)]).sum();
            step[i] * (own + 2.0 * rows[(i, unknowns)])
        };
        let expected = rows[(unknowns, unknowns)] + (0..unknowns).map(of_squares).sum::<f64>();
        let found: f64 = self.members.iter().map(|&i| primitive.nearest(self.sample.points[i]).0.powi(2)).sum();
        let rms = |sum: f64| (sum.max(0.0) / self.rows[0].max(1.0)).sqrt();
        (rms(found) - rms(expected)).abs() <= tuning.belongs * node.scatter().hypot(node.departure_size())
    }

    fn freedom(&self) -> f64 {
        (self.rows[0] + self.rows[1] - self.primitive.kind.free().len() as f64).max(1.0)
    }

    /// The likeliest ln v, and what its prior and its width add to ln p there.
    fn ratio(&self, grams: &RowGrams, size: Option<f64>, tuning: &Tuning) -> (f64, f64) {
        let [mean, sd] = tuning.log_ratio.map(|v| 2.0 * v);
        let prior = |log_v: f64| -0.5 * ((log_v - mean) / sd).powi(2);
        let value = |log_v: f64| {
            self.factored(grams, size, log_v.exp()).map_or(f64::NEG_INFINITY, |found| found.log + prior(log_v))
        };
        let [s, sn] = self.sd;
        let middle = (2.0 * (s / sn).ln()).clamp(mean - 3.0 * sd, mean + 3.0 * sd);
        let (best, most) = brent::maximum([middle - SPAN, middle + SPAN], middle, EXACTLY, VALUES, value);
        let curvature = (2.0 * most - value(best - STEP_OF_V) - value(best + STEP_OF_V)) / (STEP_OF_V * STEP_OF_V);
        let least = 1.0 / (sd * sd);
        let width = if curvature > least { 1.0 / curvature } else { 1.0 / least };
        (best, prior(best) + 0.5 * width.ln() - sd.ln())
    }

    /// Log evidence at the mode's own scales, the best of a few departures: enough to leave out kinds that have no chance.
    pub(super) fn rough(&self, tuning: &Tuning) -> f64 {
        let [s, sn] = self.sd;
        let v = (s / sn).powi(2);
        let of = |grams: &RowGrams, size: Option<f64>| {
            self.factored(grams, size, v).map_or(f64::NEG_INFINITY, |found| found.log)
        };
        let largest = tuning.departures.iter().copied().fold(0.0, f64::max);
        let departed = self.departed.iter().map(|(_, g)| of(g, Some(largest)).max(of(g, Some(0.1 * largest))));
        self.constant + departed.fold(of(&self.plain, None), f64::max)
    }

    /// ln p and the equations that it is taken from, for a departure of some size and a ratio v.
    fn factored(&self, grams: &RowGrams, size: Option<f64>, v: f64) -> Option<FactoredEquations> {
        let free = self.primitive.kind.free();
        let (places, unknowns) = (grams.places, free.len());
        let ratio = size.unwrap_or(1.0);
        let [distances, normals] = &grams.of;
        let all = places + unknowns;
        let full = |i: usize, j: usize| distances[(i, j)] + v * normals[(i, j)];
        let mut matrix = Mat::from_fn(all, all, full);
        (0..places).for_each(|i| matrix[(i, i)] += 1.0 / (ratio * ratio));
        (0..unknowns).for_each(|i| matrix[(places + i, places + i)] += (self.sd[0] / self.widths[free[i]]).powi(2));
        let lower = dense::cholesky(&matrix)?;
        let mut reduced: Vec<f64> = (0..all).map(|i| -full(i, all)).collect();
        dense::forward_in_columns(&lower, &mut reduced);
        let sum = (full(all, all) - reduced.iter().map(|b| b * b).sum::<f64>()).max(0.0);
        let [_, nn] = self.rows;
        let freedom = self.freedom();
        let floor = self.sample.floor[0].max(self.sample.floor[1] * v.sqrt());
        let sum = sum.max(freedom * floor * floor);
        let log = 0.5 * nn * v.ln() - 0.5 * freedom * PI.ln() + ln_gamma(0.5 * freedom)
            - 0.5 * freedom * sum.ln()
            - 0.5 * dense::log_det(&lower)
            - places as f64 * ratio.ln();
        Some(FactoredEquations { log, lower, reduced, sum })
    }
}

/// Log probability that so many contacts are false, each for itself.
fn log_share(strays: usize, count: usize, tuning: &Tuning) -> f64 {
    let (strays, count) = (strays as f64, count as f64);
    ln_beta(1.0 + strays, tuning.false_prior + count - strays) - ln_beta(1.0, tuning.false_prior)
}

/// Sum over the contacts of the squared departure, less what a move of the primitive takes up of it: the two trade where the departure is
/// long, and only their sum is told.
///
/// ```text
/// |d|^2 - b' (J'J)^-1 b,   d = K w,  b = J'd      K, J: rows of distances by the departure's places and by the primitive's moves
/// ```
fn departure_square(grams: &RowGrams, solution: &[f64]) -> Option<f64> {
    let (places, weights) = (grams.places, &solution[..grams.places]);
    let product = |i: usize| grams.of[0].col_as_slice(i).iter().zip(weights).map(|(g, w)| g * w).sum::<f64>();
    let square = weights.iter().enumerate().map(|(i, w)| w * product(i)).sum::<f64>();
    let moves: Vec<usize> = (places..solution.len()).collect();
    let largest = moves.iter().map(|&i| grams.of[0][(i, i)]).fold(0.0, f64::max);
    let of_moves = |i: usize, j: usize| {
        // what no distance tells stays where it is
        let held = if i == j { 1e-12 * largest + f64::MIN_POSITIVE } else { 0.0 };
        grams.of[0][(moves[i], moves[j])] + held
    };
    let lower = dense::cholesky(&Mat::from_fn(moves.len(), moves.len(), of_moves))?;
    let mut taken: Vec<f64> = moves.iter().map(|&i| product(i)).collect();
    dense::forward_in_columns(&lower, &mut taken);
    Some((square - taken.iter().map(|t| t * t).sum::<f64>()).max(0.0))
}

/// Equations of one hypothesis.
struct FactoredEquations {
    log: f64,
    /// Lower factor of A.
    lower: Mat<f64>,
    /// The right hand side solved by it.
    reduced: Vec<f64>,
    /// Sum of squares that is left.
    sum: f64,
}

/// A primitive moved by its free unknowns.
pub(super) fn moved(primitive: &Primitive, step: &[f64]) -> Primitive {
    let mut all = [0.0; MOST_UNKNOWNS];
    primitive.kind.free().iter().zip(step).for_each(|(i, s)| all[*i] = *s);
    primitive.moved(&all)
}
