//! Contacts cut into parts, before these are fitted exactly and described.
//!
//! ```text
//! of all contacts                       regions of the whole or of the cut cloud
//! of contacts spread over very many     the same, given to all of them
//! ```

use palpate_geometry::contact::{Contacts, Rounding};
use palpate_geometry::neighbours::NeighbourLists;

use super::agreeing_sides::agree;
use super::answer::{CutBy, Findings, Origin};
use super::cloud::{Cloud, FEWEST_POINTS};
use super::error::PartsError;
use super::options::PartsOptions;
use super::ordered_contacts::{OrderedContacts, in_input_order};
use super::partition::{Field, NONE, Partition};
use super::result::Parts;
use super::settling::{given_to_all, partition};
use super::sided_normals::{Sided, normals, told_side};
use super::surveyed::{LetPass, Surveyed};
use super::tuning::PartsTuning;
use super::{volume, whole};
use crate::primitives::placed::PartKind;

/// A cloud, and which part each contact is of.
pub(super) struct Segmentation {
    all: Surveyed,
    /// The contacts' numbers in the input.
    numbers: Vec<u32>,
    partition: Partition,
    by: CutBy,
    notes: Vec<String>,
}

impl Segmentation {
    /// Cuts contacts.
    pub(super) fn of(contacts: &Contacts, options: &PartsOptions) -> Result<Segmentation, PartsError> {
        options.check()?;
        contacts.check()?;
        if contacts.len() < FEWEST_POINTS {
            return Err(PartsError::TooFew { contacts: contacts.len(), needed: FEWEST_POINTS });
        }
        let (tuning, mut notes) = (&options.tuning, Vec::new());
        let OrderedContacts { places, normals: given, numbers } = OrderedContacts::new(contacts);
        let near = NeighbourLists::new(&places);
        let Sided { normals, estimated, side_known } = normals(&places, given, &near, options, &mut notes)?;
        let measured = estimated.is_none();
        if !measured && let Some(power) = volume::filled(&places, tuning) {
            return Err(PartsError::Volume { power });
        }
        let cloud =
            Cloud::among(&places, normals, near).ok_or(PartsError::NoExtent)?.rounded(Rounding::of_contacts(contacts));
        let pass = LetPass::new(&cloud, options.tolerance, !measured, tuning);
        let mut all = Surveyed::new(cloud, &pass, tuning);
        let field = all.field(tuning);
        let question = PartsQuestion { measured, tolerance: options.tolerance };
        let (mut partition, field, origin) = match &all.spread {
            None => question.of(&field),
            Some(spread) => question.of_spread(spread, &field),
        };
        let (coarse, limit) = (field.coarse, partition.sheet_limit(&field));
        let (tolerance, along) = (field.pass.distance, field.along());
        let side_known = match estimated {
            Some(why) => {
                let is_open = options.viewpoint.is_none();
                let agreeing = is_open.then(|| agree(&mut partition, &mut all.cloud, coarse.distance, tuning));
                told_side(why, agreeing.as_ref().unwrap_or(&all.cloud.normals), options.viewpoint, &mut notes)
            }
            None => side_known,
        };
        let by = CutBy { coarse, along, tolerance, limit, measured, side_known, origin };
        Ok(Segmentation { all, numbers, partition, by, notes })
    }

    /// Share of the contacts in parts of simple kinds: rings and ellipsoids follow the pieces of any smooth surface.
    pub(super) fn held_by_simple_kinds(&self) -> f64 {
        let Partition { parts, labels } = &self.partition;
        let is_held = |label: &&u32| parts.get(**label as usize).is_some_and(|part| is_simple(part.kind));
        labels.iter().filter(is_held).count() as f64 / labels.len() as f64
    }

    /// The whole answer.
    pub(super) fn parts(self, tuning: &PartsTuning) -> Parts {
        let Segmentation { all, numbers, partition, by, notes } = self;
        let Surveyed { cloud, shapes, noise, cells, .. } = &all;
        let findings = Findings { cloud, shapes, noise: *noise, cells, by: &by, tuning };
        let found = findings.parts(partition, notes);
        Parts { labels: in_input_order(&numbers, &found.labels), ..found }
    }
}

/// Whether a kind does not follow the pieces of any smooth surface.
pub(super) fn is_simple(kind: PartKind) -> bool {
    !matches!(kind, PartKind::Patch | PartKind::Torus | PartKind::Ellipsoid)
}

