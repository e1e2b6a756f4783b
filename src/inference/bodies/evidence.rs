//! How probable contacts are under a kind of primitive with a departure of one length and size, and what theta then is.
//!
//! ```text
//! d + J x - Phi w = e,  e ~ N(0, s^2 (1, 1/v)),  w ~ N(0, (rho s)^2)         x: moves of the primitive, v = s^2 / s_n^2
//! A = G_d + v G_n + diag(1/rho^2, s^2 / width^2)                              G: Gram matrices of the rows of distances and normals
//! ln p = N_n/2 ln v - nu/2 ln(pi RSS) + ln Gamma(nu/2) - ln|A| / 2 - M ln rho + ln p(theta) + ln p(false),   nu = N - k   `equations`
//! RSS >= nu floor^2
//! ```
//!
//! The prior of s is 1/s, and s is integrated. ln v has a gaussian prior, and is integrated by Laplace's method about the v where
//! ln p is largest: few distances could otherwise be followed exactly while the normals pay. w and x are drawn together from A.

use statrs::function::beta::ln_beta;

use super::body_hypothesis::{BodyHypothesis, moved};
use super::coordinates::DepartureOver;
use super::departure_kernel::DepartureKernel;
use super::division_prior::log_division;
use super::mode::{Mode, is_possible, log_false};
use super::posterior::DrawnBase;
use super::prior::{log_prior, log_prior_of_axis, widths};
use super::rows::{BaseRows, RowGrams};
use super::sample::BodySample;
use super::sides::log_sides;
use super::tuning::Tuning;
use crate::dense;
use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_geometry::contact::Rounding;
use palpate_numeric::brent;
use palpate_numeric::statistics::log_mean_exp;

/// How far to both sides of the mode's ln v its peak is looked for, how exactly, and values that are asked for at most.
const SPAN: f64 = 4.0;
const EXACTLY: f64 = 0.03;
const VALUES: usize = 14;

/// Step of ln v by which the curvature of ln p is taken.
const STEP_OF_V: f64 = 0.2;

/// The rows of one kind about one primitive, with their Gram matrices for every length of the departure.
pub(super) struct LinearisedBase<'a> {
    pub(super) primitive: Primitive,
    pub(super) members: Vec<usize>,
    pub(super) sample: &'a BodySample,
    /// Sds of distances and of normals, roughly.
    pub(super) sd: [f64; 2],
    /// Sd of a distance that counts for as many contacts as there are, where written numbers were rounded alike.
    shared_floor: f64,
    /// ln p of what does not depend on the departure.
    pub(super) constant: f64,
    /// Given normals that point to the side of the base's normals, and those that point to the other.
    pub(super) sides: [usize; 2],
    /// Numbers of rows of distances and of normals.
    pub(super) rows: [f64; 2],
    /// Unknowns of the primitive that are free.
    pub(super) moving: &'static [usize],
    /// Sds of the prior of the unknowns' moves.
    pub(super) widths: [f64; MOST_UNKNOWNS],
    /// By how much the slope of F may differ from 1, and the sd of the broad part of a departure that is as large as the body.
    pub(super) steep: f64,
    pub(super) broad: f64,
    pub(super) plain: RowGrams,
    /// With departures.
    departed: Vec<RowGrams>,
}

impl<'a> LinearisedBase<'a> {
    pub(super) fn new(mode: &Mode, sample: &'a BodySample, tuning: &Tuning) -> LinearisedBase<'a> {
        let (members, primitive) = (mode.members(), mode.primitive);
        let base = BaseRows::new(&primitive, DepartureOver::Feet, &members, sample);
        let prior = log_prior(&primitive, tuning);
        let moving = primitive.kind.free();
        LinearisedBase::of_rows(&base, primitive, (moving, prior), mode, sample, tuning)
    }

    /// The equations about a surface that departs from its base by as much as the body is large, with departures of these lengths
    /// and families, each carried by so many places at most. The mode's weights tell which contacts are its own.
    pub(super) fn of_level_set(
        surface: &DrawnBase,
        over: DepartureOver,
        mode: &Mode,
        sample: &'a BodySample,
        kernels: &[DepartureKernel],
        tuning: &Tuning,
    ) -> LinearisedBase<'a> {
        let base = BaseRows::of_level_set(surface, over, over.moving(), &mode.members(), sample);
        let prior = log_prior_of_axis(&surface.primitive, over);
        let linearised =
            LinearisedBase::of_rows(&base, surface.primitive, (over.moving(), prior), mode, sample, tuning);
        let broad = DepartureKernel::gaussian(tuning.free_broad[1], tuning.free_apart[0]);
        linearised.departing_by(&base, kernels, Some(broad), tuning.free_features)
    }

