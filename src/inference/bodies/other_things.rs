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

use super::body_hypothesis::BodyHypothesis;
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

/// Things that explain the contacts clearly better than one.
pub(super) struct RatedThings {
    pub(super) things: Vec<Thing>,
    /// With a departure of each.
    pub(super) log_evidence: f64,
}

/// One of several things among the contacts that no thing before it holds.
struct FoundThing {
    mode: Mode,
    among: BodySample,
}

impl FoundThing {
    fn left(&self) -> BodySample {
        self.among.only(&self.mode.others())
    }
}

/// Things, each found in what those before it leave out.
struct Division {
    things: Vec<FoundThing>,
    /// Log evidence of the first two, and of all; contacts of no thing are false.
    of_two: f64,
    of_all: f64,
}

/// How the next thing is found in what others leave out.
type NextThing = fn(BodySample, &Tuning) -> Option<(f64, FoundThing)>;

impl Division {
    /// Two things, and further ones in what both leave out.
    fn beginning_with(
        (of_first, first): (f64, &Mode),
        next_thing: NextThing,
        sample: &BodySample,
        tuning: &Tuning,
    ) -> Option<Division> {
        let first = FoundThing { mode: first.clone(), among: sample.clone() };
        let (gain, second) = next_thing(first.left(), tuning)?;
        let of_two = of_first + gain;
        let mut rest = second.left();
        let mut found = Division { things: vec![first, second], of_two, of_all: of_two };
        while found.things.len() < tuning.most_things {
            let Some((gain, next)) = next_thing(rest, tuning).filter(|(gain, _)| *gain > tuning.clearly) else { break };
            rest = next.left();
            found.of_all += gain;
            found.things.push(next);
        }
        Some(found)
    }

    /// Further things count only where nothing else is left: else they are what is near the first two.
    fn holds_all(&self, tuning: &Tuning) -> bool {
        let held = self.things.iter().map(|thing| thing.mode.members().len()).sum::<usize>();
        held as f64 >= tuning.things_hold * self.things[0].among.len() as f64
    }

    fn log_evidence(&self, tuning: &Tuning) -> f64 {
        if self.holds_all(tuning) { self.of_all } else { self.of_two }
    }

    /// The same where each departs.
    fn with_departures(&self, tuning: &Tuning) -> f64 {
        let counted = if self.holds_all(tuning) { self.things.len() } else { 2 };
        let departed = threads::map(counted, 1, |k| of_departures(&self.things[k], tuning));
        self.log_evidence(tuning) + departed.iter().sum::<f64>()
    }
}

/// The things that explain the contacts clearly better than one, whose log evidence is given.
pub(super) fn several_things(sample: &BodySample, known: &[Mode], of_one: f64, tuning: &Tuning) -> Option<RatedThings> {
    let divided = likeliest_division(sample, known, tuning)?;
    let of_rival = of_one.max(of_smooth(sample, known, tuning));
    let is_clear = divided.log_evidence(tuning) > of_rival + tuning.clearly;
    is_clear.then(|| RatedThings {
        things: divided.things.iter().map(|thing| Thing::of(&thing.mode)).collect(),
        log_evidence: divided.with_departures(tuning),
    })
}

