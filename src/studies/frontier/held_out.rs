//! A frontier of measured contacts, whose truth nobody knows: every fit is judged by contacts that it has not seen.
//!
//! ```text
//! contacts in K parts of small blocks:   fit all parts but k, over the domain of all    judge heights and normals of part k
//! ```
//!
//! Neighbours share errors, and a contact between two others tells little: what is left out are blocks of them, or whole fingers where
//! there are many.
//!
//! The noise of the unseen contacts is part of every error: the least one is about the noise itself, and configurations are
//! told apart by what stands above it.

use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights};
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::threads;

use super::FrontierError;
use super::clock::{Call, Heard, Limits, Watch, clocked, heard_rounds};
use super::configuration::{Configuration, candidates};
use super::errors::{HEIGHT, errors_of};
use super::found_surface::{FoundSurface, TimedAnswer};
use super::ledger::{Ledger, LedgerLine};
use super::measured::Measured;
use super::memory;
use super::pareto;
use super::point::Point;
use super::preference::share_quickest;
use super::recognised::uncertainties;
use super::scoring::{call, judge_contacts};

/// Parts: a fit sees four fifths of the contacts.
const PARTS: usize = 5;
/// Fewer contacts leave too few in a part to tell an error from its noise.
const LEAST_CONTACTS: usize = 30;
/// Rounds: every part is judged in the first of them.
const LIMITS: Limits = Limits { least: 4, most: 30, seconds: 30.0, each: 1.0 };
/// Contacts of a block at least: fewer are told by their neighbours.
const LEAST_IN_BLOCK: usize = 3;
/// Blocks at most: more are smaller, and smaller ones are told more easily than a gap in the data would be.
const MOST_BLOCKS: usize = 32;
/// Fingers from which on whole ones are left out: of fewer, what is left shows no bend across them.
const MANY_FINGERS: usize = 10;

/// Contacts and the ways of fitting them, ready to be measured.
#[derive(Debug)]
pub struct HeldOut {
    contacts: Contacts,
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
        Ok(HeldOut { contacts: contacts.clone(), parts: parts(contacts), ways: ways(contacts, own) })
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
        let mut calls: Vec<Call<'_, TimedAnswer>> = Vec::new();
        for way in &self.ways {
            calls.push(Box::new(move |number| call(&parts[number as usize % parts.len()].0, way, false)));
        }
        heard_rounds(&mut calls, limits, watch, |k, heard| {
            let (number, answer, multiply_adds) = match heard {
                Heard::Answer(number, answer, multiply_adds) => (number, answer, multiply_adds),
                Heard::Time(seconds) => return ledger.enter(k, |entry| entry.times[0].push(seconds)),
            };
            let Some((seen, unseen)) = parts.get(number as usize) else { return };
            let judged = judge_contacts(&answer, unseen);
            let memory =
                answer.as_ref().ok().filter(|_| number == 0).and_then(|found| memory::bytes(found, seen.len()));
            // of all contacts once, while no clock runs
            let uncertainty = self.uncertainty(number, &self.ways[k]);
            ledger.enter(k, |entry| {
                entry.judged.push(judged);
                entry.memory = entry.memory.or(memory);
                entry.multiply_adds = entry.multiply_adds.or((number == 0).then_some(multiply_adds));
                entry.uncertainty = uncertainty.unwrap_or(entry.uncertainty);
            });
        });
    }

    /// How sure S and R are where all contacts are recognised; `None` after the first call, and of models that are named, which have
    /// no posterior over kinds of surface.
    fn uncertainty(&self, number: u64, way: &Configuration) -> Option<[Option<f64>; 2]> {
        if number > 0 || !way.recognised {
            return None;
        }
        match call(&self.contacts, way, false) {
            Ok(FoundSurface::Recognised(found)) => Some(uncertainties(&found)),
            _ => None,
        }
    }

    /// The ways that were measured, by what the ledger holds of them. All are judged by the same parts, because some parts are harder to
    /// tell than others: by those that half of the ways have come to, and ways that have come to fewer are left out. What is recognised is
    /// the answer that everyone gets, and stays in: where it is slow, all are judged by the parts that it has come to.
    pub fn measured(&self, ledger: &Ledger) -> Vec<Measured> {
        let mut entries = ledger.entries();
        let mut counts: Vec<usize> =
            entries.iter().filter(|entry| entry.is_measured(1)).map(|entry| entry.judged.len()).collect();
        counts.sort_unstable();
        let half = counts.get(counts.len() / 2).copied().unwrap_or(0);
        let recognised = self.ways.iter().zip(&entries).filter(|(way, entry)| way.recognised && entry.is_measured(1));
        let parts = recognised.map(|(_, entry)| entry.judged.len()).min().map_or(half, |least| half.min(least));
        entries.iter_mut().for_each(|entry| entry.judged.truncate(parts));
        let alike = |entry: &LedgerLine| entry.is_measured(1) && entry.judged.len() == parts;
        let reached = self.ways.iter().zip(&entries).filter(|(_, entry)| alike(entry));
        let contacts = self.parts.first().map_or(0, |(seen, _)| seen.len());
        let mut measured: Vec<Measured> = reached
            .map(|(way, entry)| Measured {
                configuration: way.clone(),
                point: point(way, entry, contacts),
                runs: Vec::new(),
                fixed: false,
            })
            .collect();
        share_quickest(&mut measured);
        let mut points: Vec<&mut Point> = measured.iter_mut().map(|measured| &mut measured.point).collect();
        pareto::mark(&mut points);
        measured
    }
}

