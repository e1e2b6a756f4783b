//! Whether contacts are several things: a second sheet, a wall behind a ball, the end of a bar.
//!
//! ```text
//! first    a primitive with the contacts that are its own; what it leaves out would be false
//! second   a primitive of the contacts left out: the likeliest, or in a division of its own the one nearest to its contacts
//! ln p(two things) = ln p(first, others false) - ln p(others false) + ln p(second of the others)
//! ```
//!
//! That sum is compared with the evidence of the best single primitive, however large its departure and its scatter, and with that of
//! one smooth surface of any shape: pieces of a wave are not more probable than the wave. Beside a free surface each thing departs as well:
//! the faces of a box of cardboard are not quite flat.
//!
//! ```text
//! p(several) / p(one) = exp(ln p(several) - ln p(one) - clearly)        beforehand one thing is likelier by `Tuning::clearly`
//! ```

use super::candidates::{nearest_to_all, on_either_side, spans};
use super::division::{Division, FoundThing, NextThing, SIMPLE, is_simple, of_chance, of_one_thing, unknowns};
use super::evidence::LinearisedBase;
use super::faces::faces;
use super::mode::{Candidate, Mode, fewest, mode, next_to_all};
use super::sample::BodySample;
use super::search::ModeSearch;
use super::thing::{PossibleThings, Thing};
use super::tuning::Tuning;
use crate::primitives::placed::PartKind;
use palpate_numeric::threads;

impl Thing {
    fn of(mode: &Mode) -> Thing {
        Thing { primitive: mode.primitive, contacts: mode.members().len(), scatter: mode.sd[0] }
    }
}

/// Things that may be what the contacts are.
pub(super) struct RatedThings {
    pub(super) things: Vec<Thing>,
    /// With a departure of each.
    pub(super) log_evidence: f64,
    /// Of several things against one.
    pub(super) probability: f64,
}

impl RatedThings {
    /// The same as what contacts of one thing may be instead.
    pub(super) fn beside_one(self) -> PossibleThings {
        PossibleThings { things: self.things, probability: self.probability }
    }
}

/// The likeliest things among the contacts, where one thing, whose log evidence is given, is not certain beside them.
pub(super) fn several_things(
    sample: &BodySample,
    known: &[Mode],
    of_one: f64,
    search: &ModeSearch,
) -> Option<RatedThings> {
    let tuning = search.tuning;
    let divided = likeliest_division(sample, known, search)?;
    let of_rival = of_one.max(of_smooth(sample, known, tuning));
    let log_odds = divided.log_evidence - of_rival - tuning.clearly;
    let probability = 1.0 / (1.0 + (-log_odds).exp());
    (probability > 1.0 - tuning.certain).then(|| RatedThings {
        things: divided.things.iter().map(|thing| Thing::of(&thing.mode)).collect(),
        log_evidence: divided.with_departures(tuning),
        probability,
    })
}

