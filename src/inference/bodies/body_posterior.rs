//! The weighted hypotheses about one thing, and what they say of kind and symmetry.

use super::body_hypothesis::BodyHypothesis;
use super::candidates::is_between;
use super::coordinates::Symmetry;
use super::mode::is_possible;
use super::sample::BodySample;
use super::thing::PossibleThings;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_geometry::neighbours::mean_of;
use palpate_numeric::vector::{Vector, norm};

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
    /// Several things that the contacts may be instead, where one is not certain.
    pub(crate) instead: Option<PossibleThings>,
}

impl BodyPosterior {
    /// Of a free surface whose hypothesis is taken for certain, without contacts of its own.
    pub(super) fn of_one(primitive: Primitive, node: BodyHypothesis) -> BodyPosterior {
        let log_evidence = node.log_evidence;
        let (members, weights) = (vec![Vec::new()], vec![1.0]);
        BodyPosterior {
            primitives: vec![primitive],
            members,
            nodes: vec![node],
            weights,
            log_evidence,
            is_free: true,
            instead: None,
        }
    }

    /// The same without rings whose section departs from a circle: a curve turned about an axis is that, and more exactly.
    pub(super) fn without_sections(&self, tuning: &Tuning) -> Option<BodyPosterior> {
        let own = self.nodes.iter().filter(|node| !node.is_of_section()).cloned().collect();
        let (nodes, weights, log_evidence) = normalised(own, tuning)?;
        let (primitives, members) = (self.primitives.clone(), self.members.clone());
        Some(BodyPosterior { primitives, members, nodes, weights, log_evidence, is_free: self.is_free, instead: None })
    }

    /// Probability that there is no departure.
    pub(crate) fn weight_without_departure(&self) -> f64 {
        self.nodes.iter().zip(&self.weights).filter(|(n, _)| n.length().is_none()).map(|(_, w)| w).sum()
    }

    /// The likeliest kind, by the sum over all its hypotheses.
    pub(crate) fn kind(&self) -> PartKind {
        let weight = |kind: &PartKind| self.weight_of(*kind);
        PartKind::BODIES.into_iter().max_by(|a, b| weight(a).total_cmp(&weight(b))).unwrap_or(PartKind::Plane)
    }

    /// The symmetry of the surface that is reported: the likeliest one of the likeliest kind.
    pub(crate) fn symmetry(&self) -> Symmetry {
        self.best_of(self.kind()).map_or(Symmetry::None, BodyHypothesis::symmetry)
    }

    fn of_symmetry(&self, symmetry: Symmetry) -> impl Iterator<Item = (&BodyHypothesis, &f64)> {
        self.nodes.iter().zip(&self.weights).filter(move |(node, _)| node.symmetry() == symmetry)
    }

    /// Probability of one symmetry.
    pub(crate) fn weight_of_symmetry(&self, symmetry: Symmetry) -> f64 {
        self.of_symmetry(symmetry).map(|(_, w)| w).sum()
    }

    /// The likeliest hypothesis of one symmetry.
    pub(crate) fn best_of_symmetry(&self, symmetry: Symmetry) -> Option<&BodyHypothesis> {
        self.of_symmetry(symmetry).max_by(|a, b| a.1.total_cmp(b.1)).map(|(node, _)| node)
    }

    /// Whether it is a free surface that contacts go all round.
    pub(crate) fn closes(&self, sample: &BodySample, tuning: &Tuning) -> bool {
        let Some(likeliest) = self.likeliest(self.kind()) else { return false };
        let normals: Vec<Vector> = sample.points.iter().map(|p| likeliest.nearest(*p).1).collect();
        let is_closed = matches!(likeliest.kind, PartKind::Sphere | PartKind::Ellipsoid);
        is_closed && norm(mean_of(&normals)) < tuning.all_round
    }

    /// Probability of one kind.
    pub(crate) fn weight_of(&self, kind: PartKind) -> f64 {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.map(|(_, w)| w).sum()
    }