    fn of_rows(
        base: &BaseRows,
        primitive: Primitive,
        (moving, prior): (&'static [usize], f64),
        mode: &Mode,
        sample: &'a BodySample,
        tuning: &Tuning,
    ) -> LinearisedBase<'a> {
        let (members, away) = (mode.members(), mode.others());
        let normals = members.iter().filter(|i| sample.normal(**i).is_some()).count() as f64;
        let falsely: f64 = away.iter().map(|i| log_false(tuning, sample.normal(*i).is_some())).sum();
        let of_sides = log_sides(&[base.sides], tuning);
        let constant = prior + falsely + of_sides + log_share(away.len(), sample.len(), tuning);
        let rows = [members.len() as f64, 2.0 * normals];
        let (plain, widths) = (base.grams(), widths(&primitive));
        let (steep, [broad, _]) = (tuning.free_steepness, tuning.free_broad);
        let (sd, shared_floor, departed) = (mode.sd, sample.shared_floor(&members), Vec::new());
        LinearisedBase {
            primitive,
            members,
            sample,
            sd,
            shared_floor,
            constant,
            sides: base.sides,
            rows,
            moving,
            widths,
            steep,
            broad,
            plain,
            departed,
        }
    }

    /// The same where the contacts left out are false, or belong to another thing.
    pub(super) fn beside_others(mut self, tuning: &Tuning) -> LinearisedBase<'a> {
        let by_share = log_share(self.sample.len() - self.members.len(), self.sample.len(), tuning);
        let by_place = log_division(self.sample, &self.members);
        self.constant += log_mean_exp(by_share, by_place) - by_share;
        self
    }

    /// With departures of all lengths, and with those that normals do not follow.
    pub(super) fn departing(self, tuning: &Tuning) -> LinearisedBase<'a> {
        let mut found = self.with_lengths(&tuning.lengths, tuning.most_features, tuning);
        if tuning.own_normals > 0.0 && found.rows[1] > 0.0 {
            let unfollowed: Vec<RowGrams> = found.departed.iter().map(|g| g.unfollowed(&found.plain)).collect();
            found.departed.extend(unfollowed);
        }
        found.departed.extend(found.sections(tuning));
        found
    }

    /// Departures of a ring's section: of what has an axis and bends both ways a circle is the rarest.
    fn sections(&self, tuning: &Tuning) -> Vec<RowGrams> {
        if self.primitive.kind != PartKind::Torus {
            return Vec::new();
        }
        let base = BaseRows::new(&self.primitive, DepartureOver::Section, &self.members, self.sample);
        let kernel = |length: &f64| DepartureKernel::gaussian(*length, tuning.apart);
        let broad = tuning.lengths.iter().filter(|length| **length >= tuning.shape_from).map(kernel);
        broad.filter_map(|of| base.grams_with(of, None, tuning.most_features)).collect()
    }

    /// With departures of these lengths, each carried by so many places at most.
    pub(super) fn with_lengths(self, lengths: &[f64], most: usize, tuning: &Tuning) -> LinearisedBase<'a> {
        let base = BaseRows::new(&self.primitive, DepartureOver::Feet, &self.members, self.sample);
        let kernel = |length: &f64| DepartureKernel::gaussian(*length, tuning.apart);
        // a departure that is small beside the body has no broad one
        self.departing_by(&base, &lengths.iter().map(kernel).collect::<Vec<DepartureKernel>>(), None, most)
    }

    fn departing_by(
        mut self,
        base: &BaseRows,
        kernels: &[DepartureKernel],
        broad: Option<DepartureKernel>,
        most: usize,
    ) -> LinearisedBase<'a> {
        self.departed = kernels.iter().filter_map(|of| base.grams_with(*of, broad, most)).collect();
        self
    }

    /// The same about a primitive moved by a node's step.
    pub(super) fn moved(self, step: &[f64], tuning: &Tuning) -> LinearisedBase<'a> {
        let primitive = moved(&self.primitive, self.moving, step).about([0.0; 3]);
        let constant = self.constant - log_prior(&self.primitive, tuning) + log_prior(&primitive, tuning);
        let plain = BaseRows::new(&primitive, DepartureOver::Feet, &self.members, self.sample).grams();
        let widths = widths(&primitive);
        LinearisedBase { primitive, constant, plain, widths, ..self }.departing(tuning)
    }

    /// ln p of what the contacts left out add; of none of them false, the prior of that alone.
    #[cfg(test)]
    pub(super) fn of_no_false(&self, tuning: &Tuning) -> f64 {
        self.constant - log_prior(&self.primitive, tuning)
    }

    /// The primitive drawn by independent gaussians of one.
    #[cfg(test)]
    pub(super) fn drawn(&self, node: &BodyHypothesis, gaussians: &[f64]) -> Primitive {
        let mut step = gaussians.to_vec();
        dense::backward(&node.lower, &mut step);
        step.iter_mut().zip(&node.solution).for_each(|(s, mean)| *s = mean + node.sd[0] * *s);
        moved(&self.primitive, self.moving, &step)
    }

    /// Log evidence where there is no departure; `None` where it would be that of a primitive elsewhere.
    pub(super) fn without_departure(&self, tuning: &Tuning) -> Option<f64> {
        let node = self.node(0, &self.plain, None, tuning.exact.ln(), tuning)?;
        self.is_linear(&node, tuning).then_some(node.log_evidence)
    }

    /// Nodes without a departure and with departures of all lengths and sizes.
    pub(super) fn nodes(&self, of: usize, tuning: &Tuning) -> Vec<BodyHypothesis> {
        let mut found: Vec<BodyHypothesis> = Vec::new();
        found.extend(self.node(of, &self.plain, None, tuning.exact.ln(), tuning));
        let each = ((1.0 - tuning.exact) / (tuning.lengths.len() * tuning.departures.len()) as f64).ln();
        let departed = self.departed_nodes(of, &tuning.departures, each, tuning);
        let shares = self.shares_of_sections(tuning);
        found.extend(departed.map(|node| node.weighed_by_reading(shares, tuning)));
        found
    }

    /// Priors of the departure of any length of all feet, and of the section alone, over that of one of a length where there are no sections.
    fn shares_of_sections(&self, tuning: &Tuning) -> [f64; 2] {
        let sections = self.departed.iter().filter(|grams| grams.is_of_section()).count();
        if sections == 0 {
            return [1.0, 0.0];
        }
        [1.0 - tuning.section, tuning.section * tuning.lengths.len() as f64 / sections as f64]
    }

    /// Nodes with departures of these sizes and of all lengths, each with a log prior.
    pub(super) fn departed_nodes<'b>(
        &'b self,
        of: usize,
        sizes: &'b [f64],
        log_prior: f64,
        tuning: &'b Tuning,
    ) -> impl Iterator<Item = BodyHypothesis> + 'b {
        self.departed.iter().flat_map(move |grams| {
            sizes.iter().filter_map(move |size| self.node(of, grams, Some(*size), log_prior, tuning))
        })
    }

    /// The same, each as probable beforehand, without those that are hopeless at the ratio v of the middle size of their length.
    pub(super) fn departed_nodes_near(&self, of: usize, sizes: &[f64], tuning: &Tuning) -> Vec<BodyHypothesis> {
        let each = -((self.departed.len() * sizes.len()) as f64).ln();
        let middle = sizes.get(sizes.len() / 2).copied();
        let mut rough: Vec<(f64, &RowGrams, f64)> = Vec::new();
        for grams in &self.departed {
            let v = if self.rows[1] > 0.0 { self.ratio(grams, middle, tuning).0.exp() } else { 1.0 };
            let of_size = |size: &f64| Some((self.factored(grams, Some(*size), v)?.log, grams, *size));
            rough.extend(sizes.iter().filter_map(of_size));
        }
        let most = rough.iter().map(|(log, ..)| *log).fold(f64::NEG_INFINITY, f64::max);
        let near = rough.into_iter().filter(|(log, ..)| *log > most - tuning.hopeless[1]);
        near.filter_map(|(_, grams, size)| self.node(of, grams, Some(size), each, tuning)).collect()
    }

    fn node(
        &self,
        of: usize,
        grams: &RowGrams,
        size: Option<f64>,
        log_prior: f64,
        tuning: &Tuning,
    ) -> Option<BodyHypothesis> {
        let (best, of_v) = if self.rows[1] > 0.0 { self.ratio(grams, size, tuning) } else { (0.0, 0.0) };
        let found = self.factored(grams, size, best.exp())?;
        let sd = (found.sum / self.freedom()).sqrt();
        let mut solution = found.reduced;
        dense::backward(&found.lower, &mut solution);
        let departure_rms = (grams.departure_square(&solution).unwrap_or(0.0) / self.rows[0].max(1.0)).sqrt();
        Some(BodyHypothesis {
            of,
            departure: grams.length().zip(size).map(|(length, size)| [length, size]),
            reading: grams.reading,
            log_evidence: found.log + of_v + self.constant + log_prior,
            solution,
            moving: self.moving,
            lower: found.lower,
            process: grams.process.clone(),
            sd: [sd, sd / (0.5 * best).exp()],
            shared: self.shared(sd),
            departure_rms,
            freedom: self.freedom(),
        })
    }

    /// By how much more than independent errors of this sd those of written numbers move the unknowns: contacts that are rounded alike count
    /// as one, unless they lie on the surface to far less than they were rounded by.
    fn shared(&self, sd: f64) -> f64 {
        let is_exact = sd <= Rounding::EXACT * self.sample.floor[0];
        if is_exact { 1.0 } else { (self.shared_floor / sd).max(1.0) }
    }

    /// Whether distances are linear over a node's step, so that its evidence is that of a body: where they are not what the equations say
    /// they are, by so much that contacts would no longer belong, the step leads elsewhere.
    pub(super) fn is_linear(&self, node: &BodyHypothesis, tuning: &Tuning) -> bool {
        let (step, rows) = (node.step(), &self.plain.of[0]);
        let primitive = node.likeliest(&self.primitive);
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

    pub(super) fn freedom(&self) -> f64 {
        (self.rows[0] + self.rows[1] - self.moving.len() as f64).max(1.0)
    }

    /// The likeliest ln v, and what its prior and its width add to ln p there.
    fn ratio(&self, grams: &RowGrams, size: Option<f64>, tuning: &Tuning) -> (f64, f64) {
        let equations = self.by_size(grams, size);
        let at = |log_v: f64| Some(equations.as_ref()?.factored(log_v.exp())?.log);
        let value = |log_v: f64| at(log_v).unwrap_or(f64::NEG_INFINITY);
        likeliest_ratio(self.sd, value, tuning)
    }

    /// Log evidence at the mode's own scales, the best of a few departures: enough to leave out kinds that have no chance.
    pub(super) fn rough(&self, tuning: &Tuning) -> f64 {
        let [s, sn] = self.sd;
        let v = (s / sn).powi(2);
        let of = |grams: &RowGrams, size: Option<f64>| {
            self.factored(grams, size, v).map_or(f64::NEG_INFINITY, |found| found.log)
        };
        let largest = tuning.departures.iter().copied().fold(0.0, f64::max);
        let departed = self.departed.iter().map(|g| of(g, Some(largest)).max(of(g, Some(0.1 * largest))));
        self.constant + departed.fold(of(&self.plain, None), f64::max)
    }
}

