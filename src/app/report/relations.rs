//! What ties the parts of a body: records, lines of the table, and the page's section.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::Serialize;

use super::words::chance;
use palpate_inference::parts::{Relation, RelationKind};

/// Two parts and what probably ties them.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct RelationRecord {
    /// Their ids.
    pub parts: [usize; 2],
    /// `coaxial`, `concentric`, `parallel`, `perpendicular` or `equal_radius`.
    pub kind: RelationKind,
    /// Probability that it holds.
    pub probability: f64,
    /// By how much it is missed: degrees of parallel and perpendicular, else a length.
    pub missed_by: f64,
    /// Standard uncertainty of that.
    pub u: f64,
}

impl RelationRecord {
    pub(crate) fn of(relation: &Relation) -> RelationRecord {
        let Relation { parts, kind, probability, missed_by, u } = *relation;
        RelationRecord { parts, kind, probability, missed_by, u }
    }
}

/// Groups that a line names: what is tied on a cloud of many parts stands whole in the JSON and the graphs.
const MOST_NAMED: usize = 12;

/// One line a kind: what is tied, and how probably.
pub(crate) fn relation_lines(relations: &[RelationRecord]) -> Vec<String> {
    let of_kind = |these: &[RelationRecord]| {
        let mut these = these.to_vec();
        these.sort_by(|a, b| said_alike(b).total_cmp(&said_alike(a)).then(a.parts.cmp(&b.parts)));
        let (mut room, mut left) = (MOST_NAMED, 0);
        let mut told = Vec::new();
        for pairs in these.chunk_by(|a, b| said_alike(a) == said_alike(b)) {
            let groups = groups(pairs);
            let named = &groups[..groups.len().min(room)];
            room -= named.len();
            left += groups[named.len()..].iter().map(|group| group.pairs).sum::<usize>();
            if !named.is_empty() {
                told.push(level(pairs, named));
            }
        }
        if left > 0 {
            told.push(format!("and {left} more pairs, which --json names"));
        }
        format!("{}: {}", these[0].kind.name(), told.join(", "))
    };
    relations.chunk_by(|a, b| a.kind == b.kind).map(of_kind).collect()
}

/// The groups of pairs that are as probable, in words.
fn level(pairs: &[RelationRecord], groups: &[Group]) -> String {
    let words: Vec<String> = groups.iter().map(Group::words).collect();
    let least = pairs.iter().map(|pair| pair.probability).fold(1.0, f64::min);
    let differ = pairs.iter().any(|pair| per_cent(pair) != (100.0 * least).round());
    let at_least = if differ { " or more" } else { "" };
    let each = if pairs.len() > 1 { " each" } else { "" };
    // pairs need no more than commas
    let between = if groups.iter().any(|group| group.pairs > 1) { "; " } else { ", " };
    format!("{} ({}{at_least}{each})", words.join(between), chance(least))
}

/// Parts of which each is tied to each other one, or each of the first to each of the second.
struct Group {
    ones: Vec<usize>,
    others: Vec<usize>,
    /// Pairs that no group before it names.
    pairs: usize,
}

impl Group {
    fn words(&self) -> String {
        match (&self.ones[..], &self.others[..]) {
            ([a], [b]) => format!("{a} and {b}"),
            ([a, b], []) => format!("{a} and {b}"),
            (ones, []) => format!("{} with each other", listed(ones)),
            ([one], others) => format!("{one} with each of {}", listed(others)),
            (ones, others) => format!("each of {} with each of {}", listed(ones), listed(others)),
        }
    }
}

fn listed(parts: &[usize]) -> String {
    let words: Vec<String> = parts.iter().map(ToString::to_string).collect();
    words.split_last().map_or_else(String::new, |(last, first)| {
        if first.is_empty() { last.clone() } else { format!("{} and {last}", first.join(", ")) }
    })
}