fn likeliest_division(sample: &BodySample, known: &[Mode], tuning: &Tuning) -> Option<Division> {
    let parallel = known.iter().flat_map(|found| on_either_side(&found.primitive, sample, tuning));
    let beside: Vec<Candidate> = parallel.map(|start| Candidate::new(start, FalseContacts::Some, tuning)).collect();
    let sheets = threads::map(beside.len(), 1, |k| mode(&beside[k], sample, tuning));
    let sheets: Vec<Mode> = sheets.into_iter().flatten().collect();
    let few = minorities(sample, tuning);
    let firsts = first_things(known.iter().chain(&sheets).chain(&few), sample, tuning);
    let mut begun: Vec<((f64, &Mode), NextThing)> =
        firsts.iter().map(|first| (*first, likeliest_thing as NextThing)).collect();
    // places alone lie in planes to the last digit that are none: two straight lines of a saddle do
    let is_told_by_normals = sample.known_normals() == sample.len();
    let nearest = || firsts.iter().min_by(|a, b| a.1.sd[0].total_cmp(&b.1.sd[0]));
    begun.extend(is_told_by_normals.then(nearest).flatten().map(|first| (*first, nearest_thing as NextThing)));
    let divided = threads::map(begun.len(), 1, |k| Division::beginning_with(begun[k].0, begun[k].1, sample, tuning));
    let log = |found: &Division| found.log_evidence(tuning);
    let divided: Vec<Division> = divided.into_iter().flatten().collect();
    let most = divided.iter().map(log).fold(f64::NEG_INFINITY, f64::max);
    // of those that are as good the simplest
    let as_good = divided.into_iter().filter(|found| log(found) > most - tuning.clearly);
    let of_first = |found: &Division| unknowns(&found.things[0].mode);
    as_good.min_by(|a, b| of_first(a).cmp(&of_first(b)).then(log(b).total_cmp(&log(a))))
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
    firsts.dedup_by(|a, b| a.1.primitive.kind == b.1.primitive.kind && (a.0 - b.0).abs() < SAME);
    let farther = firsts.split_off(firsts.len().min(tuning.firsts));
    let scatter = firsts.iter().map(|(_, first)| first.sd[0]).fold(f64::INFINITY, f64::min);
    let nearer = |kind: PartKind| {
        let mut own = farther.iter().filter(move |(_, m)| m.primitive.kind == kind);
        own.find(|(_, m)| m.sd[0] < tuning.sharper * scatter).copied()
    };
    firsts.extend(SIMPLE.into_iter().filter_map(nearer));
    firsts
}

/// Difference of log evidence below which two modes of a kind are one.
const SAME: f64 = 1e-3;

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
fn likeliest_thing(among: BodySample, tuning: &Tuning) -> Option<(f64, FoundThing)> {
    let rest = &among;
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
    let mode = chosen.clone();
    Some((gain, FoundThing { mode, among }))
}

/// Of the primitives that are clearly likelier than chance those that lie nearest to their own contacts, and the likeliest of these: the four
/// faces about a box's axis are followed by a bar, which holds more contacts than any face and gains more than the next two.
fn nearest_thing(among: BodySample, tuning: &Tuning) -> Option<(f64, FoundThing)> {
    if !may_hold_a_thing(&among, tuning) {
        return None;
    }
    let found = all_modes(&among, tuning);
    let rated: Vec<(f64, &Mode)> =
        with_gains(&found, &among, tuning).into_iter().filter(|(gain, _)| *gain > tuning.clearly).collect();
    let scatter = rated.iter().map(|(_, m)| m.sd[0]).fold(f64::INFINITY, f64::min);
    let near = rated.into_iter().filter(|(_, m)| tuning.sharper * m.sd[0] <= scatter);
    let (gain, mode) = near.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(gain, m)| (gain, m.clone()))?;
    Some((gain, FoundThing { mode, among }))
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

/// What departures add to the log evidence of one thing: those by which it is still what it is called. A ring or an ellipsoid that departs
/// follows any smooth surface.
fn of_departures(found: &FoundThing, tuning: &Tuning) -> f64 {
    // what has few contacts beside its unknowns shows no scatter by which a departure would be rated
    let is_rated = found.mode.members().len() >= 2 * unknowns(&found.mode);
    if !is_simple(found.mode.primitive.kind) || !is_rated {
        return 0.0;
    }
    let thing = LinearisedBase::new(&found.mode, &found.among, tuning).beside_others(tuning).departing(tuning);
    let Some(exact) = thing.without_departure(tuning) else { return 0.0 };
    let is_thing = |node: &BodyHypothesis| node.slope() <= tuning.largest_slope && thing.is_linear(node, tuning);
    let nodes = thing.nodes(0, tuning).into_iter().filter(is_thing);
    nodes.map(|node| node.log_evidence - exact).fold(0.0, f64::max)
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
