//! Counts of many problems, small enough to be written down after every block.
//!
//! ```text
//! margin = found - promised digits, counted in hundredths of a digit
//! ```

use std::collections::BTreeMap;

use crate::problems::draw::Family;
use crate::problems::judge::{Exception, Judged, Outcome, QUANTITIES};

/// Margins in hundredths of a digit, with how often each came.
pub(crate) type Margins = BTreeMap<i32, u64>;

/// What became of the problems of one family.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OfFamily {
    pub problems: u64,
    pub compared: u64,
    /// Answered with gaps, compared with the rule for gaps or with nothing.
    pub gaps: [u64; 2],
    pub refused: u64,
    pub redrawn: u64,
    /// Answers that promise less than one digit of S.
    pub unpromised: u64,
    pub margins: [Margins; 3],
}

/// What became of all problems.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tally {
    pub families: [OfFamily; 7],
    pub exceptions: Vec<Exception>,
}

impl Tally {
    /// Counts one problem.
    pub(crate) fn add(&mut self, judged: Judged) {
        let Some(k) = Family::ALL.iter().position(|f| *f == judged.family) else { return };
        let of = &mut self.families[k];
        of.problems += 1;
        of.redrawn += judged.redrawn;
        match judged.outcome {
            Outcome::Compared { found, promised, gaps } => {
                of.compared += u64::from(!gaps);
                of.gaps[0] += u64::from(gaps);
                of.unpromised += u64::from(promised[1] < 1.0);
                for k in 0..3 {
                    // floored: a margin below zero by a hair stays below zero
                    let margin = (100.0 * (found[k] - promised[k])).floor() as i32;
                    *of.margins[k].entry(margin).or_insert(0) += 1;
                }
            }
            Outcome::Gaps => of.gaps[1] += 1,
            Outcome::Refused => of.refused += 1,
        }
        self.exceptions.extend(judged.exceptions);
    }

    /// Adds the counts of other problems.
    pub(crate) fn merge(&mut self, other: Tally) {
        for (to, from) in self.families.iter_mut().zip(other.families) {
            to.problems += from.problems;
            to.compared += from.compared;
            (to.gaps[0], to.gaps[1]) = (to.gaps[0] + from.gaps[0], to.gaps[1] + from.gaps[1]);
            to.refused += from.refused;
            to.redrawn += from.redrawn;
            to.unpromised += from.unpromised;
            for (to, from) in to.margins.iter_mut().zip(from.margins) {
                from.into_iter().for_each(|(margin, count)| *to.entry(margin).or_insert(0) += count);
            }
        }
        self.exceptions.extend(other.exceptions);
    }

    /// All families together.
    pub(crate) fn whole(&self) -> OfFamily {
        let mut sum = Tally::default();
        for of in &self.families {
            let mut one = Tally::default();
            one.families[0] = of.clone();
            sum.merge(one);
        }
        let [whole, ..] = sum.families;
        whole
    }

    /// Exceptions whose words hold this one.
    pub(crate) fn with_word(&self, word: &str) -> usize {
        self.exceptions.iter().filter(|e| e.words.contains(word)).count()
    }
}

impl OfFamily {
    /// Median and least margin of each quantity, in digits.
    pub(crate) fn margins(&self) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|k| {
            let margins = &self.margins[k];
            let half = margins.values().sum::<u64>() / 2;
            let mut before = 0;
            let median = margins.iter().find(|(_, count)| {
                before += **count;
                before > half
            });
            let digits = |of: Option<(&i32, &u64)>| of.map_or(f64::NAN, |(margin, _)| f64::from(*margin) / 100.0);
            [digits(median), digits(margins.iter().next())]
        })
    }

    fn counts(&self) -> [u64; 7] {
        [self.problems, self.compared, self.gaps[0], self.gaps[1], self.refused, self.redrawn, self.unpromised]
    }
}

/// One line a family and quantity, then the exceptions.
pub(crate) fn to_text(tally: &Tally) -> String {
    let mut lines = Vec::new();
    for (k, of) in tally.families.iter().enumerate() {
        lines.push(format!("counts {k} {}", of.counts().map(|c| c.to_string()).join(" ")));
        for (quantity, margins) in of.margins.iter().enumerate() {
            let margins: Vec<String> = margins.iter().map(|(margin, count)| format!("{margin}:{count}")).collect();
            lines.push(format!("margins {k} {quantity} {}", margins.join(" ")));
        }
    }
    let line = |e: &Exception| format!("exception {} {} {}", e.number, e.attempt, e.words.replace('\n', " "));
    lines.extend(tally.exceptions.iter().map(line));
    lines.join("\n")
}

/// The tally that [`to_text`] wrote; `None` for any other text.
pub(crate) fn from_text<'a>(lines: impl Iterator<Item = &'a str>) -> Option<Tally> {
    let mut tally = Tally::default();
    for line in lines {
        let (kind, rest) = line.split_once(' ')?;
        match kind {
            "counts" => {
                let numbers: Vec<u64> = rest.split(' ').map(|v| v.parse().ok()).collect::<Option<_>>()?;
                let [family, problems, compared, ruled, gaps, refused, redrawn, unpromised] = numbers[..] else {
                    return None;
                };
                let of = tally.families.get_mut(family as usize)?;
                (of.problems, of.compared, of.gaps) = (problems, compared, [ruled, gaps]);
                (of.refused, of.redrawn, of.unpromised) = (refused, redrawn, unpromised);
            }
            "margins" => {
                let mut words = rest.split(' ').filter(|w| !w.is_empty());
                let family = tally.families.get_mut(words.next()?.parse::<usize>().ok()?)?;
                let margins = family.margins.get_mut(words.next()?.parse::<usize>().ok()?)?;
                for word in words {
                    let (margin, count) = word.split_once(':')?;
                    margins.insert(margin.parse().ok()?, count.parse().ok()?);
                }
            }
            "exception" => {
                let mut parts = rest.splitn(3, ' ');
                let (number, attempt) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
                tally.exceptions.push(Exception { number, attempt, words: parts.next()?.to_string() });
            }
            _ => return None,
        }
    }
    Some(tally)
}

/// The table of `benches/runs/random-problems.md`.
pub(crate) fn table(tally: &Tally) -> String {
    let mut lines = vec![format!(
        "{:<14} {:>8} {:>8} {:>11} {:>9} {:>7} {:>8} {:>10}   {}",
        "rows",
        "problems",
        "compared",
        "gaps (rule)",
        "gaps else",
        "refused",
        "redrawn",
        "S below 1",
        "median, least margin"
    )];
    let named = Family::ALL.iter().map(|f| f.name()).zip(&tally.families);
    for (name, of) in named.chain([("all", &tally.whole())]) {
        let margins = of.margins().map(|[median, least]| format!("{median:5.2} {least:6.2}")).join("  ");
        lines.push(format!(
            "{name:<14} {:>8} {:>8} {:>11} {:>9} {:>7} {:>8} {:>10}   {margins}",
            of.problems, of.compared, of.gaps[0], of.gaps[1], of.refused, of.redrawn, of.unpromised
        ));
    }
    lines.push(format!("margins: {}", QUANTITIES.join(", ")));
    lines.push(format!(
        "broken promises {}, refusals {}, notes missing {}",
        tally.with_word(" broken: "),
        tally.with_word(" refused: "),
        tally.with_word(" note: ")
    ));
    lines.join("\n")
}
