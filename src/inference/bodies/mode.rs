//! The likeliest primitive of one kind with false contacts among the others: expectation and maximisation.
//!
//! ```text
//! L = sum_i ln((1 - eps) N(d_i; s) N(t_i; s_n) + eps / (reach 4 pi))      t: offset of the normal
//! w_i = share of the first term        theta: least squares weighted by w        s^2 = sum w d^2 / (sum w - unknowns told by distances)
//! ```
//!
//! A. Dempster, N. Laird, D. Rubin, *J. R. Statist. Soc. B* 39 (1977) 1; the mixture is that of M. Aitkin and G. Wilson, *Technometrics*
//! 22 (1980) 325.

use std::f64::consts::PI;

use statrs::function::erf::erf_inv;

use super::sample::BodySample;
use super::tuning::Tuning;
use crate::primitives::descent::damped_step;
use crate::primitives::normal_equations::{NormalEquations, WeightedContact};
use crate::primitives::placed::{MOST_UNKNOWNS, PartKind, Primitive};
use palpate_numeric::levenberg_marquardt::{self, ResidualModel, Settings};
use palpate_numeric::linalg::small::{NotPositiveDefinite, Square};
use palpate_numeric::statistics::{Rank, quantile};
use palpate_numeric::vector::{Vector, dot, minus, scaled};

/// Rounds of expectation and maximisation; from a start near the mode ten are enough.
const ROUNDS: usize = 40;

/// A round that raises L by less than this ends the search.
const SETTLED: f64 = 1e-4;

/// Steps of the descent within a round.
const SETTINGS: Settings = Settings {
    first: 1e-4,
    most: 1e9,
    fall: |damping| (0.2 * damping).max(1e-12),
    rounding: 0.0,
    steps: 4,
    trials: 12,
};

/// A primitive where L is largest, with what goes with it.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    pub(super) primitive: Primitive,
    /// Probability of every contact to belong to it.
    pub(super) weights: Vec<f64>,
    /// Sds of distances and of normals.
    pub(super) sd: [f64; 2],
    pub(super) likelihood: f64,
    pub(super) strays: FalseContacts,
}

impl Mode {
    /// About the primitive of a start's kind that is nearest to some contacts, which are its own and all others are not.
    pub(super) fn of_members(
        start: &Primitive,
        members: &[usize],
        sample: &BodySample,
        tuning: &Tuning,
    ) -> Option<Mode> {
        let mut weights = vec![0.0; sample.len()];
        members.iter().for_each(|i| weights[*i] = 1.0);
        let primitive = descended(start, sample, &weights, [tuning.log_ratio[0].exp(), 1.0])?;
        let unknowns = start.kind.free().len() as f64;
        let sd = scales_of(&offsets(&primitive, sample), &weights, sample, unknowns, 0.0, tuning).sd;
        Some(Mode { primitive, weights, sd, likelihood: f64::NEG_INFINITY, strays: FalseContacts::Some })
    }

    /// Whether so many contacts belong to it that the others may be false. One face of a cube has a sixth: it is a thing among others.
    pub(super) fn holds_most(&self, tuning: &Tuning) -> bool {
        self.members().len() as f64 >= (1.0 - tuning.false_most) * self.weights.len() as f64 - 1.0
    }

    /// Contacts that rather belong to it than not.
    pub(super) fn members(&self) -> Vec<usize> {
        (0..self.weights.len()).filter(|i| self.weights[*i] > 0.5).collect()
    }

    /// Contacts that rather do not.
    pub(super) fn others(&self) -> Vec<usize> {
        (0..self.weights.len()).filter(|i| self.weights[*i] <= 0.5).collect()
    }
}

/// Of modes without false contacts the one that all contacts are next to.
pub(super) fn next_to_all<'a>(modes: impl Iterator<Item = &'a Mode>) -> Option<&'a Mode> {
    let whole = modes.filter(|mode| mode.strays == FalseContacts::None);
    whole.min_by(|a, b| a.sd[0].total_cmp(&b.sd[0]))
}

/// A given normal on the side of the base's: which side is free is asked at the end, of all normals together.
pub(crate) fn aligned(given: Vector, of_base: Vector) -> Vector {
    if dot(given, of_base) < 0.0 { scaled(-1.0, given) } else { given }
}

/// Distance and offset of the normal of every contact, the latter squared.
pub(super) fn offsets(primitive: &Primitive, sample: &BodySample) -> Vec<(f64, Option<f64>)> {
    let one = |i: usize| {
        let (d, normal) = primitive.nearest(sample.points[i]);
        let off = sample.normal(i).map(|n| minus(normal, aligned(n, normal))).map(|off| dot(off, off));
        (d, off)
    };
    (0..sample.len()).map(one).collect()
}

