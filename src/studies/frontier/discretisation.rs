//! The first frontier: degree, segments, stations, weights and kind of surface, each timed and judged on the same calls.
//!
//! ```text
//! for every candidate, round after round:   contacts of replicate b -> fit, S, R [-> intervals]   timed
//!                                           the same answer against the truth                     judged
//! then, for the few that the answer is chosen from:   the same on the replicates that they have not met
//! ```

use std::time::Instant;

use palpate_fitting::fit::FitOptions;
use palpate_numeric::threads;
use palpate_world::scene::World;

use super::FrontierError;
use super::clock::{Call, Heard, Limits, Watch, clocked, heard_rounds};
use super::configuration::{Configuration, candidates};
use super::contenders::contenders;
use super::errors::{Judged, QUANTITIES, errors_of, share};
use super::found_surface::TimedAnswer;
use super::ledger::Ledger;
use super::measured::Measured;
use super::memory;
use super::pareto;
use super::point::Point;
use super::preference::share_quickest;
use super::replicates::{REPLICATES, Touches, stations};
use super::request::Request;
use super::scoring::{call, judge};
use super::shortlist::shortlist;

/// Rounds at least and at most: three calls a round make 120 of a short call, so that every replicate is judged.
const LEAST_ROUNDS: usize = 5;
const MOST_ROUNDS: usize = 40;
/// Seconds for each of the two calls of a candidate: what takes tens of milliseconds needs fewer repeats.
const EACH: f64 = 1.5;
/// And at least, where the whole time is little.
const LEAST_EACH: f64 = 0.01;
/// Share of the time for one call: a few that are slow take no more than half of it.
const SHARE_OF_EACH: f64 = 0.05;
/// Share of the time in which all candidates are measured; the rest is for those that the answer is chosen from.
const FOR_ALL: f64 = 0.7;

/// A scene with its candidates, ready to be measured.
#[derive(Debug)]
pub struct Subject {
    touches: Vec<Touches>,
    candidates: Vec<Configuration>,
    /// True mean R over the touched points: the unit of errors of R beside those of S.
    curvedness: f64,
    /// Whether S and R are defined somewhere.
    defined: [bool; 2],
    /// Whether calls with intervals are timed besides those without.
    intervals: bool,
    /// What the answer is for.
    request: Option<Request>,
}

impl Subject {
    /// The candidates of a scene; `vary` tries other numbers of stations too.
    ///
    /// # Errors
    /// A scene that cannot be simulated.
    pub(crate) fn new(world: &World, own: &FitOptions, seed: u64, vary: bool) -> Result<Subject, FrontierError> {
        Subject::with_replicates(world, own, seed, vary, REPLICATES)
    }

    /// The same with at most so many replicates.
    ///
    /// # Errors
    /// A scene that cannot be simulated.
    pub fn with_replicates(
        world: &World,
        own: &FitOptions,
        seed: u64,
        vary: bool,
        most: u64,
    ) -> Result<Subject, FrontierError> {
        let counts = if vary { stations(world) } else { vec![None] };
        let touches: Result<Vec<Touches>, _> = counts.iter().map(|n| Touches::new(world, *n, seed, most)).collect();
        Subject::of(touches?, own)
    }

    fn of(touches: Vec<Touches>, own: &FitOptions) -> Result<Subject, FrontierError> {
        let counts: Vec<Option<usize>> = touches.iter().map(|touches| touches.stations).collect();
        let candidates = candidates(own, &counts, true, touches.first().map_or(0, Touches::contacts));
        let truth = touches.first().and_then(|touches| touches.replicates.first()).map(|(_, truth)| truth);
        let points = truth.map_or(0, |truth| truth.points.len());
        let curvedness =
            truth.map_or(0.0, |truth| (0..points).map(|r| truth.curvedness(r)).sum::<f64>() / points.max(1) as f64);
        let has_index = truth.is_some_and(|truth| (0..points).any(|r| truth.shape_index(r).is_some()));
        Ok(Subject {
            touches,
            candidates,
            curvedness,
            defined: [has_index, points > 0],
            intervals: true,
            request: None,
        })
    }

    /// Whether S and R are defined somewhere on the true surface.
    pub(crate) fn defined(&self) -> [bool; 2] {
        self.defined
    }

    /// The same without calls that compute intervals.
    pub fn bare(self) -> Subject {
        Subject { intervals: false, ..self }
    }

    /// The same, with more replicates for the candidates that may answer this.
    pub fn asked(self, request: Option<&Request>) -> Subject {
        Subject { request: request.cloned(), ..self }
    }