fn point(way: &Configuration, entry: &LedgerLine, contacts: usize) -> Point {
    let judged = &entry.judged;
    let errors: [_; 6] = std::array::from_fn(|q| errors_of(judged, q, false));
    let failed = judged.iter().find_map(|judged| judged.failed.clone());
    Point {
        label: way.label(),
        method: way.options.method.name().into(),
        surface: if way.recognised { "recognised" } else { way.options.surface.name() },
        weights: way.weights(),
        degree: way.options.degree,
        segments: way.options.segments,
        contacts,
        error: errors[HEIGHT].filter(|_| failed.is_none()).map(|errors| errors.rms),
        error_interval: errors[HEIGHT].filter(|_| failed.is_none()).map(|errors| errors.interval),
        errors,
        uncertainty: entry.uncertainty,
        seconds: Some(clocked(&entry.times[0])),
        memory: entry.memory.filter(|_| failed.is_none()),
        multiply_adds: entry.multiply_adds.filter(|_| failed.is_none()),
        replicates: judged.len() as u64,
        support: judged.first().map(|judged| judged.support),
        failed,
        ..Point::default()
    }
}

/// What is fitted and what is left out, part by part.
fn parts(contacts: &Contacts) -> Vec<(Contacts, Contacts)> {
    let blocks = fingers(contacts).unwrap_or_else(|| blocks(contacts));
    let of = |part: usize, own: bool| -> Contacts {
        let chosen = blocks.iter().enumerate().filter(|(place, _)| (place % PARTS == part) == own);
        let mut numbers: Vec<u32> = chosen.flat_map(|(_, block)| block.iter().copied()).collect();
        numbers.sort_unstable();
        contacts.in_order(&numbers)
    };
    (0..PARTS).map(|part| (of(part, false), of(part, true))).collect()
}

/// The contacts of each finger, where there are many fingers.
fn fingers(contacts: &Contacts) -> Option<Vec<Vec<u32>>> {
    let labels = contacts.finger.as_ref()?;
    let mut distinct = labels.clone();
    distinct.sort_unstable();
    distinct.dedup();
    let of = |finger: &u32| (0..labels.len() as u32).filter(|r| labels[*r as usize] == *finger).collect();
    (distinct.len() >= MANY_FINGERS).then(|| distinct.iter().map(of).collect())
}

