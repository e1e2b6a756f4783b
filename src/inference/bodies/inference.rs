//! The steps from contacts to weighted hypotheses, top to bottom.

use super::candidates::on_either_side;
use super::evidence::{BodyHypothesis, LinearisedBase, moved};
use super::mode::{FalseContacts, Mode, is_possible};
use super::other_things::{Thing, several_things};
use super::sample::BodySample;
use super::search::modes;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};

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
    /// Whether the body is of no simple kind: its departures are shape, and its primitive is only where they are counted from.
    pub(crate) is_free: bool,
}

/// What the contacts are.
#[derive(Clone, Debug)]
pub(crate) enum Verdict {
    /// One thing.
    One(Box<BodyPosterior>),
    /// Two primitives or more, in the sample's units.
    Several(Vec<Thing>),
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

    /// Share of the contacts that are none of the likeliest kind's.
    fn false_share(&self, sample: &BodySample) -> f64 {
        1.0 - self.members_of(self.kind()).len() as f64 / sample.len() as f64
    }

    /// Whether the likeliest kind holds nearly all contacts without a departure, and not between two sheets.
    fn is_exact(&self, sample: &BodySample, tuning: &Tuning) -> bool {
        let is_plain = self.weight_without_departure() > 0.5 && self.false_share(sample) < tuning.other_things;
        let on_sheets = |found: &Primitive| on_either_side(found, sample, tuning).is_empty();
        is_plain && self.likeliest(self.kind()).is_some_and(|found| on_sheets(&found))
    }

    /// The likeliest hypothesis of one kind.
    pub(crate) fn best_of(&self, kind: PartKind) -> Option<&BodyHypothesis> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.max_by(|a, b| a.1.total_cmp(b.1)).map(|(n, _)| n)
    }

    /// Contacts that lie on one of the primitives, by its own scatter and departure.
    fn belonging(&self, of: usize, all: &BodySample, tuning: &Tuning) -> Vec<usize> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(node, _)| node.of == of);
        let Some((node, _)) = own.max_by(|a, b| a.1.total_cmp(b.1)) else { return Vec::new() };
        let near = tuning.belongs * node.scatter().hypot(node.departure_size());
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

/// Judges contacts. Of very many the evidence is taken from a part, evenly among all.
pub(crate) fn infer(all: &BodySample, tuning: &Tuning) -> Verdict {
    let sample = &all.at_most(tuning.most_contacts);
    let modes = modes(sample, tuning);
    let one = posterior(&modes, sample, tuning);
    // where no primitive holds most of the contacts none is as probable as several
    let of_one = one.as_ref().map_or(f64::NEG_INFINITY, |one| one.log_evidence);
    let answer = one.filter(|one| is_answer(one, sample, tuning));
    let is_sure = answer.as_ref().is_some_and(|one| one.is_exact(sample, tuning));
    let several = || several_things(sample, &modes, of_one, tuning);
    if let Some(things) = (!is_sure).then(several).flatten() {
        return Verdict::Several(things);
    }
    let Some(mut posterior) = answer else { return Verdict::None };
    if sample.len() < all.len() {
        let belonging = |of| posterior.belonging(of, all, tuning);
        posterior.members = (0..posterior.primitives.len()).map(belonging).collect();
    }
    Verdict::One(Box::new(posterior))
}

/// Whether the likeliest kind comes near enough.
fn is_answer(one: &BodyPosterior, sample: &BodySample, tuning: &Tuning) -> bool {
    let kind = one.kind();
    let Some(best) = one.best_of(kind) else { return false };
    let slope = best.departure.map_or(0.0, |[length, _]| best.departure_rms / length);
    let is_near = slope <= tuning.largest_slope && best.sd[0] <= tuning.largest_scatter;
    is_near && one.false_share(sample) <= tuning.false_most
}

fn posterior(modes: &[Mode], sample: &BodySample, tuning: &Tuning) -> Option<BodyPosterior> {
    // where no contact was found to be false both modes of a kind are one
    let is_own = |m: &&Mode| m.strays == FalseContacts::None || m.members().len() < sample.len();
    let own = modes.iter().filter(is_own).filter(|m| m.holds_most(tuning));
    let bases: Vec<LinearisedBase> = own.map(|m| LinearisedBase::new(m, sample, tuning).departing(tuning)).collect();
    let rough: Vec<f64> = bases.iter().map(|base| base.rough(tuning)).collect();
    let likeliest = most(&rough);
    let is_worth = |rough: f64| rough > likeliest - tuning.hopeless[0];
    let worth = bases.into_iter().zip(rough).filter(|(_, rough)| is_worth(*rough));
    let judged: Vec<(LinearisedBase, Vec<BodyHypothesis>)> = worth
        .map(|(base, _)| {
            let nodes = base.nodes(0, tuning);
            (base, nodes)
        })
        .collect();
    let best = most(&judged.iter().flat_map(|(_, nodes)| nodes.iter().map(|n| n.log_evidence)).collect::<Vec<f64>>());
    let (mut primitives, mut members, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
    for (base, found) in judged {
        let (base, mut found) = about_its_best(base, found, best, tuning);
        found.retain(|node| base.is_linear(node, tuning));
        let prior = kind_prior(base.primitive.kind, tuning);
        found.iter_mut().for_each(|node| (node.of, node.log_evidence) = (primitives.len(), node.log_evidence + prior));
        nodes.extend(found);
        primitives.push(base.primitive);
        members.push(base.members);
    }
    let (nodes, weights, log_evidence) = normalised(nodes, tuning)?;
    Some(BodyPosterior { primitives, members, nodes, weights, log_evidence, is_free: false })
}

/// The nodes that have a weight, their weights, and the log evidence of the likeliest.
pub(super) fn normalised(
    mut nodes: Vec<BodyHypothesis>,
    tuning: &Tuning,
) -> Option<(Vec<BodyHypothesis>, Vec<f64>, f64)> {
    let most = most(&nodes.iter().map(|n| n.log_evidence).collect::<Vec<f64>>());
    if !most.is_finite() {
        return None;
    }
    nodes.retain(|node| node.log_evidence > most - tuning.hopeless[1]);
    let mut weights: Vec<f64> = nodes.iter().map(|node| (node.log_evidence - most).exp()).collect();
    let all: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= all);
    Some((nodes, weights, most))
}

/// The same about the likeliest node's primitive, where that has a chance: the departure takes its part of the distances, so that the
/// likeliest primitive is another than the robust one.
fn about_its_best<'a>(
    base: LinearisedBase<'a>,
    nodes: Vec<BodyHypothesis>,
    best: f64,
    tuning: &Tuning,
) -> (LinearisedBase<'a>, Vec<BodyHypothesis>) {
    let likeliest = nodes.iter().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
    let Some(likeliest) = likeliest.filter(|node| node.log_evidence > best - tuning.hopeless[1]) else {
        return (base, nodes);
    };
    let step = likeliest.step().to_vec();
    if !moved(&base.primitive, &step).is_sound(tuning.extent) {
        return (base, nodes);
    }
    let base = base.moved(&step, tuning);
    let nodes = base.nodes(0, tuning);
    (base, nodes)
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn kind_prior(kind: PartKind, tuning: &Tuning) -> f64 {
    let all: f64 = tuning.kinds.iter().sum();
    let own = PartKind::BODIES.iter().position(|known| *known == kind);
    own.map_or(f64::NEG_INFINITY, |k| (tuning.kinds[k] / all).ln())
}
