//! What ties the parts of a body: records, lines of the table, and the page's section.

use std::fmt::Write as _;

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

/// One line a kind: which pairs, and how probable.
pub(crate) fn relation_lines(relations: &[RelationRecord]) -> Vec<String> {
    let of_kind = |these: &[RelationRecord]| {
        let mut these = these.to_vec();
        these.sort_by(|a, b| per_cent(b).total_cmp(&per_cent(a)).then(a.parts.cmp(&b.parts)));
        let mut line = format!("{}: ", these[0].kind.name());
        for (k, pairs) in these.chunk_by(|a, b| per_cent(a) == per_cent(b)).enumerate() {
            let pair = |r: &RelationRecord| format!("{} and {}", r.parts[0], r.parts[1]);
            let named: Vec<String> = pairs.iter().map(pair).collect();
            let each = if pairs.len() > 1 { " each" } else { "" };
            let between = if k > 0 { ", " } else { "" };
            let _ = write!(line, "{between}{} ({}{each})", named.join(", "), chance(pairs[0].probability));
        }
        line
    };
    relations.chunk_by(|a, b| a.kind == b.kind).map(of_kind).collect()
}

/// Probabilities that are said alike are alike.
fn per_cent(relation: &RelationRecord) -> f64 {
    (100.0 * relation.probability).round()
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
}