    /// Calls of each candidate.
    pub fn calls_each(&self) -> usize {
        if self.intervals { 2 } else { 1 }
    }

    /// Every call of the frontier: without and with intervals, candidate by candidate.
    pub fn calls(&self) -> Vec<Call<'_, TimedAnswer>> {
        let kinds = &[false, true][..self.calls_each()];
        let all = self.candidates.iter().flat_map(|candidate| kinds.iter().map(move |interval| (candidate, *interval)));
        all.map(|(candidate, interval)| -> Call<'_, TimedAnswer> {
            let replicates = &self.touches_of(candidate).replicates;
            Box::new(move |number| {
                let (contacts, _) = &replicates[(number % replicates.len() as u64) as usize];
                call(contacts, candidate, interval)
            })
        })
        .collect()
    }

    /// Whether nothing is random.
    fn is_fixed(&self) -> bool {
        self.touches.iter().all(|touches| touches.replicates.len() == 1)
    }

    fn touches_of(&self, candidate: &Configuration) -> &Touches {
        let own = self.touches.iter().find(|touches| touches.stations == candidate.stations);
        own.unwrap_or(&self.touches[0])
    }

    /// Measures every candidate, on one thread, in about so many seconds. What a watch ended early holds what was reached.
    pub(crate) fn measure(&self, seconds: f64, watch: Watch<'_>) -> Vec<Measured> {
        let ledger = self.ledger();
        self.measure_into(&ledger, seconds, watch);
        self.measured(&ledger)
    }

    /// Where what is measured is entered.
    pub fn ledger(&self) -> Ledger {
        Ledger::new(self.candidates.len())
    }

    /// Ways of fitting that are to be measured.
    pub fn ways(&self) -> usize {
        self.candidates.len()
    }

    /// Measures on one thread, and enters what every call came to.
    pub fn measure_into(&self, ledger: &Ledger, seconds: f64, watch: Watch<'_>) {
        threads::alone(|| self.measure_here(ledger, seconds, watch));
    }

    fn measure_here(&self, ledger: &Ledger, seconds: f64, watch: Watch<'_>) {
        let each = self.calls_each();
        let mut calls = self.calls();
        let began = Instant::now();
        let (first, most_each) = (FOR_ALL * seconds, (SHARE_OF_EACH * seconds).clamp(LEAST_EACH, EACH));
        let limits = Limits { least: LEAST_ROUNDS, most: MOST_ROUNDS, seconds: first, each: most_each };
        heard_rounds(&mut calls, limits, watch, |k, heard| {
            let (candidate, interval) = (k / each, k % each);
            let (number, answer, multiply_adds) = match heard {
                Heard::Answer(number, answer, multiply_adds) => (number, answer, multiply_adds),
                Heard::Time(seconds) => return ledger.enter(candidate, |entry| entry.times[interval].push(seconds)),
            };
            let touches = self.touches_of(&self.candidates[candidate]);
            // a replicate that comes round again was judged before
            let Some((contacts, truth)) = touches.replicates.get(number as usize) else { return };
            let judged = judge(&answer, truth, interval == 1);
            if interval == 1 {
                return ledger.enter(candidate, |entry| entry.held.push(judged.held));
            }
            let memory =
                answer.as_ref().ok().filter(|_| number == 0).and_then(|found| memory::bytes(found, contacts.len()));
            ledger.enter(candidate, |entry| {
                entry.judged.push(judged);
                entry.memory = entry.memory.or(memory);
                entry.multiply_adds = entry.multiply_adds.or((number == 0).then_some(multiply_adds));
            });
        });
        drop(calls);
        self.measure_contenders(ledger, seconds - began.elapsed().as_secs_f64(), watch);
    }

    /// Judges those that the answer is chosen from on the replicates that they have not met, as far as the time goes. No time is
    /// entered: whoever is timed more often has a quicker quickest round.
    fn measure_contenders(&self, ledger: &Ledger, seconds: f64, watch: Watch<'_>) {
        let measured = self.measured(ledger);
        let chosen = match &self.request {
            Some(request) => contenders(&measured, request),
            None => shortlist(&measured, true).rows,
        };
        let place = |k: &usize| self.candidates.iter().position(|way| *way == measured[*k].configuration);
        let entries = ledger.entries();
        let begun: Vec<(usize, u64)> =
            chosen.iter().filter_map(place).map(|k| (k, entries[k].judged.len() as u64)).collect();
        let replicates = |k: usize| &self.touches_of(&self.candidates[k]).replicates;
        let unmet = |(k, met): &(usize, u64)| *met < replicates(*k).len() as u64;
        let begun: Vec<(usize, u64)> = begun.into_iter().filter(unmet).collect();
        let mut calls: Vec<Call<'_, TimedAnswer>> = Vec::new();
        for (k, met) in &begun {
            let own = replicates(*k);
            calls.push(Box::new(move |number| {
                let place = (met + number) as usize % own.len();
                call(&own[place].0, &self.candidates[*k], false)
            }));
        }
        // a slow one has its share and no more, so that the quick ones meet all replicates
        let each = seconds / begun.len().max(1) as f64;
        let limits = Limits { least: 0, most: MOST_ROUNDS, seconds, each };
        let still = |_, _| watch(MOST_ROUNDS, MOST_ROUNDS);
        heard_rounds(&mut calls, limits, &still, |place, heard| {
            let Heard::Answer(number, answer, _) = heard else { return };
            let (k, met) = begun[place];
            if let Some((_, truth)) = replicates(k).get((met + number) as usize) {
                let judged = judge(&answer, truth, false);
                ledger.enter(k, |entry| entry.judged.push(judged));
            }
        });
    }

    /// The candidates that were measured, by what the ledger holds of them.
    pub fn measured(&self, ledger: &Ledger) -> Vec<Measured> {
        let entries = ledger.entries();
        let reached = entries.iter().enumerate().filter(|(_, entry)| entry.is_measured(self.calls_each()));
        let mut measured: Vec<Measured> = reached
            .map(|(k, entry)| {
                let mut point = self.point(k, &entry.judged, &entry.held);
                if point.failed.is_none() {
                    (point.memory, point.multiply_adds) = (entry.memory, entry.multiply_adds);
                }
                point.seconds = Some(clocked(&entry.times[0]));
                point.seconds_interval = self.intervals.then(|| clocked(&entry.times[1]));
                let rms = |judged: &Judged, q: usize| judged.deviations[q].rms().unwrap_or(f64::NAN);
                let runs = entry.judged.iter().map(|judged| [rms(judged, 0), rms(judged, 1)]).collect();
                Measured { configuration: self.candidates[k].clone(), point, runs, fixed: self.is_fixed() }
            })
            .collect();
        share_quickest(&mut measured);
        mark(&mut measured);
        measured
    }

    fn point(&self, k: usize, judged: &[Judged], held: &[[Option<bool>; 2]]) -> Point {
        let candidate = &self.candidates[k];
        let failed = judged.iter().find_map(|judged| judged.failed.clone());
        let errors: [_; QUANTITIES.len()] = std::array::from_fn(|q| errors_of(judged, q, self.is_fixed()));
        let covered = |q: usize| share(held.iter().filter_map(|held| held[q]));
        let mut point = Point {
            label: candidate.label(),
            method: candidate.options.method.name().into(),
            surface: if candidate.recognised { "recognised" } else { candidate.options.surface.name() },
            weights: candidate.weights(),
            degree: candidate.options.degree,
            segments: candidate.options.segments,
            stations: candidate.stations,
            contacts: self.touches_of(candidate).contacts(),
            errors,
            coverage: [covered(0), covered(1)],
            replicates: judged.len() as u64,
            support: judged.first().map(|judged| judged.support),
            failed,
            ..Point::default()
        };
        if point.failed.is_none() && point.support == Some(0.0) {
            point.failed =
                Some("the data support no point of the shape grid: too few contacts for these coefficients".into());
        }
        if point.failed.is_none() {
            point.error = self.together(&point, |errors| errors.rms);
            let ends = [0, 1].map(|end| self.together(&point, |errors| errors.interval[end]));
            point.error_interval = ends[0].zip(ends[1]).map(|(lo, hi)| [lo, hi]);
        }
        point
    }

    /// `sqrt(S^2 + (R/R_true)^2)`; what the truth does not have is left out.
    fn together(&self, point: &Point, of: impl Fn(&super::errors::Errors) -> f64) -> Option<f64> {
        let part = |q: usize, unit: f64| point.errors[q].as_ref().map(|errors| of(errors) / unit);
        let unit = if self.curvedness > 0.0 { self.curvedness } else { 1.0 };
        match (part(0, 1.0), part(1, unit)) {
            (Some(s), Some(r)) => Some(s.hypot(r)),
            (None, r) if !self.defined[0] => r,
            _ => None,
        }
    }
}

/// Marks those that no other beats.
pub fn mark(measured: &mut [Measured]) {
    let mut points: Vec<&mut Point> = measured.iter_mut().map(|measured| &mut measured.point).collect();
    pareto::mark(&mut points);
}