/// How a cloud is asked for its parts.
struct PartsQuestion {
    /// Whether the normals are measurements.
    measured: bool,
    /// What departures are let pass, where the user names it.
    tolerance: Option<f64>,
}

impl PartsQuestion {
    /// What a cloud is made of, and what it was cut by.
    fn of<'a>(&self, field: &Field<'a>) -> (Partition, Field<'a>, Origin) {
        let (found, fine, origin, _) = self.looked(field);
        (found, fine, origin)
    }

    /// The same, with what share of its size is let pass.
    fn looked<'a>(&self, field: &Field<'a>) -> (Partition, Field<'a>, Origin, f64) {
        let once = |(found, fine, origin): (Partition, Field<'a>, Origin)| (found, fine, origin, 0.0);
        if self.tolerance.is_some() || field.shared {
            return once(of_whole_or_cut(self.measured, field, None));
        }
        let at_coarser_looks = |finer: &Partition| {
            finer.at_coarser_looks(field, cut).map(|(found, fine, share)| (found, fine, Origin::Cut, share))
        };
        // where normals are not measured, what is one surface is known before
        if !self.measured {
            let found = of_whole_or_cut(self.measured, field, None);
            return at_coarser_looks(&found.0).unwrap_or_else(|| once(found));
        }
        let found = cut(field);
        at_coarser_looks(&found.0).unwrap_or_else(|| once(of_whole_or_cut(self.measured, field, Some(found))))
    }

    /// What contacts spread over a large cloud are made of, and all of them by that.
    fn of_spread<'a>(&self, spread: &Surveyed, field: &Field<'a>) -> (Partition, Field<'a>, Origin) {
        let (found, _, origin, share) = self.looked(&spread.field(field.tuning));
        let (mut found, field) = given_to_all(found, &spread.cloud, &field.letting_pass(share));
        found.drop_strips(&field);
        found.drop_strays(&field);
        (found, field, origin)
    }
}

/// The primitives of the whole cloud where they tell it more shortly than its parts do; and where they are from. They are asked for where
/// the parts leave room for doubt; where neighbours share errors first, and are the answer if they hold nearly all.
fn of_whole_or_cut<'a>(
    measured: bool,
    field: &Field<'a>,
    known: Option<(Partition, Field<'a>)>,
) -> (Partition, Field<'a>, Origin) {
    let whole = || {
        let mut whole = whole::whole(field, measured)?;
        whole.simplify(field);
        // facets of one body may be told as several of its size
        whole.join(field);
        whole.drop_strips(field);
        Some(whole)
    };
    let first = if field.shared { whole() } else { None };
    if let Some(whole) = first.as_ref().filter(|whole| whole.holds_nearly_all(field.tuning)) {
        return (whole.clone(), *field, Origin::Whole);
    }
    let (cut, fine) = known.unwrap_or_else(|| cut(field));
    let has_doubt = !measured && cut.parts.len() > 1;
    if let Some(one) = has_doubt.then(|| whole::one(&cut, field)).flatten() {
        return (one, *field, Origin::Whole);
    }
    if !field.shared && cut.is_beyond_doubt(&fine) {
        return (cut, fine, Origin::Cut);
    }
    if has_doubt && whole::is_free(&cut, field) {
        return (Partition { parts: Vec::new(), labels: vec![NONE; field.cloud.len()] }, *field, Origin::Free);
    }
    let length = |of: &Partition| of.description_length(field.cloud, field.tuning);
    // where every contact has a normal of its own, these tell as much as the places
    let has_normals = field.has_clear_normals();
    let tells_more = |whole: &Partition| {
        if has_normals { !cut.outtells(whole, field) } else { length(whole) <= length(&cut) }
    };
    let whole = first.or_else(whole).filter(tells_more);
    whole.map_or((cut, fine, Origin::Cut), |whole| (whole, *field, Origin::Whole))
}

/// Regions that grow, and nothing that waves or strips make of them.
fn cut<'a>(field: &Field<'a>) -> (Partition, Field<'a>) {
    let (mut partition, field) = partition(field);
    let field = &field;
    partition.drop_waves(field);
    partition.merge_by_evidence(field);
    partition.drop_strips(field);
    partition.drop_strays(field);
    (partition, *field)
}
