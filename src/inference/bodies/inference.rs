//! The steps from contacts to weighted hypotheses, top to bottom.

use std::sync::Arc;

use super::body_hypothesis::BodyHypothesis;
use super::body_posterior::{BodyPosterior, most, normalised};
use super::coordinates::DepartureOver;
use super::division::is_simple;
use super::evidence::LinearisedBase;
use super::free_surface::free_surface;
use super::mode::{FalseContacts, Mode};
use super::other_things::{RatedThings, scatter, several_things};
use super::sample::BodySample;
use super::search::ModeSearch;
use super::thing::Thing;
use super::tuning::Tuning;
use crate::primitives::placed::PartKind;

/// What the contacts are.
#[derive(Clone, Debug)]
pub(crate) enum Verdict {
    /// One thing.
    One(Box<BodyPosterior>),
    /// Two primitives or more, in the sample's units.
    Several(Vec<Thing>),
    /// A surface of no simple kind, which explains the contacts clearly better than any primitive, and the primitives that come near
    /// enough all the same.
    Free {
        found: Box<BodyPosterior>,
        one: Option<Box<BodyPosterior>>,
        /// Things that explain the contacts about as well, where there are.
        several: Vec<Thing>,
    },
    /// No primitive comes near enough, and no free surface tells contacts that are left out.
    None,
}

/// Judges contacts. Of very many the evidence is taken from a part, evenly among all.
pub(crate) fn infer(all: &BodySample, tuning: &Tuning) -> Verdict {
    infer_beside(all, tuning, |sample, of_one, search| FreeRival::new(all, sample, of_one, search))
}

/// The same by primitives alone.
pub(crate) fn infer_primitives(all: &BodySample, tuning: &Tuning) -> Verdict {
    infer_beside(all, tuning, |_, _, _| None)
}

/// The posterior of primitives about one thing, whether or not they come near the contacts.
pub(crate) fn posterior_of_primitives(all: &BodySample, tuning: &Tuning) -> Option<BodyPosterior> {
    FoundBody::new(all, tuning).posterior(tuning)
}

/// Contacts of one thing and the modes of all primitives among them, of which any settings may be asked.
#[derive(Debug)]
pub(crate) struct FoundBody {
    sample: BodySample,
    modes: Arc<Vec<Mode>>,
}

impl FoundBody {
    pub(crate) fn new(all: &BodySample, tuning: &Tuning) -> FoundBody {
        let sample = all.at_most(tuning.most_contacts);
        let modes = ModeSearch::new(tuning).modes(&sample);
        FoundBody { sample, modes }
    }

    /// The posterior of primitives about one thing, whether or not they come near the contacts.
    pub(crate) fn posterior(&self, tuning: &Tuning) -> Option<BodyPosterior> {
        posterior(&self.modes, &self.sample, tuning)
    }
}

fn infer_beside(
    all: &BodySample,
    tuning: &Tuning,
    free: impl FnOnce(&BodySample, f64, &ModeSearch) -> Option<FreeRival>,
) -> Verdict {
    let sample = &all.at_most(tuning.most_contacts);
    let search = &ModeSearch::new(tuning);
    let modes = search.modes(sample);
    let one = posterior(&modes, sample, tuning);
    // where no primitive holds most of the contacts none is as probable as several
    let of_one = evidence_of(one.as_ref());
    let answer_of = |one: &BodyPosterior| is_answer(one, sample, tuning);
    let is_sure = one.as_ref().is_some_and(|one| answer_of(one) && one.is_exact(sample, tuning));
    let beside = one.as_ref().filter(|_| !is_sure).and_then(|one| one.without_sections(tuning));
    let free = if is_sure { None } else { free(sample, evidence_of(beside.as_ref()), search) };
    let answer = one.filter(answer_of);
    let beside = beside.filter(|_| answer.is_some());
    let is_clear = |free: &FreeRival| beside.as_ref().is_none_or(|one| free.is_clear(one, tuning));
    let several = (!is_sure).then(|| several_things(sample, &modes, of_one, search)).flatten();
    let instead = match several {
        // one primitive is then no answer
        Some(several) if several.probability > 0.5 => return several_or_free(several, free.filter(is_clear), search),
        several => several.map(RatedThings::beside_one),
    };
    let one = answer.map(|mut posterior| {
        posterior.instead = instead;
        if sample.len() < all.len() {
            let belonging = |of| posterior.belonging(of, all, tuning);
            posterior.members = (0..posterior.primitives.len()).map(belonging).collect();
        }
        Box::new(posterior)
    });
    // what most of the contacts do not lie on is no answer, though those that it was computed from do
    let least = (1.0 - tuning.false_most) * all.len() as f64;
    let one = one.filter(|one| one.members_of(one.kind()).len() as f64 >= least);
    match free.filter(is_clear) {
        Some(free) => Verdict::Free { found: Box::new(free.found), one, several: Vec::new() },
        None => one.map_or(Verdict::None, Verdict::One),
    }
}

