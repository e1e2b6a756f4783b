//! Whether contacts are several things: a second sheet, a wall behind a ball, the end of a bar.
//!
//! ```text
//! first    a primitive with the contacts that are its own; what it leaves out would be false
//! second   a primitive of the contacts left out
//! ln p(two things) = ln p(first, others false) - ln p(others false) + ln p(second of the others)
//! ```
//!
//! That sum is compared with the evidence of the best single primitive, however large its departure and its scatter, and with that of
//! one smooth surface of any shape: pieces of a wave are not more probable than the wave.

use super::candidates::{on_either_side, principal};
use super::evidence::LinearisedBase;
use super::mode::{Candidate, FalseContacts, Mode, log_false, mode, next_to_all};
use super::sample::BodySample;
use super::search::{minorities, modes};
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::threads;

/// Whether contacts lie beside a line.
fn spans(sample: &BodySample, tuning: &Tuning) -> bool {
    let [_, across, along] = principal(sample).2;
    across > tuning.row * tuning.row * along
}

/// A primitive and how many contacts are its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thing {
    pub(crate) primitive: Primitive,
    pub(crate) contacts: usize,
    /// Sd of their distances.
    pub(crate) scatter: f64,
}

impl Thing {
    fn of(mode: &Mode) -> Thing {
        Thing { primitive: mode.primitive, contacts: mode.members().len(), scatter: mode.sd[0] }
    }
}

/// The things that explain the contacts clearly better than one, whose log evidence is given: two of them are looked for together, and
/// further ones in what both leave out.
pub(super) fn several_things(sample: &BodySample, known: &[Mode], of_one: f64, tuning: &Tuning) -> Option<Vec<Thing>> {
    let parallel = known.iter().flat_map(|found| on_either_side(&found.primitive, sample, tuning));
    let beside: Vec<Candidate> = parallel.map(|start| Candidate::new(start, FalseContacts::Some, tuning)).collect();
    let sheets = threads::map(beside.len(), 1, |k| mode(&beside[k], sample, tuning));
    let sheets: Vec<Mode> = sheets.into_iter().flatten().collect();
    let with_evidence = |first| Some((of_one_thing(first, sample, tuning)?, first));
    let few = minorities(sample, tuning);
    let mut firsts: Vec<(f64, &Mode)> = known.iter().chain(&sheets).chain(&few).filter_map(with_evidence).collect();
    firsts.retain(|(_, first)| is_near(first, tuning) && leaves_enough(sample, first, tuning));
    firsts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let split = |k: usize| {
        let (of_first, first) = firsts[k];
        let others = sample.only(&first.others());
        let second = next_thing(&others, tuning)?;
        Some((of_first + second.gain, first.clone(), second.thing, others.only(&second.left)))
    };
    let rated = threads::map(firsts.len().min(tuning.firsts), 1, split);
    let splits: Vec<(f64, Mode, Thing, BodySample)> = rated.into_iter().flatten().collect();
    let most = splits.iter().map(|split| split.0).fold(f64::NEG_INFINITY, f64::max);
    // of those that are as good the simplest
    let as_good = splits.into_iter().filter(|split| split.0 > most - tuning.clearly);
    let (mut log, first, second, mut rest) =
        as_good.min_by(|a, b| unknowns(&a.1).cmp(&unknowns(&b.1)).then(b.0.total_cmp(&a.0)))?;
    let of_two = log;
    let mut things = vec![Thing::of(&first), second];
    while things.len() < tuning.most_things {
        let Some(next) = next_thing(&rest, tuning).filter(|next| next.gain > tuning.clearly) else { break };
        rest = rest.only(&next.left);
        log += next.gain;
        things.push(next.thing);
    }
    // further things count only where nothing else is left: else they are what is near the first two
    let held = things.iter().map(|thing| thing.contacts).sum::<usize>() as f64;
    let holds_all = held >= tuning.things_hold * sample.len() as f64;
    let most = if holds_all { log } else { of_two };
    let is_clear = most > of_one + tuning.clearly && most > of_smooth(sample, known, tuning) + tuning.clearly;
    is_clear.then_some(things)
}

/// Root mean square scatter of contacts about their things.
pub(crate) fn scatter(things: &[Thing]) -> f64 {
    let count: f64 = things.iter().map(|thing| thing.contacts as f64).sum();
    (things.iter().map(|thing| thing.contacts as f64 * thing.scatter.powi(2)).sum::<f64>() / count).sqrt()
}

/// What unknowns of a surface cost in log evidence, `u ln(sqrt(n) / s)`: Schwarz's with a prior as wide as the contacts (G. Schwarz,
/// *Ann. Statist.* 6 (1978) 461), whose scatter is in units of their size.
pub(crate) fn price_of_unknowns(unknowns: f64, contacts: f64, scatter: f64) -> f64 {
    unknowns * (contacts.sqrt() / scatter).ln()
}

/// Log evidence of one smooth surface of any shape over the primitive next to all contacts, the best of its lengths and sizes.
fn of_smooth(sample: &BodySample, known: &[Mode], tuning: &Tuning) -> f64 {
    let Some(base) = next_to_all(known.iter()) else { return f64::NEG_INFINITY };
    let linearised = LinearisedBase::new(base, sample, tuning);
    let linearised = linearised.with_lengths(&tuning.free_lengths, tuning.free_features, tuning);
    let nodes = linearised.departed_nodes(0, &tuning.free_sizes, 0.0, tuning);
    nodes.map(|node| node.log_evidence).fold(f64::NEG_INFINITY, f64::max)
}

