//! What the calls of a frontier came to so far.
//!
//! ```text
//! thread that measures   -> enters after every call        thread that waits   -> reads, also where it waits no longer
//! ```

use std::sync::{Mutex, PoisonError};

use super::errors::Judged;

/// Of one way of fitting.
#[derive(Clone, Debug, Default)]
pub(super) struct LedgerLine {
    /// What is judged of each replicate that was fitted.
    pub judged: Vec<Judged>,
    /// Whether its intervals of S and of R held the truth.
    pub held: Vec<[Option<bool>; 2]>,
    /// Bytes of the first answer.
    pub memory: Option<u64>,
    /// Multiply-adds of the first answer.
    pub multiply_adds: Option<u64>,
    /// Standard uncertainties of S and of R in the posterior, where there is one.
    pub uncertainty: [Option<f64>; 2],
    /// Seconds in every round, of the call without and of that with intervals.
    pub times: [Vec<f64>; 2],
}

impl LedgerLine {
    /// Whether there is a point to be made of it.
    pub(super) fn is_measured(&self, calls_each: usize) -> bool {
        !self.judged.is_empty() && self.times[..calls_each].iter().all(|times| !times.is_empty())
    }
}

/// Of all ways, in their order.
#[derive(Debug)]
pub struct Ledger(Mutex<Vec<LedgerLine>>);

impl Ledger {
    /// Nothing yet of so many ways.
    pub(super) fn new(ways: usize) -> Ledger {
        Ledger(Mutex::new(vec![LedgerLine::default(); ways]))
    }

    /// Enters what a call of way `k` came to.
    pub(super) fn enter(&self, k: usize, fill: impl FnOnce(&mut LedgerLine)) {
        let mut entries = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(entry) = entries.get_mut(k) {
            fill(entry);
        }
    }

    /// All of it.
    pub(super) fn entries(&self) -> Vec<LedgerLine> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
