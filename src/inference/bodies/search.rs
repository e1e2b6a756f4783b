//! The likeliest mode of every kind of primitive, from all starts.

use super::candidates::{Candidate, candidates, on_either_side};
use super::mode::{FalseContacts, Mode, mode};
use super::sample::BodySample;
use super::tuning::Tuning;

/// Contacts among which modes are searched; the best of every kind is then followed over all.
const SEARCHED: usize = 400;

/// Extent of contacts in units of their own size, by which a primitive is told from a simpler one.
pub(super) const EXTENT: f64 = 3.0;

/// The likeliest modes of every kind over all contacts, without false contacts, with some, and where most contacts are left
/// out: which of these the contacts are is a matter of the evidence.
pub(super) fn modes(sample: &BodySample, tuning: &Tuning) -> Vec<Mode> {
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
fn keep_better(best: &mut Vec<Mode>, Candidate { start, strays }: Candidate, few: &BodySample, tuning: &Tuning) {
    if few.len() + 2 * few.known_normals() <= start.kind.free().len() {
        return;
    }
    let found = mode(&start, few, strays, tuning).filter(|found| found.primitive.is_sound(EXTENT));
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
