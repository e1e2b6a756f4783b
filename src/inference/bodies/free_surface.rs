//! A body of no simple kind: a process in space about the primitive that is next to it.
//!
//! ```text
//! F(p) = d(p) - f(p),   f of all lengths and sizes by their evidence           `departure`
//! an answer where contacts left out lie nearer to it than f_s times their distance from the primitive
//! ```
//!
//! That is a gaussian-process implicit surface whose mean is a primitive: O. Williams and A. Fitzgibbon, *Gaussian Process Implicit
//! Surfaces*, 2007. A departure of it is shape, never a sensor's error.

use super::evidence::{BodyHypothesis, LinearisedBase, moved};
use super::inference::{BodyPosterior, normalised};
use super::mode::{Mode, next_to_all};
use super::posterior::DrawnBase;
use super::sample::BodySample;
use super::search::modes;
use super::tuning::Tuning;
use crate::primitives::placed::PartKind;
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::vector::{Vector, norm};

/// One contact of so many is left out.
const LEFT_OUT: usize = 5;

/// From what a free surface may depart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FreeBase {
    /// From a ball or an ellipsoid that contacts go all round.
    Closed,
    /// From these, or else from whatever primitive is next to the contacts.
    Any,
}

/// The posterior of a free surface; `None` where contacts are too few, or do not tell each other's place.
pub(crate) fn free_surface(all: &BodySample, from: FreeBase, tuning: &Tuning) -> Option<BodyPosterior> {
    let sample = &all.at_most(tuning.free_contacts);
    if sample.len() < tuning.free_from[usize::from(sample.known_normals() == 0)] {
        return None;
    }
    let base = base_of(sample, from, tuning)?;
    let linearised = about(&base, sample, &tuning.free_lengths, tuning);
    let nodes: Vec<BodyHypothesis> = linearised.departed_nodes(0, &tuning.free_sizes, 0.0, tuning).collect();
    let best = nodes.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))?;
    if !predicts(&base, best, sample, tuning) {
        return None;
    }
    let (nodes, weights, log_evidence) = normalised(nodes, tuning)?;
    let (primitives, members) = (vec![linearised.primitive], vec![(0..all.len()).collect()]);
    Some(BodyPosterior { primitives, members, nodes, weights, log_evidence, is_free: true })
}

/// What closes is nearer to a ball or an ellipsoid than to others.
fn base_of(sample: &BodySample, from: FreeBase, tuning: &Tuning) -> Option<Mode> {
    let few = sample.at_most(tuning.searched);
    let found = modes(&few, tuning);
    let goes_all_round = |base: &&Mode| {
        let normals: Vec<Vector> = few.points.iter().map(|p| base.primitive.nearest(*p).1).collect();
        norm(mean_of(&normals)) < tuning.all_round
    };
    let closed = next_to_all(found.iter().filter(|mode| closes(mode))).filter(goes_all_round);
    let next = || next_to_all(found.iter()).filter(|_| from == FreeBase::Any);
    closed.or_else(next).cloned()
}

fn closes(mode: &Mode) -> bool {
    matches!(mode.primitive.kind, PartKind::Sphere | PartKind::Ellipsoid)
}

/// The base with departures in space.
fn about<'a>(base: &Mode, sample: &'a BodySample, lengths: &[f64], tuning: &Tuning) -> LinearisedBase<'a> {
    let of_all = Mode { weights: vec![1.0; sample.len()], ..base.clone() };
    LinearisedBase::new(&of_all, sample, tuning).in_space().with_lengths(lengths, tuning.free_features)
}

/// Whether a departure of the likeliest length and size tells contacts that it was not told of.
fn predicts(base: &Mode, best: &BodyHypothesis, sample: &BodySample, tuning: &Tuning) -> bool {
    let Some([length, size]) = best.departure else { return false };
    let is_out = |i: &usize| i.is_multiple_of(LEFT_OUT);
    let (out, kept): (Vec<usize>, Vec<usize>) = (0..sample.len()).partition(is_out);
    let few = sample.only(&kept);
    let linearised = about(base, &few, &[length], tuning);
    let Some(node) = linearised.departed_nodes(0, &[size], 0.0, tuning).next() else { return false };
    let primitive = moved(&linearised.primitive, node.step());
    let surface = DrawnBase::likeliest(primitive, &node);
    let sum = |away: &dyn Fn(usize) -> f64| out.iter().map(|i| away(*i).powi(2)).sum::<f64>();
    let of_surface = sum(&|i| surface.distance(sample.points[i]));
    let of_primitive = sum(&|i| base.primitive.nearest(sample.points[i]).0);
    of_surface < tuning.free_predicts.powi(2) * of_primitive
}
