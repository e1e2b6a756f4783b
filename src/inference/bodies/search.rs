//! The likeliest mode of every kind of primitive, from all starts.

use super::candidates::{candidates, of_minorities, on_either_side};
use super::evidence::LinearisedBase;
use super::mode::{Candidate, FalseContacts, Mode, mode};
use super::sample::BodySample;
use super::tuning::Tuning;

/// The likeliest modes of every kind over all contacts, without false contacts, with some, and where most contacts are left
/// out: which of these the contacts are is a matter of the evidence.
pub(super) fn modes(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
    let few = sample.at_most(tuning.searched);
    let mut best: Vec<Mode> = Vec::new();
    for candidate in candidates(&few, tuning) {
        keep_better(&mut best, &candidate, &few, tuning);
    }
    for found in best.clone() {
        for start in on_either_side(&found.primitive, &few, tuning) {
            keep_better(&mut best, &Candidate::new(start, FalseContacts::Some, tuning), &few, tuning);
        }
    }
    if few.len() == sample.len() {
        return best;
    }
    with_a_chance(&best, &few, tuning)
        .filter_map(|found| mode(&Candidate::again(found, tuning), sample, tuning))
        .filter(|found| found.primitive.is_sound(tuning.extent))
        .collect()
}

/// Modes that hold a minority of the contacts: each may be one thing of several.
pub(super) fn minorities(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
    let few = sample.at_most(tuning.searched);
    let followed = |candidate: Candidate| {
        let found = mode(&candidate, &few, tuning)?;
        let found =
            if few.len() < sample.len() { mode(&Candidate::again(&found, tuning), sample, tuning)? } else { found };
        Some(found).filter(|found| found.primitive.is_sound(tuning.extent) && !found.others().is_empty())
    };
    of_minorities(&few, tuning).into_iter().filter_map(followed).collect()
}

/// Those whose rough evidence over a part of the contacts is not hopeless, and those that leave contacts out: they may be one thing of
/// several.
fn with_a_chance<'a>(modes: &'a [Mode], few: &BodySample, tuning: &Tuning) -> impl Iterator<Item = &'a Mode> {
    let rough = |found: &Mode| LinearisedBase::new(found, few, tuning).departing(tuning).rough(tuning);
    let rated: Vec<(f64, &Mode)> = modes.iter().map(|found| (rough(found), found)).collect();
    let likeliest = rated.iter().map(|(rough, _)| *rough).fold(f64::NEG_INFINITY, f64::max);
    let has_chance =
        move |(rough, found): &(f64, &Mode)| *rough > likeliest - tuning.hopeless[0] || !found.others().is_empty();
    rated.into_iter().filter(has_chance).map(|(_, found)| found).collect::<Vec<&Mode>>().into_iter()
}

/// Follows a start, and keeps its mode where it is likelier than the one of its kind.
fn keep_better(best: &mut Vec<Mode>, candidate: &Candidate, few: &BodySample, tuning: &Tuning) {
    let Candidate { start, strays, .. } = *candidate;
    if few.len() + 2 * few.known_normals() <= start.kind.free().len() {
        return;
    }
    let found = mode(candidate, few, tuning).filter(|found| found.primitive.is_sound(tuning.extent));
    let Some(found) = found else { return };
    let most = found.holds_most(tuning);
    let is_rival = |known: &&mut Mode| {
        known.primitive.kind == found.primitive.kind && known.strays == strays && known.holds_most(tuning) == most
    };
    match best.iter_mut().find(is_rival) {
        Some(known) if known.likelihood >= found.likelihood => {}
        Some(known) => *known = found,
        None => best.push(found),
    }
}
