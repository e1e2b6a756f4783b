//! Counts against a baseline: `after > 1.02 before` is growth, and a failure.

use std::collections::BTreeMap;

/// Counts by name, `workload what`.
pub(crate) type Counts = BTreeMap<String, u64>;

/// Per cent by which a count may exceed its baseline: the noise of code generation between two builds of one compiler.
pub(crate) const ALLOWED: u64 = 2;

/// A count that grew by more than is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Growth {
    /// Which.
    pub name: String,
    /// In the baseline.
    pub before: u64,
    /// Now.
    pub after: u64,
}

/// All growths; counts that stand on one side only are none.
pub(crate) fn growths(baseline: &Counts, found: &Counts) -> Vec<Growth> {
    let grown = |before: u64, after: u64| u128::from(after) * 100 > u128::from(before) * u128::from(100 + ALLOWED);
    found
        .iter()
        .filter_map(|(name, &after)| baseline.get(name).map(|&before| (name, before, after)))
        .filter(|&(_, before, after)| grown(before, after))
        .map(|(name, before, after)| Growth { name: name.clone(), before, after })
        .collect()
}