/// The likeliest ln v by the log probability of contacts at one, and what its prior and its width add there; looked for about that of the sds.
pub(super) fn likeliest_ratio([s, sn]: [f64; 2], of: impl Fn(f64) -> f64, tuning: &Tuning) -> (f64, f64) {
    let [mean, sd] = tuning.log_ratio.map(|v| 2.0 * v);
    let prior = |log_v: f64| -0.5 * ((log_v - mean) / sd).powi(2);
    let value = |log_v: f64| of(log_v) + prior(log_v);
    let middle = (2.0 * (s / sn).ln()).clamp(mean - 3.0 * sd, mean + 3.0 * sd);
    let (best, most) = brent::maximum([middle - SPAN, middle + SPAN], middle, EXACTLY, VALUES, value);
    let curvature = (2.0 * most - value(best - STEP_OF_V) - value(best + STEP_OF_V)) / (STEP_OF_V * STEP_OF_V);
    let least = 1.0 / (sd * sd);
    let width = if curvature > least { 1.0 / curvature } else { 1.0 / least };
    (best, prior(best) + 0.5 * width.ln() - sd.ln())
}

/// Log probability that so many contacts are false, each for itself.
fn log_share(strays: usize, count: usize, tuning: &Tuning) -> f64 {
    let (strays, count) = (strays as f64, count as f64);
    ln_beta(1.0 + strays, tuning.false_prior + count - strays) - ln_beta(1.0, tuning.false_prior)
}
