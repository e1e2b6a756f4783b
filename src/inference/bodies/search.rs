//! The likeliest mode of every kind of primitive, from all starts.
//!
//! What one division among several things leaves out, another leaves out as well: what was found there is kept.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::candidates::{candidates, of_minorities, on_either_side};
use super::evidence::LinearisedBase;
use super::mode::{Candidate, Mode, mode};
use super::sample::BodySample;
use super::tuning::Tuning;
use palpate_numeric::threads;

/// Modes that were found among some contacts, by these.
type FoundModes = Mutex<HashMap<Vec<u64>, Arc<Vec<Mode>>>>;

/// A search of modes among parts of the same contacts, which looks at each part once.
pub(crate) struct ModeSearch<'a> {
    pub(super) tuning: &'a Tuning,
    over_most: FoundModes,
    of_minorities: FoundModes,
}

impl<'a> ModeSearch<'a> {
    pub(crate) fn new(tuning: &'a Tuning) -> ModeSearch<'a> {
        ModeSearch { tuning, over_most: FoundModes::default(), of_minorities: FoundModes::default() }
    }

    /// [`modes`], once.
    pub(super) fn modes(&self, sample: &BodySample) -> Arc<Vec<Mode>> {
        once(&self.over_most, sample, || modes(sample, self.tuning))
    }

    /// [`minorities`], once.
    pub(super) fn minorities(&self, sample: &BodySample) -> Arc<Vec<Mode>> {
        once(&self.of_minorities, sample, || minorities(sample, self.tuning))
    }
}

/// What is known of these contacts, or is then found.
fn once(known: &FoundModes, sample: &BodySample, find: impl FnOnce() -> Vec<Mode>) -> Arc<Vec<Mode>> {
    let numbers = sample.points.iter().chain(&sample.normals).flatten();
    let contacts: Vec<u64> = numbers.map(|number| number.to_bits()).collect();
    // what a thread that has failed has kept is whole
    let open = || known.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = open().get(&contacts) {
        return Arc::clone(found);
    }
    // another thread may find the same at the same time
    let found = Arc::new(find());
    open().insert(contacts, Arc::clone(&found));
    found
}

/// The likeliest modes of every kind over all contacts, without false contacts, with some, and where most contacts are left
/// out: which of these the contacts are is a matter of the evidence.
pub(super) fn modes(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
    let few = sample.at_most(tuning.searched);
    let mut best: Vec<Mode> = Vec::new();
    keep_better(&mut best, &candidates(&few, tuning), &few, tuning);
    let beside: Vec<Candidate> = best.iter().flat_map(|found| on_either_side(&found.primitive, &few, tuning)).collect();
    keep_better(&mut best, &beside, &few, tuning);
    if few.len() == sample.len() {
        return best;
    }
    let again: Vec<Candidate> =
        with_a_chance(&best, &few, tuning).into_iter().map(|found| Candidate::again(found, tuning)).collect();
    followed(&again, sample, tuning).into_iter().flatten().collect()
}

/// Modes that hold a minority of the contacts: each may be one thing of several.
fn minorities(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
    let few = sample.at_most(tuning.searched);
    let candidates = of_minorities(&few, tuning);
    let follow = |k: usize| {
        let found = mode(&candidates[k], &few, tuning)?;
        let found =
            if few.len() < sample.len() { mode(&Candidate::again(&found, tuning), sample, tuning)? } else { found };
        Some(found).filter(|found| found.primitive.is_sound(tuning.extent) && !found.others().is_empty())
    };
    threads::map(candidates.len(), 1, follow).into_iter().flatten().collect()
}

/// The sound modes to which candidates lead.
fn followed(candidates: &[Candidate], sample: &BodySample, tuning: &Tuning) -> Vec<Option<Mode>> {
    let is_told = |start: &Candidate| sample.len() + 2 * sample.known_normals() > start.start.kind.free().len();
    let follow = |k: usize| {
        let found = is_told(&candidates[k]).then(|| mode(&candidates[k], sample, tuning))??;
        Some(found).filter(|found| found.primitive.is_sound(tuning.extent))
    };
    threads::map(candidates.len(), 1, follow)
}

/// Those whose rough evidence over a part of the contacts is not hopeless, and those that leave contacts out: they may be one thing of
/// several.
fn with_a_chance<'a>(modes: &'a [Mode], few: &BodySample, tuning: &Tuning) -> Vec<&'a Mode> {
    let rough = |found: &Mode| LinearisedBase::new(found, few, tuning).departing(tuning).rough(tuning);
    let rated: Vec<(f64, &Mode)> = modes.iter().map(|found| (rough(found), found)).collect();
    let likeliest = rated.iter().map(|(rough, _)| *rough).fold(f64::NEG_INFINITY, f64::max);
    let has_chance =
        move |(rough, found): &(f64, &Mode)| *rough > likeliest - tuning.hopeless[0] || !found.others().is_empty();
    rated.into_iter().filter(has_chance).map(|(_, found)| found).collect()
}

/// Follows starts, one after another keeping the mode of each where it is likelier than the one of its kind.
fn keep_better(best: &mut Vec<Mode>, candidates: &[Candidate], few: &BodySample, tuning: &Tuning) {
    for (found, candidate) in followed(candidates, few, tuning).into_iter().zip(candidates) {
        let Some(found) = found else { continue };
        let most = found.holds_most(tuning);
        let is_rival = |known: &&mut Mode| {
            known.primitive.kind == found.primitive.kind
                && known.strays == candidate.strays
                && known.holds_most(tuning) == most
        };
        match best.iter_mut().find(is_rival) {
            Some(known) if known.likelihood >= found.likelihood => {}
            Some(known) => *known = found,
            None => best.push(found),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::Rounding;

    #[test]
    fn the_same_contacts_are_looked_at_once_and_others_by_themselves() {
        let tuning = Tuning::default();
        let of = |k: usize| (0.7 * k as f64).sin_cos();
        let points: Vec<[f64; 3]> = (0..12).map(|k| [of(k).0, of(k).1, 0.1 * k as f64]).collect();
        let sample = BodySample::new(&points, &[], Rounding::NONE).unwrap();
        let search = ModeSearch::new(&tuning);
        let found = search.modes(&sample);
        assert!(!found.is_empty() && Arc::ptr_eq(&found, &search.modes(&sample.clone())));
        let fewer = sample.only(&(0..11).collect::<Vec<usize>>());
        assert!(search.modes(&fewer).iter().all(|mode| mode.weights.len() == 11));
    }
}