/// Contacts that lie side by side in x and y, neighbouring blocks one after the other: halved across the longer side until they are small.
fn blocks(contacts: &Contacts) -> Vec<Vec<u32>> {
    let most = (contacts.len() / LEAST_IN_BLOCK).clamp(PARTS, MOST_BLOCKS);
    let mut blocks: Vec<Vec<u32>> = vec![(0..contacts.len() as u32).collect()];
    while blocks.len() < most {
        let Some(largest) = (0..blocks.len()).max_by_key(|k| (blocks[*k].len(), usize::MAX - k)) else { break };
        let mut whole = std::mem::take(&mut blocks[largest]);
        let side = |along: &[f64]| {
            let of = whole.iter().map(|r| along[*r as usize]);
            of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
        };
        let along = if side(&contacts.x) >= side(&contacts.y) { &contacts.x } else { &contacts.y };
        whole.sort_by(|a, b| along[*a as usize].total_cmp(&along[*b as usize]));
        let second = whole.split_off(whole.len() / 2);
        blocks.splice(largest..=largest, [whole, second]);
    }
    blocks
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
    candidates(&own, &[None], normals, contacts.len()).into_iter().filter(fits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of places.
    fn grid(nx: usize, ny: usize) -> Contacts {
        let at = |r: usize| ((r % nx) as f64, (r / nx) as f64);
        let (x, y): (Vec<f64>, Vec<f64>) = (0..nx * ny).map(at).unzip();
        let z = x.iter().map(|x| 0.01 * x * x).collect();
        Contacts::from_positions(x, y, z)
    }

    #[test]
    fn every_contact_is_left_out_once_beside_others() {
        let contacts = grid(12, 10);
        let parts = parts(&contacts);
        assert_eq!(parts.iter().map(|(_, unseen)| unseen.len()).sum::<usize>(), 120);
        assert!(parts.iter().all(|(seen, unseen)| seen.len() + unseen.len() == 120 && unseen.len() >= 18));
        // a neighbour along x or y is left out with it
        let (_, unseen) = &parts[0];
        let near = |a: usize, b: usize| (unseen.x[a] - unseen.x[b]).hypot(unseen.y[a] - unseen.y[b]) <= 1.0;
        assert!((0..unseen.len()).all(|a| (0..unseen.len()).any(|b| a != b && near(a, b))));
    }

    #[test]
    fn what_is_recognised_stays_in_however_slow_it_is() {
        let held_out = HeldOut::new(&grid(12, 10), &FitOptions::default()).unwrap();
        let ledger = held_out.ledger();
        for (k, way) in held_out.ways.iter().enumerate() {
            let calls = if way.recognised { 2 } else { PARTS };
            ledger.enter(k, |entry| {
                entry.judged = vec![Default::default(); calls];
                entry.times[0] = vec![1e-3; calls];
            });
        }
        let measured = held_out.measured(&ledger);
        assert!(measured.iter().any(|way| way.configuration.recognised) && measured.len() == held_out.ways());
        assert!(measured.iter().all(|way| way.point.replicates == 2));
    }

    #[test]
    fn many_fingers_are_left_out_as_a_whole() {
        let contacts = grid(12, 10);
        let finger = contacts.x.iter().map(|x| *x as u32).collect();
        let labelled = Contacts { finger: Some(finger), ..contacts };
        let parts = parts(&labelled);
        let distinct = |unseen: &Contacts| {
            let mut x: Vec<u32> = unseen.x.iter().map(|x| *x as u32).collect();
            x.sort_unstable();
            x.dedup();
            (x.len(), unseen.len())
        };
        assert_eq!(distinct(&parts[0].1), (3, 30));
        assert_eq!(distinct(&parts[4].1), (2, 20));
    }
}
