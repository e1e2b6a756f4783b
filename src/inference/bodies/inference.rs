//! The steps from contacts to weighted hypotheses, top to bottom.

use super::evidence::{BodyHypothesis, LinearisedBase, moved};
use super::mode::{FalseContacts, Mode, is_possible};
use super::other_things::{Thing, two_things};
use super::sample::BodySample;
use super::search::{EXTENT, modes};
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};

/// Rough log evidence below the best at which a kind is not looked at: exact departures add less.
const HOPELESS_ROUGHLY: f64 = 60.0;

/// Log evidence below the best at which a hypothesis has no weight that would show.
const HOPELESS: f64 = 40.0;

/// Weighted hypotheses about one thing.
#[derive(Clone, Debug)]
pub(crate) struct BodyPosterior {
    /// The primitives about which nodes are written: one of every kind without false contacts, and one with some.
    pub(crate) primitives: Vec<Primitive>,
    /// Contacts that belong to each.
    pub(crate) members: Vec<Vec<usize>>,
    pub(crate) nodes: Vec<BodyHypothesis>,
    /// Weights of the nodes; they sum to 1.
    pub(crate) weights: Vec<f64>,
    /// Log evidence of the likeliest node.
    pub(crate) log_evidence: f64,
}

/// What the contacts are.
#[derive(Clone, Debug)]
pub(crate) enum Verdict {
    /// One thing.
    One(Box<BodyPosterior>),
    /// Two primitives, in the sample's units.
    Several(Box<[Thing; 2]>),
    /// No primitive comes near enough.
    None,
}

impl BodyPosterior {
    /// Probability that there is no departure.
    pub(crate) fn weight_without_departure(&self) -> f64 {
        self.nodes.iter().zip(&self.weights).filter(|(n, _)| n.length().is_none()).map(|(_, w)| w).sum()
    }

    /// The likeliest kind, by the sum over all its hypotheses.
    pub(crate) fn kind(&self) -> PartKind {
        let weight = |kind: &PartKind| self.weight_of(*kind);
        PartKind::BODIES.into_iter().max_by(|a, b| weight(a).total_cmp(&weight(b))).unwrap_or(PartKind::Plane)
    }

    /// Probability of one kind.
    pub(crate) fn weight_of(&self, kind: PartKind) -> f64 {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.map(|(_, w)| w).sum()
    }

    /// The likeliest hypothesis of one kind.
    pub(crate) fn best_of(&self, kind: PartKind) -> Option<&BodyHypothesis> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.max_by(|a, b| a.1.total_cmp(b.1)).map(|(n, _)| n)
    }

    /// Contacts that lie on one of the primitives, by its own scatter and departure.
    fn belonging(&self, of: usize, all: &BodySample) -> Vec<usize> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(node, _)| node.of == of);
        let Some((node, _)) = own.max_by(|a, b| a.1.total_cmp(b.1)) else { return Vec::new() };
        let near = BELONGS * node.scatter().hypot(node.departure_size());
        let primitive = moved(&self.primitives[of], node.step());
        (0..all.len()).filter(|&i| primitive.nearest(all.points[i]).0.abs() <= near).collect()
    }

    /// The likeliest primitive of one kind.
    pub(crate) fn likeliest(&self, kind: PartKind) -> Option<Primitive> {
        let base = |node: &BodyHypothesis| self.primitives[node.of];
        let there = |node: &BodyHypothesis| Some(moved(&base(node), node.step())).filter(is_possible);
        self.best_of(kind).map(|node| there(node).unwrap_or(base(node)))
    }

    /// Contacts that belong to the likeliest primitive of one kind.
    pub(crate) fn members_of(&self, kind: PartKind) -> &[usize] {
        self.best_of(kind).map_or(&[], |node| &self.members[node.of])
    }
}

/// Sds within which a contact belongs to a primitive that was fitted to others of the same cloud.
pub(crate) const BELONGS: f64 = 4.0;

/// Judges contacts. Of very many the evidence is taken from a part, evenly among all.
pub(crate) fn infer(all: &BodySample, tuning: &Tuning) -> Verdict {
    let sample = &all.at_most(tuning.most_contacts);
    let modes = modes(sample, tuning);
    let Some(mut posterior) = posterior(&modes, sample, tuning) else { return Verdict::None };
    let kind = posterior.kind();
    if let Some(things) = two_things(sample, &modes, posterior.log_evidence, tuning) {
        return Verdict::Several(Box::new(things));
    }
    let Some(best) = posterior.best_of(kind) else { return Verdict::None };
    let slope = best.departure.map_or(0.0, |[length, _]| best.departure_rms / length);
    let false_share = 1.0 - posterior.members_of(kind).len() as f64 / sample.len() as f64;
    if slope > tuning.largest_slope || best.sd[0] > tuning.largest_scatter || false_share > tuning.false_most {
        return Verdict::None;
    }
    if sample.len() < all.len() {
        posterior.members = (0..posterior.primitives.len()).map(|of| posterior.belonging(of, all)).collect();
    }
    Verdict::One(Box::new(posterior))
}

fn posterior(modes: &[Mode], sample: &BodySample, tuning: &Tuning) -> Option<BodyPosterior> {
    let (mut primitives, mut members, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
    // where no contact was found to be false both modes of a kind are one
    let is_own = |m: &&Mode| m.strays == FalseContacts::None || m.members().len() < sample.len();
    let modes: Vec<&Mode> = modes.iter().filter(is_own).filter(|m| m.holds_most(tuning)).collect();
    let all: Vec<LinearisedBase> = modes.iter().map(|found| LinearisedBase::new(found, sample, tuning)).collect();
    let rough: Vec<f64> = all.iter().map(|linearised| linearised.rough(tuning)).collect();
    let likeliest = rough.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let worth = |(linearised, rough)| (rough > likeliest - HOPELESS_ROUGHLY).then_some(linearised);
    for (found, mut linearised) in modes
        .iter()
        .zip(all)
        .zip(rough)
        .filter_map(|((found, linearised), rough)| Some((found, worth((linearised, rough))?)))
    {
        let prior = kind_prior(found.primitive.kind, tuning);
        let mut own = linearised.nodes(primitives.len(), tuning);
        // the departure takes its part of the distances, so that the likeliest primitive is another than the robust one
        if let Some(best) = own.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence)) {
            let step = best.step().to_vec();
            if moved(&linearised.primitive, &step).is_sound(EXTENT) {
                linearised = linearised.moved(&step);
                own = linearised.nodes(primitives.len(), tuning);
            }
        }
        own.iter_mut().for_each(|node| node.log_evidence += prior);
        nodes.extend(own);
        primitives.push(linearised.primitive);
        members.push(linearised.members);
    }
    let most = nodes.iter().map(|n| n.log_evidence).fold(f64::NEG_INFINITY, f64::max);
    if !most.is_finite() {
        return None;
    }
    nodes.retain(|node| node.log_evidence > most - HOPELESS);
    let mut weights: Vec<f64> = nodes.iter().map(|node| (node.log_evidence - most).exp()).collect();
    let all: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= all);
    Some(BodyPosterior { primitives, members, nodes, weights, log_evidence: most })
}

fn kind_prior(kind: PartKind, tuning: &Tuning) -> f64 {
    let all: f64 = tuning.kinds.iter().sum();
    let own = PartKind::BODIES.iter().position(|known| *known == kind);
    own.map_or(f64::NEG_INFINITY, |k| (tuning.kinds[k] / all).ln())
}