/// Several things, or the free surface where it explains the contacts as well.
fn several_or_free(several: RatedThings, free: Option<FreeRival>, search: &ModeSearch) -> Verdict {
    let Some(free) = free else { return Verdict::Several(several.things) };
    let (behind, tuning) = (free.behind(&several, search), search.tuning);
    let is_open = behind >= -tuning.clearly;
    if behind > tuning.clearly || is_open && free.says_less(&several.things, tuning) {
        return Verdict::Several(several.things);
    }
    let several = if is_open { several.things } else { Vec::new() };
    Verdict::Free { found: Box::new(free.found), one: None, several }
}

/// A free surface beside the primitives, with the evidence of both over the same contacts.
struct FreeRival {
    found: BodyPosterior,
    /// Log evidence of the likeliest primitive over the contacts that the free surface was computed from.
    of_one: f64,
    /// These contacts and the modes of primitives among them, where they are not all.
    of_some: Option<(BodySample, Arc<Vec<Mode>>)>,
}

impl FreeRival {
    fn new(all: &BodySample, sample: &BodySample, of_one: f64, search: &ModeSearch) -> Option<FreeRival> {
        let (found, tuning) = (free_surface(all, search)?, search.tuning);
        if sample.len() <= tuning.free_contacts {
            return Some(FreeRival { found, of_one, of_some: None });
        }
        let some = all.at_most(tuning.free_contacts);
        let known = search.modes(&some);
        let one = posterior(&known, &some, tuning).and_then(|one| one.without_sections(tuning));
        Some(FreeRival { found, of_one: evidence_of(one.as_ref()), of_some: Some((some, known)) })
    }

    /// Whether it explains the contacts clearly better than a primitive with a departure of its own, and lies nearer to them: a primitive
    /// that is as near says more.
    fn is_clear(&self, one: &BodyPosterior, tuning: &Tuning) -> bool {
        let of_one = one.best_of(one.kind()).map_or(f64::INFINITY, |best| best.scatter().hypot(best.departure_size()));
        self.found.log_evidence > self.of_one + tuning.clearly && of_one > tuning.as_near * self.scatter()
    }

    fn scatter(&self) -> f64 {
        self.found.best_of(self.found.kind()).map_or(f64::INFINITY, BodyHypothesis::scatter)
    }

    /// Whether simple things are as near to the contacts. Rings and ellipsoids follow the pieces of any smooth body.
    fn says_less(&self, things: &[Thing], tuning: &Tuning) -> bool {
        let are_simple = things.iter().all(|thing| is_simple(thing.primitive.kind));
        are_simple && scatter(things) <= tuning.as_near * self.scatter()
    }

    /// Log evidence by which several things are ahead of it, over the contacts that it was computed from. Beforehand it may be of any symmetry.
    fn behind(&self, several: &RatedThings, search: &ModeSearch) -> f64 {
        let of_several = match &self.of_some {
            None => several.log_evidence,
            Some((some, known)) => several_things(some, known, f64::NEG_INFINITY, search)
                .map_or(f64::NEG_INFINITY, |several| several.log_evidence),
        };
        of_several - self.found.log_evidence + (DepartureOver::FORMS.len() as f64).ln()
    }
}

/// Log evidence of the likeliest hypothesis; none where there is no posterior.
fn evidence_of(one: Option<&BodyPosterior>) -> f64 {
    one.map_or(f64::NEG_INFINITY, |one| one.log_evidence)
}

/// Whether the likeliest kind comes near enough.
fn is_answer(one: &BodyPosterior, sample: &BodySample, tuning: &Tuning) -> bool {
    let kind = one.kind();
    let Some(best) = one.best_of(kind) else { return false };
    let is_near = best.slope() <= tuning.largest_slope && best.sd[0] <= tuning.largest_scatter;
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
    Some(BodyPosterior { primitives, members, nodes, weights, log_evidence, is_free: false, instead: None })
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
    if !likeliest.likeliest(&base.primitive).is_sound(tuning.extent) {
        return (base, nodes);
    }
    let base = base.moved(&step, tuning);
    let nodes = base.nodes(0, tuning);
    (base, nodes)
}

fn kind_prior(kind: PartKind, tuning: &Tuning) -> f64 {
    let all: f64 = tuning.kinds.iter().sum();
    let own = PartKind::BODIES.iter().position(|known| *known == kind);
    own.map_or(f64::NEG_INFINITY, |k| (tuning.kinds[k] / all).ln())
}