fn likeliest_division(sample: &BodySample, known: &[Mode], search: &ModeSearch) -> Option<Division> {
    let tuning = search.tuning;
    let beside: Vec<Candidate> =
        known.iter().flat_map(|found| on_either_side(&found.primitive, sample, tuning)).collect();
    let sheets = threads::map(beside.len(), 1, |k| mode(&beside[k], sample, tuning));
    let sheets: Vec<Mode> = sheets.into_iter().flatten().collect();
    let few = search.minorities(sample);
    let firsts = first_things(known.iter().chain(&sheets).chain(few.iter()), sample, tuning);
    let mut begun: Vec<((f64, &Mode), NextThing)> =
        firsts.iter().map(|first| (*first, likeliest_thing as NextThing)).collect();
    // places alone lie in planes to the last digit that are none: two straight lines of a saddle do
    let is_told_by_normals = sample.known_normals() == sample.len();
    let nearest = || firsts.iter().min_by(|a, b| a.1.sd[0].total_cmp(&b.1.sd[0]));
    begun.extend(is_told_by_normals.then(nearest).flatten().map(|first| (*first, nearest_thing as NextThing)));
    let divided = threads::map(begun.len(), 1, |k| Division::beginning_with(begun[k].0, begun[k].1, sample, search));
    let simplest = simplest_as_good(divided.into_iter().flatten().collect(), tuning);
    let all = simplest.into_iter().chain(divisions_into_faces(&firsts, sample, tuning));
    all.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// Of divisions that are as good the one that begins with the simplest thing; in which order its things were found is nothing that it says.
fn simplest_as_good(divided: Vec<Division>, tuning: &Tuning) -> Option<Division> {
    let most = |found: &mut dyn Iterator<Item = &Division>| {
        found.map(|found| found.log_evidence).fold(f64::NEG_INFINITY, f64::max)
    };
    let least = most(&mut divided.iter()) - tuning.clearly;
    let mut as_good: Vec<Division> = divided.into_iter().filter(|found| found.log_evidence > least).collect();
    let of_first = |found: &Division| unknowns(&found.things[0].mode);
    as_good.sort_by(|a, b| of_first(a).cmp(&of_first(b)).then(b.log_evidence.total_cmp(&a.log_evidence)));
    let kinds = as_good.first()?.kinds();
    let log_evidence = most(&mut as_good.iter().filter(|found| found.kinds() == kinds));
    as_good.into_iter().next().map(|found| Division { log_evidence, ..found })
}

/// Faces alone, and beside each of some first things, where contacts are few and all normals known.
fn divisions_into_faces(firsts: &[(f64, &Mode)], sample: &BodySample, tuning: &Tuning) -> Vec<Division> {
    if sample.len() > tuning.searched {
        return Vec::new();
    }
    let first = |(log, mode): &(f64, &Mode)| (*log, FoundThing { mode: (*mode).clone(), among: sample.clone() });
    let begun: Vec<Option<(f64, FoundThing)>> = firsts.iter().map(|found| Some(first(found))).chain([None]).collect();
    let beside = |k: usize| {
        let rest = begun[k].as_ref().map_or_else(|| sample.clone(), |(_, first)| first.left());
        let divided = faces(&rest, tuning).into_iter();
        divided.filter_map(|faces| Division::of_faces(begun[k].as_slice(), &faces, &rest, tuning)).collect()
    };
    threads::map(begun.len(), 1, beside).into_iter().flat_map(|found: Vec<Division>| found).collect()
}

/// Modes of which others are looked for, with their log evidence: the likeliest of all, and of every simple kind the likeliest that lies
/// far nearer to its own contacts than these: a bar through a box has more of them than any face, and none of its own.
fn first_things<'a>(
    modes: impl Iterator<Item = &'a Mode>,
    sample: &BodySample,
    tuning: &Tuning,
) -> Vec<(f64, &'a Mode)> {
    let is_first = |first: &&Mode| is_near(first, tuning) && leaves_enough(sample, first, tuning);
    let with_evidence = |first| Some((of_one_thing(first, sample, tuning)?, first));
    let mut firsts: Vec<(f64, &Mode)> = modes.filter(is_first).filter_map(with_evidence).collect();
    firsts.sort_by(|a, b| b.0.total_cmp(&a.0));
    // one mode is found from several starts
    firsts.dedup_by(|a, b| a.1.primitive.kind == b.1.primitive.kind && (a.0 - b.0).abs() < tuning.same_mode);
    let farther = firsts.split_off(firsts.len().min(tuning.firsts));
    let scatter = firsts.iter().map(|(_, first)| first.sd[0]).fold(f64::INFINITY, f64::min);
    let nearer = |kind: PartKind| {
        let mut own = farther.iter().filter(move |(_, m)| m.primitive.kind == kind);
        own.find(|(_, m)| m.sd[0] < tuning.sharper * scatter).copied()
    };
    firsts.extend(SIMPLE.into_iter().filter_map(nearer));
    firsts
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

/// The likeliest primitive of contacts that belong to nothing yet, after its log evidence less that of all being false; `None` where none
/// holds enough of them.
fn likeliest_thing(among: BodySample, search: &ModeSearch) -> Option<(f64, FoundThing)> {
    let (rest, tuning) = (&among, search.tuning);
    if !may_hold_a_thing(rest, tuning) {
        return None;
    }
    let found = all_modes(rest, search);
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
        (own + of_next(m, rest, search), own, m)
    });
    let most = with_next.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, of_simple, simple)) = most.filter(|(both, ..)| *both > gain) {
        (gain, chosen) = (of_simple, simple);
    }
    let (gain, mode) = or_simpler((gain, chosen), rest, tuning);
    Some((gain, FoundThing { mode, among }))
}