/// Density of a false contact: anywhere within the reach, and with any normal.
pub(super) fn log_false(tuning: &Tuning, has_normal: bool) -> f64 {
    -tuning.reach.ln() - if has_normal { (4.0 * PI).ln() } else { 0.0 }
}

/// Contacts that a thing has at least.
pub(super) fn fewest(sample: &BodySample, tuning: &Tuning) -> usize {
    tuning.thing_contacts[usize::from(sample.known_normals() == sample.len())]
}

/// Whether so few contacts can tell false ones from others.
fn may_be_false(sample: &BodySample, unknowns: usize, tuning: &Tuning) -> bool {
    let rows = sample.len() + 2 * sample.known_normals();
    sample.len() >= tuning.false_from && rows >= 3 * (unknowns + 1)
}

/// Sds of distances and of normals in each tangent direction, by a low quantile of their magnitudes over that of a gaussian and of the
/// length of two independent ones; 0 of an empty list.
fn low_scales(offsets: &[(f64, Option<f64>)], share: f64, of_own: f64) -> [f64; 2] {
    let of = |magnitudes: Vec<f64>| quantile(magnitudes, share, Rank::Reached).unwrap_or(0.0);
    let of_distances = 2.0_f64.sqrt() * erf_inv(of_own);
    let of_lengths = (-2.0 * (1.0 - of_own).ln()).sqrt();
    [
        of(offsets.iter().map(|(d, _)| d.abs()).collect()) / of_distances,
        of(offsets.iter().filter_map(|(_, off)| off.map(f64::sqrt)).collect()) / of_lengths,
    ]
}

struct Scales {
    sd: [f64; 2],
    eps: f64,
}

fn expectation(offsets: &[(f64, Option<f64>)], scales: &Scales, tuning: &Tuning, weights: &mut Vec<f64>) -> f64 {
    weights.clear();
    let [s, sn] = scales.sd;
    let of_place = -(s * (2.0 * PI).sqrt()).ln();
    let of_normal = -(sn * sn * 2.0 * PI).ln();
    let mut sum = 0.0;
    for (d, off) in offsets {
        let mut own = of_place - 0.5 * (d / s).powi(2) + (1.0 - scales.eps).ln();
        own += off.map_or(0.0, |off| of_normal - 0.5 * off / (sn * sn));
        if scales.eps <= 0.0 {
            weights.push(1.0);
            sum += own;
            continue;
        }
        let other = log_false(tuning, off.is_some()) + scales.eps.ln();
        let most = own.max(other);
        let all = most + ((own - most).exp() + (other - most).exp()).ln();
        weights.push((own - all).exp());
        sum += all;
    }
    sum
}

fn scales_of(
    offsets: &[(f64, Option<f64>)],
    weights: &[f64],
    sample: &BodySample,
    unknowns: f64,
    eps: f64,
    tuning: &Tuning,
) -> Scales {
    let (mut rows, mut sums) = ([0.0; 2], [0.0; 2]);
    for ((d, off), w) in offsets.iter().zip(weights) {
        rows[0] += w;
        sums[0] += w * d * d;
        if let Some(off) = off {
            rows[1] += 2.0 * w;
            sums[1] += w * off;
        }
    }
    // each kind of rows pays for the unknowns by its share
    let all = rows[0] + rows[1];
    let sd = [0, 1].map(|k| {
        let left = (rows[k] - unknowns * rows[k] / all).max(0.5);
        (sums[k] / left).sqrt().max(sample.floor[k])
    });
    let count = weights.len() as f64;
    let eps = if eps > 0.0 {
        ((count - rows[0]) / (count + tuning.false_prior)).clamp(0.1 / (count + tuning.false_prior), tuning.false_most)
    } else {
        0.0
    };
    Scales { sd, eps }
}

/// Whether contacts may be false.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FalseContacts {
    None,
    Some,
}

/// Where a search begins, and whether it lets contacts be false.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub(super) start: Primitive,
    pub(super) strays: FalseContacts,
    /// The share of all contacts whose distances tell the scatter, and which share that is of those that belong.
    pub(super) share: f64,
    pub(super) of_own: f64,
}

impl Candidate {
    /// Of a start to which most contacts may belong.
    pub(super) fn new(start: Primitive, strays: FalseContacts, tuning: &Tuning) -> Candidate {
        Candidate { start, strays, share: tuning.surely_own, of_own: tuning.surely_own }
    }

    /// From a mode that was found among some of the contacts.
    pub(super) fn again(found: &Mode, tuning: &Tuning) -> Candidate {
        let own = found.members().len() as f64 / found.weights.len() as f64;
        let share = tuning.surely_own.min(tuning.minority * own);
        Candidate { start: found.primitive, strays: found.strays, share, of_own: (share / own).min(tuning.minority) }
    }
}

