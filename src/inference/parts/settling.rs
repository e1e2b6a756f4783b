//! Regions grown and settled, and again among what they leave, until nothing changes.
//!
//! ```text
//! grow, settle; scatter about the parts in place of what neighbourhoods show; drop what is not explained; grow there; settle
//! ```

use super::cloud::Cloud;
use super::growth::grown;
use super::local::{Noise, ROUNDING};
use super::partition::{Field, NONE, Partition, ROUNDS, SWEEPS};
use super::scatter::PartsScatter;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::threads;

/// Contacts without noise.
const EXACT: Noise = Noise { distance: ROUNDING, normal: ROUNDING };

/// Cuts the cloud into parts; and what contacts scatter by about them, in place of what neighbourhoods show. Where contacts are few,
/// neighbourhoods reach over edges, and faces that are small beside them begin only when the large ones are known.
pub(super) fn partition<'a>(field: &Field<'a>) -> (Partition, Field<'a>) {
    let nothing = Partition { parts: Vec::new(), labels: vec![NONE; field.cloud.len()] };
    let mut found = settled(grown(nothing, field, None), field);
    let mut field = *field;
    // where neighbours share errors, what no part explains is their waves
    let again = if field.shared { 0 } else { field.tuning.again };
    for _ in 0..again {
        let (next, fine) = looked_again(found, &mut field, false);
        found = next;
        if !fine {
            break;
        }
    }
    (found, field)
}

/// The parts of contacts that were spread over a large cloud, given to all of it, with those that only all contacts show.
pub(super) fn given_to_all<'a>(found: Partition, spread: &Cloud, field: &Field<'a>) -> (Partition, Field<'a>) {
    let mut field = *field;
    let tree = Neighbours::new(&spread.points);
    let label =
        |i: usize| tree.nearest(field.cloud.points[i], 1).first().map_or(NONE, |near| found.labels[near.1 as usize]);
    let labels = threads::map(field.cloud.len(), 256, label);
    let mut all = Partition { labels, parts: found.parts };
    let scatter = PartsScatter::common(field.coarse, field.along());
    (0..SWEEPS).for_each(|_| all.relabel(&field, &scatter));
    all.drop_small();
    let (all, _) = looked_again(all, &mut field, true);
    (all, field)
}

/// Parts beside those that there are, all settled by what contacts scatter about them; and whether anything was new.
fn looked_again(mut found: Partition, field: &mut Field, on_sheets: bool) -> (Partition, bool) {
    let common = found.scatter(&Field { noise: EXACT, ..*field }).common;
    let shown = Noise {
        distance: common.distance.hypot(field.pass.distance).min(field.coarse.distance),
        normal: common.normal.hypot(field.pass.normal).min(field.coarse.normal),
    };
    let finer = field.tuning.finer;
    let is_finer = shown.distance < finer * field.coarse.distance || shown.normal < finer * field.coarse.normal;
    field.coarse = shown;
    field.noise.distance = field.noise.distance.min(common.distance);
    found.drop_strays(field);
    let before = found.parts.len();
    let limit = on_sheets.then(|| found.sheet_limit(field));
    found = grown(found, field, limit.as_ref());
    if !on_sheets && !is_finer && found.parts.len() == before {
        return (found, false);
    }
    (settled(found, field), true)
}

/// Parts whose edges and sizes follow each other until nothing changes.
fn settled(mut partition: Partition, field: &Field) -> Partition {
    for round in 0..ROUNDS {
        let before = partition.labels.clone();
        partition.refit(field);
        let scatter =
            if round > 0 { partition.scatter(field) } else { PartsScatter::common(field.coarse, field.along()) };
        (0..SWEEPS).for_each(|_| partition.relabel(field, &scatter));
        partition.drop_small();
        let joined = partition.join(field);
        if !joined && round > 1 && same(&before, &partition.labels) {
            break;
        }
    }
    partition.refit(field);
    partition.sharpen(field);
    partition
}

/// All but one point in a thousand have the label that they had.
fn same(before: &[u32], after: &[u32]) -> bool {
    1000 * before.iter().zip(after).filter(|(a, b)| a != b).count() <= before.len()
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions, PartsTuning};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::vector::Vector;

    /// Two faces of 40 by 40 contacts and between them a step of 40 by 6, of which a tenth of the contacts shows next to nothing: the
    /// faces are found on part of the contacts, all contacts are given to them, and the step is found among what these leave.
    #[test]
    fn what_part_of_a_cloud_does_not_show_is_found_among_the_rest() {
        let face = |k: u32, width: u32| (f64::from(k % width) + 0.5, f64::from(k / width));
        let low = (0..1600).map(|k| face(k, 40)).map(|(s, y)| ([-s, y, 0.0], [0.0, 0.0, 1.0]));
        let step = (0..240).map(|k| face(k, 6)).map(|(s, y)| ([0.0, y, s], [-1.0, 0.0, 0.0]));
        let high = (0..1600).map(|k| face(k, 40)).map(|(s, y)| ([s, y, 6.0], [0.0, 0.0, 1.0]));
        let (points, normals): (Vec<Vector>, Vec<Vector>) = low.chain(step).chain(high).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let tuning = PartsTuning { decided_on: 340, ..PartsTuning::default() };
        let found = Parts::of(&contacts, &PartsOptions { tuning, ..PartsOptions::default() }).unwrap();
        assert_eq!(found.parts.iter().map(|part| part.kind).collect::<Vec<_>>(), [PartKind::Plane; 3]);
        assert!(found.parts[2].points > 200, "{:?}", found.parts[2]);
        assert!(found.labels[..1500].iter().all(|label| *label == found.labels[0]));
    }
}
