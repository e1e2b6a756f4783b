//! Whether contacts are two things: a second sheet, a wall behind a ball, the end of a bar.
//!
//! ```text
//! first    a primitive with the contacts that are its own; what it leaves out would be false
//! second   a primitive of the contacts left out
//! ln p(two things) = ln p(first, others false) - ln p(others false) + ln p(second of the others)
//! ```
//!
//! That sum is compared with the evidence of the best single primitive, however large its departure and its scatter.

use super::candidates::{on_either_side, principal};
use super::evidence::LinearisedBase;
use super::mode::{FalseContacts, Mode, log_false, mode};
use super::sample::BodySample;
use super::search::modes;
use super::tuning::Tuning;
use crate::primitives::placed::Primitive;

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

/// The two things that explain the contacts clearly better than one, whose log evidence is given.
pub(super) fn two_things(sample: &BodySample, known: &[Mode], of_one: f64, tuning: &Tuning) -> Option<[Thing; 2]> {
    let parallel = known.iter().flat_map(|found| on_either_side(&found.primitive, sample, tuning));
    let sheets: Vec<Mode> = parallel.filter_map(|start| mode(&start, sample, FalseContacts::Some, tuning)).collect();
    let with_evidence = |first| Some((LinearisedBase::new(first, sample, tuning).without_departure(tuning)?, first));
    let mut firsts: Vec<(f64, &Mode)> = known.iter().chain(&sheets).filter_map(with_evidence).collect();
    firsts.retain(|(_, first)| leaves_enough(sample, first, tuning));
    firsts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let rated = firsts.into_iter().take(tuning.firsts).filter_map(|(log, first)| split(sample, first, log, tuning));
    let (log, things) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (log > of_one + tuning.clearly).then_some(things)
}

/// Whether the first thing has contacts enough, leaves enough, and neither are one row.
fn leaves_enough(sample: &BodySample, first: &Mode, tuning: &Tuning) -> bool {
    let own = first.members();
    let least = ((tuning.other_things * sample.len() as f64).ceil() as usize).max(tuning.thing_contacts);
    let counts = own.len() >= least && sample.len() - own.len() >= least;
    counts && spans(&sample.only(&own), tuning) && spans(&sample.only(&first.others()), tuning)
}

/// The first thing with the likeliest second one, and the log evidence of both.
fn split(sample: &BodySample, first: &Mode, of_first: f64, tuning: &Tuning) -> Option<(f64, [Thing; 2])> {
    let others = sample.only(&first.others());
    let found = modes(&others, tuning);
    let rated =
        found.iter().filter_map(|m| Some((LinearisedBase::new(m, &others, tuning).without_departure(tuning)?, m)));
    let (of_second, second) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let contacts = second.members().len();
    if contacts < tuning.thing_contacts || (contacts as f64) < tuning.second_share * others.len() as f64 {
        return None;
    }
    let by_chance: f64 = (0..others.len()).map(|i| log_false(tuning, others.normal(i).is_some())).sum();
    let things = [
        Thing { primitive: first.primitive, contacts: first.members().len(), scatter: first.sd[0] },
        Thing { primitive: second.primitive, contacts, scatter: second.sd[0] },
    ];
    Some((of_first - by_chance + of_second, things))
}