/// Pairs of one kind in as large groups as they make, the largest first.
fn groups(pairs: &[RelationRecord]) -> Vec<Group> {
    let tied: BTreeSet<[usize; 2]> = pairs.iter().map(|pair| pair.parts).collect();
    let parts: BTreeSet<usize> = tied.iter().flatten().copied().collect();
    let are_tied = |a: usize, b: usize| tied.contains(&[a.min(b), a.max(b)]);
    // parts that are square to the same ones are not square to each other
    let crosswise = pairs.iter().any(|pair| pair.kind == RelationKind::Perpendicular);
    let mut open = tied.clone();
    let mut found = Vec::new();
    while let Some([a, b]) = open.first().copied() {
        let (mut ones, mut others) = (vec![a], vec![b]);
        if crosswise {
            others = parts.iter().copied().filter(|c| are_tied(a, *c)).collect();
            ones = parts.iter().copied().filter(|c| others.iter().all(|d| are_tied(*c, *d))).collect();
        } else {
            ones.append(&mut others);
            for c in &parts {
                if ones.iter().all(|d| are_tied(*c, *d)) {
                    ones.push(*c);
                }
            }
            ones.sort_unstable();
        }
        let before = open.len();
        open.retain(|[a, b]| {
            let holds = |list: &[usize], part: &usize| list.contains(part);
            let within = others.is_empty() && holds(&ones, a) && holds(&ones, b);
            let across = holds(&ones, a) && holds(&others, b) || holds(&ones, b) && holds(&others, a);
            !within && !across
        });
        found.push(Group { ones, others, pairs: before - open.len() });
    }
    found.sort_by_key(|group| std::cmp::Reverse(group.pairs));
    found
}

fn per_cent(relation: &RelationRecord) -> f64 {
    (100.0 * relation.probability).round()
}

/// Probabilities that are said alike are alike: more than 99 %, 95 % or more, and below that by the per cent.
fn said_alike(relation: &RelationRecord) -> f64 {
    match per_cent(relation) {
        p if (95.0..100.0).contains(&p) => 95.0,
        p => p,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_one_kind_stand_in_one_line() {
        let one = |parts, kind, probability| RelationRecord { parts, kind, probability, missed_by: 0.0, u: 0.1 };
        let lines = relation_lines(&[
            one([0, 1], RelationKind::Coaxial, 0.999),
            one([0, 2], RelationKind::Coaxial, 0.998),
            one([1, 2], RelationKind::Coaxial, 0.82),
            one([3, 4], RelationKind::EqualRadius, 0.97),
        ]);
        assert_eq!(
            lines,
            ["coaxial: 0 and 1, 0 and 2 (more than 99 % each), 1 and 2 (82 %)", "equal radius: 3 and 4 (97 %)"]
        );
    }

    #[test]
    fn what_is_tied_all_together_is_said_once() {
        let one = |kind| move |parts| RelationRecord { parts, kind, probability: 0.999, missed_by: 0.0, u: 0.1 };
        let side_by_side = [[0, 1], [0, 4], [1, 4], [2, 3]].map(one(RelationKind::Parallel));
        let square = [[0, 2], [0, 3], [1, 2], [1, 3], [2, 4], [3, 4]].map(one(RelationKind::Perpendicular));
        assert_eq!(
            relation_lines(&[&side_by_side[..], &square[..]].concat()),
            [
                "parallel: 0, 1 and 4 with each other; 2 and 3 (more than 99 % each)",
                "perpendicular: each of 0, 1 and 4 with each of 2 and 3 (more than 99 % each)"
            ]
        );
    }

    #[test]
    fn of_very_many_the_largest_groups_are_named_and_the_rest_is_counted() {
        let kind = RelationKind::EqualRadius;
        let pair =
            |k: usize| RelationRecord { parts: [2 * k, 2 * k + 1], kind, probability: 0.97, missed_by: 0.0, u: 0.1 };
        let pairs: Vec<RelationRecord> = (0..20).map(pair).collect();
        let line = &relation_lines(&pairs)[0];
        assert!(line.ends_with("22 and 23 (97 % each), and 8 more pairs, which --json names"), "{line}");
    }
}
