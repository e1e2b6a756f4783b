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

/// Contacts that a thing has at least.
const FEWEST_OF_A_THING: usize = 6;

/// Share of the contacts left out that lie on the second.
const MOST_OF_THEM: f64 = 0.5;

/// Log evidence by which two things must be ahead of one.
const CLEARLY: f64 = 10.0;

/// Spread across a line over that along it, below which contacts are one row: a row lies on many surfaces and is no thing.
const ROW: f64 = 0.05;

/// Whether contacts lie beside a line.
fn spans(sample: &BodySample) -> bool {
    let [_, across, along] = principal(sample).2;
    across > ROW * ROW * along
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
    let rated = known.iter().chain(&sheets).filter_map(|first| split(sample, first, tuning));
    let (log, things) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (log > of_one + CLEARLY).then_some(things)
}

/// The first thing with the likeliest second one, and the log evidence of both.
fn split(sample: &BodySample, first: &Mode, tuning: &Tuning) -> Option<(f64, [Thing; 2])> {
    let rest: Vec<usize> = (0..sample.len()).filter(|i| first.weights[*i] <= 0.5).collect();
    let enough = (tuning.other_things * sample.len() as f64).max(FEWEST_OF_A_THING as f64);
    let own = sample.len() - rest.len();
    if (rest.len() as f64) < enough || (own as f64) < enough {
        return None;
    }
    let others = sample.only(&rest);
    if !spans(&sample.only(&first.members())) || !spans(&others) {
        return None;
    }
    let of_first = LinearisedBase::new(first, sample, tuning).without_departure(tuning)?;
    let found = modes(&others, tuning);
    let rated =
        found.iter().filter_map(|m| Some((LinearisedBase::new(m, &others, tuning).without_departure(tuning)?, m)));
    let (of_second, second) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let contacts = second.members().len();
    if (contacts as f64) < enough.max(MOST_OF_THEM * rest.len() as f64) {
        return None;
    }
    let by_chance: f64 = (0..others.len()).map(|i| log_false(tuning, others.normal(i).is_some())).sum();
    let things = [
        Thing { primitive: first.primitive, contacts: own, scatter: first.sd[0] },
        Thing { primitive: second.primitive, contacts, scatter: second.sd[0] },
    ];
    Some((of_first - by_chance + of_second, things))
}
