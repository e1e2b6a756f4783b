//! The steps from contacts to weighted hypotheses, top to bottom.

use super::candidates::{Candidate, candidates, on_either_side};
use super::evidence::{Linearised, Node, moved};
use super::mode::{FalseContacts, Mode, is_possible, mode};
use super::other_things::{Thing, two_things};
use super::sample::Sample;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};

/// Contacts among which modes are searched; the best of every kind is then followed over all.
const SEARCHED: usize = 400;

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
    pub(crate) nodes: Vec<Node>,
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
    Several([Thing; 2]),
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
    pub(crate) fn best_of(&self, kind: PartKind) -> Option<&Node> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.max_by(|a, b| a.1.total_cmp(b.1)).map(|(n, _)| n)
    }

    /// The likeliest primitive of one kind.
    pub(crate) fn likeliest(&self, kind: PartKind) -> Option<Primitive> {
        let base = |node: &Node| self.primitives[node.of];
        let there = |node: &Node| Some(moved(&base(node), node.step())).filter(is_possible);
        self.best_of(kind).map(|node| there(node).unwrap_or(base(node)))
    }

    /// Contacts that belong to the likeliest primitive of one kind.
    pub(crate) fn members_of(&self, kind: PartKind) -> &[usize] {
        self.best_of(kind).map_or(&[], |node| &self.members[node.of])
    }
}

/// Judges contacts.
pub(crate) fn infer(sample: &Sample, tuning: &Tuning) -> Verdict {
    let modes = modes(sample, tuning);
    let Some(posterior) = posterior(&modes, sample, tuning) else { return Verdict::None };
    let kind = posterior.kind();
    if let Some(things) = two_things(sample, &modes, posterior.log_evidence, tuning) {
        return Verdict::Several(things);
    }
    let Some(best) = posterior.best_of(kind) else { return Verdict::None };
    let slope = best.departure.map_or(0.0, |[length, _]| best.departure_rms / length);
    let false_share = 1.0 - posterior.members_of(kind).len() as f64 / sample.len() as f64;
    if slope > tuning.largest_slope || best.sd[0] > tuning.largest_scatter || false_share > tuning.false_most {
        return Verdict::None;
    }
    Verdict::One(Box::new(posterior))
}

/// The likeliest modes of every kind over all contacts, without false contacts and with some: which of both the contacts are is a matter of
/// the evidence.
pub(super) fn modes(sample: &Sample, tuning: &Tuning) -> Vec<Mode> {
    let few = sample.at_most(SEARCHED);
    let mut best: Vec<Mode> = Vec::new();
    for candidate in candidates(&few, tuning) {
        keep_better(&mut best, candidate, &few, tuning);
    }
    for found in best.clone() {
        for start in on_either_side(&found.primitive, &few, tuning) {
            keep_better(&mut best, Candidate { start, strays: FalseContacts::Some }, &few, tuning);
        }
    }
    if few.len() == sample.len() {
        return best;
    }
    best.iter().filter_map(|found| mode(&found.primitive, sample, found.strays, tuning)).collect()
}

/// Follows a start, and keeps its mode where it is likelier than the one of its kind.
fn keep_better(best: &mut Vec<Mode>, Candidate { start, strays }: Candidate, few: &Sample, tuning: &Tuning) {
    if few.len() + 2 * few.known_normals() <= start.kind.free().len() {
        return;
    }
    let found = mode(&start, few, strays, tuning).filter(|found| found.primitive.is_sound(EXTENT));
    let Some(found) = found else { return };
    let is_rival = |known: &&mut Mode| known.primitive.kind == found.primitive.kind && known.strays == strays;
    match best.iter_mut().find(is_rival) {
        Some(known) if known.likelihood >= found.likelihood => {}
        Some(known) => *known = found,
        None => best.push(found),
    }
}

/// Extent of contacts in units of their own size, by which a primitive is told from a simpler one.
const EXTENT: f64 = 3.0;

fn posterior(modes: &[Mode], sample: &Sample, tuning: &Tuning) -> Option<BodyPosterior> {
    let (mut primitives, mut members, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
    // where no contact was found to be false both modes of a kind are one
    let modes: Vec<&Mode> =
        modes.iter().filter(|m| !(m.strays == FalseContacts::Some && m.members().len() == sample.len())).collect();
    let all: Vec<Linearised> = modes.iter().map(|found| Linearised::new(found, sample, tuning)).collect();
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