/// The mode that is reached from a start; `None` where the contacts do not determine this kind.
pub(super) fn mode(candidate: &Candidate, sample: &BodySample, tuning: &Tuning) -> Option<Mode> {
    let Candidate { start, strays, share, of_own } = *candidate;
    let unknowns = start.kind.free().len();
    let mut primitive = start;
    let first = offsets(&primitive, sample);
    let [of_distances, of_normals] = low_scales(&first, share, of_own);
    let sd = [of_distances.max(sample.floor[0]), of_normals.clamp(sample.floor[1], 1.0)];
    let eps = match strays {
        FalseContacts::None => 0.0,
        FalseContacts::Some if !may_be_false(sample, unknowns, tuning) => return None,
        FalseContacts::Some => 1.0 / tuning.false_prior,
    };
    let mut scales = Scales { sd, eps };
    let mut weights = Vec::with_capacity(sample.len());
    let mut before = f64::NEG_INFINITY;
    let mut offset = first;
    for _ in 0..ROUNDS {
        let here = expectation(&offset, &scales, tuning, &mut weights);
        if !here.is_finite() {
            return None;
        }
        if (here - before).abs() < SETTLED {
            before = here;
            break;
        }
        before = here;
        primitive = descended(&primitive, sample, &weights, scales.sd)?;
        offset = offsets(&primitive, sample);
        scales = scales_of(&offset, &weights, sample, unknowns as f64, scales.eps, tuning);
    }
    Some(Mode { primitive, weights, sd: scales.sd, likelihood: before, strays })
}

/// Least squares over weighted contacts.
struct WeightedRows<'a> {
    sample: &'a BodySample,
    weights: &'a [f64],
    /// One over the variances of distances and normals.
    precision: [f64; 2],
    matrix: Square<MOST_UNKNOWNS>,
    gradient: [f64; MOST_UNKNOWNS],
}

impl WeightedRows<'_> {
    fn sum(&self, primitive: &Primitive) -> f64 {
        let each = offsets(primitive, self.sample);
        let one = |((d, off), w): (&(f64, Option<f64>), &f64)| {
            w * (self.precision[0] * d * d + self.precision[1] * off.unwrap_or(0.0))
        };
        each.iter().zip(self.weights).map(one).sum()
    }
}

impl ResidualModel for WeightedRows<'_> {
    type Point = Primitive;
    type Step = [f64; MOST_UNKNOWNS];
    type Error = NotPositiveDefinite;

    fn linearise(&mut self, at: &Primitive) -> f64 {
        let contact = |(i, w): (usize, &f64)| WeightedContact {
            point: self.sample.points[i],
            normal: self.sample.normal(i),
            weights: self.precision.map(|precision| w * precision),
        };
        let here = NormalEquations::new(at, aligned, self.weights.iter().enumerate().map(contact));
        (self.matrix, self.gradient) = (here.matrix, here.gradient);
        here.sum
    }

    fn solve(&mut self, damping: f64) -> Result<[f64; MOST_UNKNOWNS], NotPositiveDefinite> {
        damped_step(self.matrix, &self.gradient, damping)
    }

    fn moved(&mut self, from: &Primitive, step: &[f64; MOST_UNKNOWNS]) -> Option<(Primitive, f64)> {
        let next = from.moved(step).about([0.0; 3]);
        let sound = next.sizes.iter().all(|size| size.is_finite()) && is_possible(&next);
        sound.then(|| (next, self.sum(&next))).filter(|(_, sum)| sum.is_finite())
    }

    fn gives_up(&self, _: &[f64; MOST_UNKNOWNS], before: f64, after: Option<f64>) -> bool {
        after.is_some_and(|after| after <= before * (1.0 + 1e-12))
    }

    fn is_settled(&mut self, _: &[f64; MOST_UNKNOWNS], before: f64, after: f64) -> bool {
        before - after <= 1e-10 * before
    }
}

/// Sizes that a body can have.
pub(super) fn is_possible(primitive: &Primitive) -> bool {
    let [one, two, three] = primitive.sizes;
    match primitive.kind {
        PartKind::Plane | PartKind::Patch => true,
        PartKind::Sphere | PartKind::Cylinder => one > 0.0,
        PartKind::Cone => two.abs() < 1.55,
        PartKind::Torus => one > 0.0 && two > 0.0,
        PartKind::Ellipsoid => one > 0.0 && two > 0.0 && three > 0.0,
    }
}

fn descended(start: &Primitive, sample: &BodySample, weights: &[f64], sd: [f64; 2]) -> Option<Primitive> {
    let precision = sd.map(|sd| 1.0 / (sd * sd));
    let zero = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    let mut model = WeightedRows { sample, weights, precision, matrix: zero, gradient: [0.0; MOST_UNKNOWNS] };
    let mut point = start.about([0.0; 3]);
    let found = levenberg_marquardt::descend(&mut model, &mut point, &mut SETTINGS.first.clone(), &SETTINGS);
    found.is_ok().then_some(point)
}
