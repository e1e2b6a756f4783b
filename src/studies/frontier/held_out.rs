//! A frontier of measured contacts, whose truth nobody knows: every fit is judged by contacts that it has not seen.
//!
//! ```text
//! contacts, shuffled, in K parts:   fit all parts but k, over the domain of all    judge heights and normals of part k
//! ```
//!
//! The noise of the unseen contacts is part of every error: the least one is about the noise itself, and configurations are
//! told apart by what stands above it.

use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::draws::Lcg;
use palpate_numeric::threads;

use super::FrontierError;
use super::clock::{Call, Heard, Limits, Watch, clocked, heard_rounds};
use super::configuration::{Configuration, candidates};
use super::discretisation::Measured;
use super::errors::errors_of;
use super::ledger::{Ledger, LedgerLine};
use super::memory;
use super::pareto;
use super::point::Point;
use super::scoring::{Answer, call, judge_contacts};

/// Parts: a fit sees four fifths of the contacts.
const PARTS: usize = 5;
/// Fewer contacts leave too few in a part to tell an error from its noise.
const LEAST_CONTACTS: usize = 30;
/// Rounds: every part is judged in the first of them.
const LIMITS: Limits = Limits { least: 4, most: 30, seconds: 30.0, each: 0.5 };
/// Place of the height among the judged quantities.
const HEIGHT: usize = 3;

/// Contacts and the ways of fitting them, ready to be measured.
#[derive(Debug)]
pub struct HeldOut {
    parts: Vec<(Contacts, Contacts)>,
    ways: Vec<Configuration>,
}

impl HeldOut {
    /// The ways of fitting these contacts.
    ///
    /// # Errors
    /// [`FrontierError::TooFew`].
    pub fn new(contacts: &Contacts, own: &FitOptions) -> Result<HeldOut, FrontierError> {
        if contacts.len() < LEAST_CONTACTS {
            return Err(FrontierError::TooFew { contacts: contacts.len(), needed: LEAST_CONTACTS });
        }
        Ok(HeldOut { parts: parts(contacts), ways: ways(contacts, own) })
    }

    /// Where what is measured is entered.
    pub fn ledger(&self) -> Ledger {
        Ledger::new(self.ways.len())
    }

    /// Ways of fitting that are to be measured.
    pub fn ways(&self) -> usize {
        self.ways.len()
    }

    /// Measures on one thread, in about so many seconds, and enters what every call came to.
    pub fn measure_into(&self, ledger: &Ledger, seconds: f64, watch: Watch<'_>) {
        threads::alone(|| self.measure_here(ledger, Limits { seconds, ..LIMITS }, watch));
    }

    fn measure_here(&self, ledger: &Ledger, limits: Limits, watch: Watch<'_>) {
        let parts = &self.parts;
        let mut calls: Vec<Call<'_, Answer>> = Vec::new();
        for way in &self.ways {
            calls.push(Box::new(move |number| call(&parts[number as usize % parts.len()].0, &way.options, false)));
        }
        heard_rounds(&mut calls, limits, watch, |k, heard| {
            let (number, answer) = match heard {
                Heard::Answer(number, answer) => (number, answer),
                Heard::Time(seconds) => return ledger.enter(k, |entry| entry.times[0].push(seconds)),
            };
            let Some((seen, unseen)) = parts.get(number as usize) else { return };
            let judged = judge_contacts(&answer, unseen);
            let memory = answer.as_ref().ok().filter(|_| number == 0).map(|found| memory::bytes(found, seen.len()));
            ledger.enter(k, |entry| {
                entry.judged.push(judged);
                entry.memory = entry.memory.or(memory);
            });
        });
    }

    /// The ways that were measured, by what the ledger holds of them.
    pub fn measured(&self, ledger: &Ledger) -> Vec<Measured> {
        let entries = ledger.entries();
        let reached = self.ways.iter().zip(&entries).filter(|(_, entry)| entry.is_measured(1));
        let contacts = self.parts.first().map_or(0, |(seen, _)| seen.len());
        let mut measured: Vec<Measured> = reached
            .map(|(way, entry)| Measured {
                configuration: way.clone(),
                point: point(way, entry, contacts),
                runs: Vec::new(),
            })
            .collect();
        let mut points: Vec<&mut Point> = measured.iter_mut().map(|measured| &mut measured.point).collect();
        pareto::mark(&mut points);
        measured
    }
}

fn point(way: &Configuration, entry: &LedgerLine, contacts: usize) -> Point {
    let judged = &entry.judged;
    let errors: [_; 6] = std::array::from_fn(|q| errors_of(judged, q));
    let failed = judged.iter().find_map(|judged| judged.failed.clone());
    Point {
        label: way.label(),
        method: way.options.method.name().into(),
        surface: way.options.surface.name(),
        weights: way.weights(),
        degree: way.options.degree,
        segments: way.options.segments,
        contacts,
        error: errors[HEIGHT].filter(|_| failed.is_none()).map(|errors| errors.rms),
        error_interval: errors[HEIGHT].filter(|_| failed.is_none()).map(|errors| errors.interval),
        errors,
        seconds: Some(clocked(&entry.times[0])),
        memory: entry.memory.filter(|_| failed.is_none()),
        replicates: judged.len() as u64,
        support: judged.first().map(|judged| judged.support),
        failed,
        ..Point::default()
    }
}

/// What is fitted and what is left out, part by part.
fn parts(contacts: &Contacts) -> Vec<(Contacts, Contacts)> {
    let mut order: Vec<u32> = (0..contacts.len() as u32).collect();
    let mut draws = Lcg::new(contacts.len() as u64);
    for k in (1..order.len()).rev() {
        let other = ((draws.uniform() * (k + 1) as f64) as usize).min(k);
        order.swap(k, other);
    }
    let of = |part: usize, own: bool| -> Contacts {
        let chosen = order.iter().enumerate().filter(|(place, _)| (place % PARTS == part) == own);
        contacts.in_order(&chosen.map(|(_, number)| *number).collect::<Vec<u32>>())
    };
    (0..PARTS).map(|part| (of(part, false), of(part, true))).collect()
}

/// The candidates that these contacts allow: normals for normal rows, something to turn for weights.
fn ways(contacts: &Contacts, own: &FitOptions) -> Vec<Configuration> {
    let extent =
        |values: &[f64]| values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(*v), hi.max(*v)]);
    let ([x0, x1], [y0, y1]) = (extent(&contacts.x), extent(&contacts.y));
    let objective = match contacts.orientation {
        Orientation::Normals { .. } => Objective::Normals(NormalSigma::Auto),
        Orientation::Slopes { .. } => Objective::Slopes(SlopeWeights::Auto),
        Orientation::None => Objective::Auto,
    };
    let own = FitOptions { domain: Some([x0, x1, y0, y1]), objective, ..own.clone() };
    let normals = matches!(contacts.orientation, Orientation::Normals { .. });
    let fits = |way: &Configuration| match contacts.orientation {
        // heights alone leave nothing to weigh
        Orientation::None => way.options.objective == Objective::Auto,
        _ => true,
    };
    candidates(&own, &[None], normals).into_iter().filter(fits).collect()
}
