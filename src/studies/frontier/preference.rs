//! Which of several ways is taken where noise leaves more than one: the same in every run.
//!
//! ```text
//! quick(a)      the least time of any round of any way that does the same work as a
//! taken         of those with quick <= band x the least quick, the simplest; of equally simple ones, the first candidate
//! ```
//!
//! The least time of a call changes least between two runs, and ways whose weights alone differ take the same time. A band that is
//! wider than the clock's noise makes the choice among the near ones one of simplicity, which no clock decides.

use super::measured::Measured;

/// Gives every way the quickest round of all ways that do the same work, so that equals are shown as equals.
pub(super) fn share_quickest(ways: &mut [Measured]) {
    let quick = Preference::new(ways).quick;
    for (way, quick) in ways.iter_mut().zip(quick).filter(|(_, quick)| quick.is_finite()) {
        way.point.seconds.iter_mut().for_each(|time| time.least = quick);
    }
}

/// Ways with what decides between them.
#[derive(Debug)]
pub(super) struct Preference<'a> {
    ways: &'a [Measured],
    quick: Vec<f64>,
}

impl<'a> Preference<'a> {
    /// Of these ways; those without an answer have no time.
    pub(super) fn new(ways: &'a [Measured]) -> Preference<'a> {
        let least = |way: &Measured| match (&way.point.failed, way.point.seconds) {
            (None, Some(time)) if time.least.is_finite() => time.least,
            _ => f64::INFINITY,
        };
        let quick = |way: &Measured| {
            let alike = ways.iter().filter(|other| other.configuration.work() == way.configuration.work());
            alike.map(least).fold(f64::INFINITY, f64::min)
        };
        Preference { ways, quick: ways.iter().map(quick).collect() }
    }

    /// The time by which a way is compared, seconds.
    pub(super) fn quick(&self, k: usize) -> f64 {
        self.quick[k]
    }

    /// The one to take of these: the simplest that takes at most `band` times the least time.
    pub(super) fn taken(&self, of: &[usize], band: f64) -> Option<usize> {
        let least = of.iter().map(|k| self.quick[*k]).fold(f64::INFINITY, f64::min);
        let near = of.iter().filter(|k| self.quick[**k] <= band * least);
        near.min_by_key(|k| (self.ways[**k].configuration.simplicity(), **k)).copied()
    }
}
