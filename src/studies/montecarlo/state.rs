//! All that a study knows while it runs: what is written as a checkpoint, and as a part of a larger run.
//!
//! Everything in it is a sum of whole numbers or an exact sum, so a state depends on which replicates were seen and on
//! nothing else; batches of the stopping rule are numbered and belong to the run, not to a part.

use super::control::ControlTally;
use super::engine::{Engine, Values};
use super::histogram::Bins;
use super::options::{KEPT, PILOT, StudyOptions};
use super::stopping::{BatchEstimate, batch_estimate};
use super::tally::{OtherBins, Tally};
use palpate_geometry::curvature::ShapeClass;

/// What was seen of replicates `from .. to`.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyState {
    /// First replicate.
    pub from: u64,
    /// One past the last replicate seen.
    pub to: u64,
    /// One tally a quantity, S and R first.
    pub tallies: Vec<Tally>,
    /// Replicates of each curved class, in the order of S.
    pub classes: [u64; 9],
    /// Replicates whose contacts a whole fit could not tell from a plane.
    pub planes: u64,
    /// Replicates whose fit failed.
    pub failed: u64,
    /// Why the first of them did, and its number.
    pub first_failure: Option<(u64, String)>,
    /// Estimates of the batches that the stopping rule has seen.
    pub batches: Vec<BatchEstimate>,
    /// The control beside S and R; `None` where there is none, or a replicate had no S or R.
    pub control: Option<ControlTally>,
}

impl StudyState {
    /// Nothing seen yet, from replicate `from` on.
    pub fn new(engine: &Engine, seed: u64, options: &StudyOptions, from: u64) -> StudyState {
        // how many a tolerance takes is not known yet: they are kept as long as there is room
        let bins: Vec<Option<Bins>> = if options.tolerance.is_some() || options.most() <= KEPT {
            vec![None; engine.quantities().len()]
        } else {
            let mut pilot = engine.values(seed, 0, PILOT).columns;
            pilot
                .iter_mut()
                .map(|column| {
                    column.retain(|v| v.is_finite());
                    column.sort_unstable_by(f64::total_cmp);
                    Some(Bins::of(column))
                })
                .collect()
        };
        let tallies = engine.nominal().iter().zip(bins).map(|(nominal, bins)| Tally::new(*nominal, bins)).collect();
        StudyState {
            from,
            to: from,
            tallies,
            classes: [0; 9],
            planes: 0,
            failed: 0,
            first_failure: None,
            batches: Vec::new(),
            control: None,
        }
    }

    /// Replicates seen.
    pub fn done(&self) -> u64 {
        self.to - self.from
    }

    /// Looks at the values of the next batch of the stopping rule, before they are taken in.
    pub fn look(&mut self, values: &Values, level: f64) {
        let undefined = values.columns.iter().take(2).flatten().any(|v| !v.is_finite());
        let estimate = match self.control.as_mut().filter(|_| !undefined) {
            Some(control) => control.look(&values.columns, &values.control, level),
            None => batch_estimate(&values.columns, level),
        };
        self.batches.push(estimate);
    }

    /// Takes the values of the next replicates in.
    pub fn take(&mut self, values: &Values, level: f64) {
        let Some(s) = values.columns.first() else { return };
        if values.columns.iter().take(2).flatten().any(|v| !v.is_finite()) {
            self.control = None;
        }
        if let Some(control) = &mut self.control {
            control.take(&values.control, level);
        }
        self.to += s.len() as u64;
        for own in s.iter().filter(|s| s.is_finite()) {
            let class = ShapeClass::of_shape_index(*own);
            if let Some(k) = ShapeClass::CURVED.iter().position(|c| *c == class) {
                self.classes[k] += 1;
            }
        }
        // one thread a quantity: each tally is one thread's
        palpate_numeric::threads::each(&mut self.tallies, |k, tally| {
            if let Some(column) = values.columns.get(k) {
                tally.make_room(column.len() as u64);
                tally.extend(column);
            }
        });
        self.planes += values.planes;
        self.failed += values.failed.len() as u64;
        if let (None, Some(first)) = (&self.first_failure, values.failed.first()) {
            self.first_failure = Some(first.clone());
        }
    }

    /// Joins the state of the replicates that follow.
    ///
    /// # Errors
    /// When the tallies are not of one kind.
    pub fn merge(&mut self, next: &StudyState) -> Result<(), OtherBins> {
        if self.tallies.len() != next.tallies.len() {
            return Err(OtherBins);
        }
        for (own, more) in self.tallies.iter_mut().zip(&next.tallies) {
            own.merge(more)?;
        }
        self.to = next.to;
        self.classes.iter_mut().zip(next.classes).for_each(|(own, more)| *own += more);
        self.planes += next.planes;
        self.failed += next.failed;
        if self.first_failure.is_none() {
            self.first_failure.clone_from(&next.first_failure);
        }
        Ok(())
    }
}