/// Whether contacts lie on it: a plane between two faces has the normals of both and none of their contacts.
fn is_near(mode: &Mode, tuning: &Tuning) -> bool {
    mode.sd[0] <= tuning.largest_scatter
}

/// Whether the first thing has contacts enough, leaves enough, and neither are one row.
fn leaves_enough(sample: &BodySample, first: &Mode, tuning: &Tuning) -> bool {
    let own = first.members();
    let least = ((tuning.other_things * sample.len() as f64).ceil() as usize).max(fewest(sample, tuning));
    let counts = own.len() >= least && sample.len() - own.len() >= least;
    counts && spans(&sample.only(&own), tuning) && spans(&sample.only(&first.others()), tuning)
}

/// The likeliest primitive of contacts that belong to nothing yet.
struct NextThing {
    thing: Thing,
    /// Log evidence less that of all being false.
    gain: f64,
    /// Contacts that it leaves out.
    left: Vec<usize>,
}

/// `None` where none holds enough of them.
fn next_thing(rest: &BodySample, tuning: &Tuning) -> Option<NextThing> {
    if !may_hold_a_thing(rest, tuning) {
        return None;
    }
    let found = all_modes(rest, tuning);
    let rated = with_gains(&found, rest, tuning);
    let by_gain = |a: &&(f64, &Mode), b: &&(f64, &Mode)| a.0.total_cmp(&b.0);
    let (mut gain, mut chosen) = *rated.iter().max_by(by_gain)?;
    // a ring or an ellipsoid, or whatever scatters widely, may follow two simpler things at once
    let is_rival = |m: &Mode| {
        is_simple(m.primitive.kind) && (!is_simple(chosen.primitive.kind) || m.sd[0] < tuning.sharper * chosen.sd[0])
    };
    let of_kind = |kind: PartKind| {
        let own = rated.iter().filter(|(_, m)| m.primitive.kind == kind && is_rival(m));
        own.max_by(by_gain)
    };
    let rivals: Vec<&(f64, &Mode)> = SIMPLE.into_iter().filter_map(of_kind).collect();
    let with_next = threads::map(rivals.len(), 1, |k| {
        let (own, m) = *rivals[k];
        (own + of_next(m, rest, tuning), own, m)
    });
    let most = with_next.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, of_simple, simple)) = most.filter(|(both, ..)| *both > gain) {
        (gain, chosen) = (of_simple, simple);
    }
    Some(NextThing { thing: Thing::of(chosen), gain, left: chosen.others() })
}

/// Modes that hold most of the contacts, and a minority of them.
fn all_modes(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
    let mut found = modes(sample, tuning);
    found.extend(minorities(sample, tuning));
    found
}

/// What the likeliest primitive of the contacts that a mode leaves out gains; 0 where there is none.
fn of_next(mode: &Mode, rest: &BodySample, tuning: &Tuning) -> f64 {
    let left = rest.only(&mode.others());
    let beside = if may_hold_a_thing(&left, tuning) { all_modes(&left, tuning) } else { Vec::new() };
    with_gains(&beside, &left, tuning).iter().map(|(gain, _)| *gain).fold(0.0, f64::max)
}

/// Log evidence of one thing, the others being false.
fn of_one_thing(mode: &Mode, sample: &BodySample, tuning: &Tuning) -> Option<f64> {
    LinearisedBase::new(mode, sample, tuning).beside_others(tuning).without_departure(tuning)
}

/// Modes with contacts enough, and their log evidence less that of all contacts being false.
fn with_gains<'a>(found: &'a [Mode], rest: &BodySample, tuning: &Tuning) -> Vec<(f64, &'a Mode)> {
    let by_chance: f64 = (0..rest.len()).map(|i| log_false(tuning, rest.normal(i).is_some())).sum();
    let gain = |m: &Mode| Some(of_one_thing(m, rest, tuning)? - by_chance);
    let least = fewest(rest, tuning).max((tuning.second_share * rest.len() as f64).ceil() as usize);
    let is_thing = |m: &&Mode| is_near(m, tuning) && m.members().len() >= least && is_told(m, rest);
    found.iter().filter(is_thing).filter_map(|m| Some((gain(m)?, m))).collect()
}

/// Whether its contacts have more rows than it takes to pass through them.
fn is_told(mode: &Mode, sample: &BodySample) -> bool {
    let normals = mode.members().iter().filter(|i| sample.normal(**i).is_some()).count();
    mode.members().len() + 2 * normals > unknowns(mode) + 1
}

/// Contacts that a thing has at least.
fn fewest(sample: &BodySample, tuning: &Tuning) -> usize {
    tuning.thing_contacts[usize::from(sample.known_normals() == sample.len())]
}

fn may_hold_a_thing(rest: &BodySample, tuning: &Tuning) -> bool {
    rest.len() >= fewest(rest, tuning) && spans(rest, tuning)
}

/// Kinds that do not follow two things at once.
const SIMPLE: [PartKind; 4] = [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone];

/// Whether a kind does not follow two things at once, nor whatever smooth surface there is.
pub(crate) fn is_simple(kind: PartKind) -> bool {
    SIMPLE.contains(&kind)
}

fn unknowns(mode: &Mode) -> usize {
    mode.primitive.kind.free().len()
}