/// A thing, or what is simpler of its own contacts and gains more: few starts of a kind are followed, and those of planes may all have led
/// to other faces.
fn or_simpler((gain, found): (f64, &Mode), rest: &BodySample, tuning: &Tuning) -> (f64, Mode) {
    let own = found.members();
    let members = rest.only(&own);
    let is_simpler = |kind: &PartKind| kind.free().len() < unknowns(found);
    let about = |kind| Mode::of_members(&nearest_to_all(kind, &members, tuning)?, &own, rest, tuning);
    let simpler: Vec<Mode> = SIMPLE.into_iter().filter(is_simpler).filter_map(about).collect();
    let most = with_gains(&simpler, rest, tuning).into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    most.filter(|(of_simpler, _)| *of_simpler > gain)
        .map_or_else(|| (gain, found.clone()), |(gain, m)| (gain, m.clone()))
}

/// Of the primitives that are clearly likelier than chance those that lie nearest to their own contacts, and the likeliest of these: the four
/// faces about a box's axis are followed by a bar, which holds more contacts than any face and gains more than the next two.
fn nearest_thing(among: BodySample, search: &ModeSearch) -> Option<(f64, FoundThing)> {
    let tuning = search.tuning;
    if !may_hold_a_thing(&among, tuning) {
        return None;
    }
    let found = all_modes(&among, search);
    let rated: Vec<(f64, &Mode)> =
        with_gains(&found, &among, tuning).into_iter().filter(|(gain, _)| *gain > tuning.clearly).collect();
    let scatter = rated.iter().map(|(_, m)| m.sd[0]).fold(f64::INFINITY, f64::min);
    let near = rated.into_iter().filter(|(_, m)| tuning.sharper * m.sd[0] <= scatter);
    let (gain, mode) = or_simpler(near.max_by(|a, b| a.0.total_cmp(&b.0))?, &among, tuning);
    Some((gain, FoundThing { mode, among }))
}

/// Modes that hold most of the contacts, and a minority of them.
fn all_modes(sample: &BodySample, search: &ModeSearch) -> Vec<Mode> {
    search.modes(sample).iter().chain(search.minorities(sample).iter()).cloned().collect()
}

/// What the likeliest primitive of the contacts that a mode leaves out gains; 0 where there is none.
fn of_next(mode: &Mode, rest: &BodySample, search: &ModeSearch) -> f64 {
    let (left, tuning) = (rest.only(&mode.others()), search.tuning);
    let beside = if may_hold_a_thing(&left, tuning) { all_modes(&left, search) } else { Vec::new() };
    with_gains(&beside, &left, tuning).iter().map(|(gain, _)| *gain).fold(0.0, f64::max)
}

/// Modes with contacts enough, and their log evidence less that of all contacts being false.
fn with_gains<'a>(found: &'a [Mode], rest: &BodySample, tuning: &Tuning) -> Vec<(f64, &'a Mode)> {
    let by_chance = of_chance(rest, tuning);
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

fn may_hold_a_thing(rest: &BodySample, tuning: &Tuning) -> bool {
    rest.len() >= fewest(rest, tuning) && spans(rest, tuning)
}