    /// Probabilities of all kinds, in the order of [`PartKind::BODIES`].
    pub(crate) fn weights_of_kinds(&self) -> [f64; 6] {
        PartKind::BODIES.map(|kind| self.weight_of(kind))
    }

    /// Log evidence of all hypotheses together.
    pub(crate) fn log_sum(&self) -> f64 {
        self.log_evidence - most(&self.weights).ln()
    }

    /// Probability of one kind without a departure.
    pub(crate) fn weight_of_plain(&self, kind: PartKind) -> f64 {
        let is_own = |node: &BodyHypothesis| self.primitives[node.of].kind == kind && node.length().is_none();
        self.nodes.iter().zip(&self.weights).filter(|(node, _)| is_own(node)).map(|(_, w)| w).sum()
    }

    /// The same hypotheses, those of each kind times a factor; `None` where all have none left.
    pub(crate) fn reweighed(&self, factor: impl Fn(PartKind) -> f64) -> Option<BodyPosterior> {
        let each = self.nodes.iter().zip(&self.weights);
        let mut weights: Vec<f64> = each.map(|(node, w)| w * factor(self.primitives[node.of].kind)).collect();
        let all: f64 = weights.iter().sum();
        if !(all.is_finite() && all > 0.0) {
            return None;
        }
        weights.iter_mut().for_each(|w| *w /= all);
        Some(BodyPosterior { weights, ..self.clone() })
    }

    /// Share of the contacts that are none of the likeliest kind's.
    pub(super) fn false_share(&self, sample: &BodySample) -> f64 {
        1.0 - self.members_of(self.kind()).len() as f64 / sample.len() as f64
    }

    /// Whether the likeliest kind holds nearly all contacts without a departure, and not between two sheets or walls.
    pub(super) fn is_exact(&self, sample: &BodySample, tuning: &Tuning) -> bool {
        let is_plain = self.weight_without_departure() > 0.5 && self.false_share(sample) < tuning.other_things;
        is_plain && self.likeliest(self.kind()).is_some_and(|found| !is_between(&found, sample, tuning))
    }

    /// The likeliest hypothesis of one kind.
    pub(crate) fn best_of(&self, kind: PartKind) -> Option<&BodyHypothesis> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(n, _)| self.primitives[n.of].kind == kind);
        own.max_by(|a, b| a.1.total_cmp(b.1)).map(|(n, _)| n)
    }

    /// Contacts that lie on one of the primitives, by its own scatter and departure.
    pub(super) fn belonging(&self, of: usize, all: &BodySample, tuning: &Tuning) -> Vec<usize> {
        let own = self.nodes.iter().zip(&self.weights).filter(|(node, _)| node.of == of);
        let Some((node, _)) = own.max_by(|a, b| a.1.total_cmp(b.1)) else { return Vec::new() };
        let near = tuning.belongs * node.scatter().hypot(node.departure_size());
        let primitive = self.likeliest_of(node);
        (0..all.len()).filter(|&i| primitive.nearest(all.points[i]).0.abs() <= near).collect()
    }

    /// The likeliest primitive of one kind.
    pub(crate) fn likeliest(&self, kind: PartKind) -> Option<Primitive> {
        self.best_of(kind).map(|node| self.likeliest_of(node))
    }

    /// The likeliest primitive of a hypothesis; that which it is linear about where a step from there leads to none.
    fn likeliest_of(&self, node: &BodyHypothesis) -> Primitive {
        let base = self.primitives[node.of];
        Some(node.likeliest(&base)).filter(is_possible).unwrap_or(base)
    }

    /// Contacts that belong to the likeliest primitive of one kind.
    pub(crate) fn members_of(&self, kind: PartKind) -> &[usize] {
        self.best_of(kind).map_or(&[], |node| &self.members[node.of])
    }
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

pub(super) fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
