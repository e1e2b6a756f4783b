//! Contacts divided among things, each found in what those before it leave out.
//!
//! ```text
//! ln p(two things) = ln p(first, others false) - ln p(others false) + ln p(second of the others)
//! ln p = ln((p(each scatters by itself) + p(all scatter alike)) / 2)                        `one_sensor`
//! ```

use super::body_hypothesis::BodyHypothesis;
use super::candidates::spans;
use super::evidence::LinearisedBase;
use super::faces::FlatFace;
use super::mode::{Mode, fewest, log_false};
use super::one_sensor::of_one_sensor;
use super::sample::BodySample;
use super::search::ModeSearch;
use super::tuning::Tuning;
use crate::primitives::placed::{PartKind, Primitive};
use palpate_numeric::statistics::log_mean_exp;
use palpate_numeric::threads;
use palpate_numeric::vector::axes_along;

/// One of several things among the contacts that no thing before it holds.
#[derive(Clone)]
pub(super) struct FoundThing {
    pub(super) mode: Mode,
    pub(super) among: BodySample,
}

impl FoundThing {
    pub(super) fn left(&self) -> BodySample {
        self.among.only(&self.mode.others())
    }
}

/// Things, each found in what those before it leave out.
pub(super) struct Division {
    pub(super) things: Vec<FoundThing>,
    /// So many of them, the first ones, are what the contacts are; contacts of no thing are false.
    pub(super) counted: usize,
    /// Where each scatters by itself, or all alike.
    pub(super) log_evidence: f64,
}

/// How the next thing is found in what others leave out.
pub(super) type NextThing = fn(BodySample, &ModeSearch) -> Option<(f64, FoundThing)>;

impl Division {
    /// Two things, and further ones in what both leave out.
    pub(super) fn beginning_with(
        (of_first, first): (f64, &Mode),
        next_thing: NextThing,
        sample: &BodySample,
        search: &ModeSearch,
    ) -> Option<Division> {
        let tuning = search.tuning;
        let first = FoundThing { mode: first.clone(), among: sample.clone() };
        let (gain, second) = next_thing(first.left(), search)?;
        let mut rest = second.left();
        let mut gains = vec![of_first, gain];
        let mut things = vec![first, second];
        while things.len() < tuning.most_things {
            let Some((gain, next)) = next_thing(rest, search).filter(|(gain, _)| *gain > tuning.clearly) else { break };
            rest = next.left();
            gains.push(gain);
            things.push(next);
        }
        Some(Division::rated(things, &gains, tuning))
    }

    /// Things with their gains, and the planes of some faces of what these leave out, each in what those before it leave out.
    pub(super) fn of_faces(
        begun: &[(f64, FoundThing)],
        faces: &[FlatFace],
        sample: &BodySample,
        tuning: &Tuning,
    ) -> Option<Division> {
        let arm = tuning.log_ratio[0].exp();
        let mut left: Vec<usize> = (0..sample.len()).collect();
        let (mut gains, mut things): (Vec<f64>, Vec<FoundThing>) = begun.iter().cloned().unzip();
        for face in faces.iter().filter(|face| face.members.len() > 1) {
            let among = sample.only(&left);
            let own: Vec<usize> = (0..left.len()).filter(|i| face.members.contains(&left[*i])).collect();
            let (origin, across) = face.plane(arm);
            let start =
                Primitive { kind: PartKind::Plane, origin, axes: axes_along(across), sizes: [0.0; 3], side: 1.0 };
            let mode = Mode::of_members(&start, &own, &among, tuning)?;
            let by_chance = if things.is_empty() { 0.0 } else { of_chance(&among, tuning) };
            gains.push(of_one_thing(&mode, &among, tuning).unwrap_or(f64::NEG_INFINITY) - by_chance);
            left.retain(|i| !face.members.contains(i));
            things.push(FoundThing { mode, among });
        }
        (things.len() > 1 && are_no_rows(&things, tuning)).then(|| Division::rated(things, &gains, tuning))
    }

    /// Things by what each gains.
    fn rated(things: Vec<FoundThing>, gains: &[f64], tuning: &Tuning) -> Division {
        let counted = if hold_all(&things, tuning) { things.len() } else { 2 };
        let apart: f64 = gains[..counted].iter().sum();
        let linearised: Vec<LinearisedBase> = things[..counted]
            .iter()
            .map(|thing| LinearisedBase::new(&thing.mode, &thing.among, tuning).beside_others(tuning))
            .collect();
        let by_chance: f64 = things[1..counted].iter().map(|thing| of_chance(&thing.among, tuning)).sum();
        let alike = of_one_sensor(&linearised, tuning).map_or(f64::NEG_INFINITY, |log| log - by_chance);
        Division { things, counted, log_evidence: log_mean_exp(apart, alike) }
    }

    /// How many things of every kind are counted.
    pub(super) fn kinds(&self) -> [usize; 6] {
        let of_kind =
            |kind| self.things[..self.counted].iter().filter(|thing| thing.mode.primitive.kind == kind).count();
        PartKind::BODIES.map(of_kind)
    }

    /// The same where each departs.
    pub(super) fn with_departures(&self, tuning: &Tuning) -> f64 {
        let departed = threads::map(self.counted, 1, |k| of_departures(&self.things[k], tuning));
        self.log_evidence + departed.iter().sum::<f64>()
    }
}

/// Whether most contacts of things belong to those that are no rows: fingers along a bar leave rows alone, each in a plane of its own, and the
/// narrow side of a plate is one beside its wide ones.
fn are_no_rows(things: &[FoundThing], tuning: &Tuning) -> bool {
    let counts = |thing: &FoundThing| {
        let own = thing.mode.members();
        [own.len(), if spans(&thing.among.only(&own), tuning) { own.len() } else { 0 }]
    };
    let [all, beside_lines] = things.iter().map(counts).fold([0, 0], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    2 * beside_lines > all
}

/// Whether things hold the contacts but for a few, or for fewer than a thing has: else further ones are what is near the first two.
fn hold_all(things: &[FoundThing], tuning: &Tuning) -> bool {
    let all = &things[0].among;
    let held = things.iter().map(|thing| thing.mode.members().len()).sum::<usize>();
    held as f64 >= tuning.things_hold * all.len() as f64 || all.len() - held < fewest(all, tuning)
}

/// Log evidence of one thing, the others being false.
pub(super) fn of_one_thing(mode: &Mode, sample: &BodySample, tuning: &Tuning) -> Option<f64> {
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

/// Log probability that all contacts are false.
pub(super) fn of_chance(rest: &BodySample, tuning: &Tuning) -> f64 {
    (0..rest.len()).map(|i| log_false(tuning, rest.normal(i).is_some())).sum()
}

/// Kinds that do not follow two things at once.
pub(super) const SIMPLE: [PartKind; 4] = [PartKind::Plane, PartKind::Sphere, PartKind::Cylinder, PartKind::Cone];

/// Whether a kind does not follow two things at once, nor whatever smooth surface there is.
pub(crate) fn is_simple(kind: PartKind) -> bool {
    SIMPLE.contains(&kind)
}

pub(super) fn unknowns(mode: &Mode) -> usize {
    mode.primitive.kind.free().len()
}
