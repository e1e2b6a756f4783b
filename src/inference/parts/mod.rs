//! What a body is made of: its parts, each a plane, ball, bar, cone or ring where the contacts allow, and how they adjoin.
//!
//! ```text
//! contacts -> neighbours -> surface about each contact, noise -> regions grown from the smoothest places
//!          -> fit, relabel, join, until nothing changes -> exact primitives with u and a test -> joints
//! energy = sum_contacts cost / 2 + (pairs of neighbours in different parts) + (unknowns) ln(rows) / 2
//! ```
//!
//! A contact costs what its distance and its normal contradict the part. Boundaries lie where that sum is least, at edges
//! and at joints that are smooth. Nothing is drawn at random, and the order, place, direction and unit of the contacts do not matter.
//!
//! ```
//! # use palpate_inference::facade as palpate;
//! use palpate::Contacts;
//! use palpate::parts::{PartKind, Parts, PartsOptions};
//!
//! // two faces of a box: z = 0 for x < 0, and x = 0 for z < 0
//! let place = |k: usize| ((k % 20) as f64 * 0.5 + 0.13 * ((k / 20) % 3) as f64, (k / 20) as f64 * 0.5);
//! let top = (0..400).map(place).map(|(s, y)| ([-0.2 - s, y, 0.0], [0.0, 0.0, 1.0]));
//! let side = (0..400).map(place).map(|(s, y)| ([0.0, y + 0.2, -0.2 - s], [1.0, 0.0, 0.0]));
//! let (points, normals): (Vec<_>, Vec<_>) = top.chain(side).unzip();
//! let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
//! let found = Parts::of(&contacts, &PartsOptions::default())?;
//! assert_eq!(found.parts.iter().map(|part| part.kind).collect::<Vec<_>>(), [PartKind::Plane; 2]);
//! assert!((found.joints[0].angle_deg - 90.0).abs() < 1e-6);
//! # Ok::<(), palpate::parts::PartsError>(())
//! ```

mod against_places;
mod answer;
mod cloud;
mod correlated_noise;
mod correlated_noise_merge;
mod error;
mod estimated;
mod evaluation;
mod evidence;
mod exact;
mod few_touches;
mod free_form;
mod growth;
mod hypothesis;
mod jet;
mod joining;
mod joints;
mod lack_of_fit_uncertainty;
mod local;
mod object_match;
mod options;
mod pair_geometry;
mod partition;
mod point_shapes;
mod recognition_fallback;
mod relations;
mod result;
mod rival;
mod scale_selection;
mod scatter;
mod settling;
mod shared_errors;
mod sheet;
mod surveyed;
mod tuning;
mod unexplained_regions;
mod volume;
mod waves;
mod whole;

pub use crate::primitives::placed::PartKind;
pub use error::PartsError;
pub use evaluation::boundary;
#[doc(hidden)]
pub use evaluation::{Agreement, against};
pub use joints::{Joint, JointKind};
#[doc(hidden)]
pub use object_match::{ObjectMatch, ObjectModel, ObjectPrior};
pub use options::PartsOptions;
pub use point_shapes::PointShapes;
#[doc(hidden)]
pub use relations::{Relation, RelationKind, RelationPrior};
pub use result::{Part, PartGeometry, PartUncertainty, Parts};
pub use tuning::PartsTuning;

use palpate_geometry::contact::Contacts;
use palpate_geometry::neighbours::{Oriented, oriented};
use palpate_numeric::vector::{Vector, dot, minus, norm, scaled};

use against_places::contradict;
use answer::{Findings, Origin};
use cloud::{Cloud, FEWEST_POINTS};
use few_touches::one_of_few;
use partition::{Field, NONE, Partition};
use settling::{given_to_all, partition};
use surveyed::{LetPass, Surveyed};

impl Parts {
    /// Cuts contacts into parts.
    ///
    /// # Errors
    /// When the contacts are faulty, too few, in one place, or their normals are none.
    pub fn of(contacts: &Contacts, options: &PartsOptions) -> Result<Parts, PartsError> {
        segment(contacts, options)
    }
}

fn segment(contacts: &Contacts, options: &PartsOptions) -> Result<Parts, PartsError> {
    options.check()?;
    contacts.check()?;
    let mut notes = Vec::new();
    let points: Vec<Vector> = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
    if contacts.len() < FEWEST_POINTS {
        let normals: Option<Vec<Vector>> = (0..contacts.len()).map(|r| contacts.unit_normal(r)).collect();
        let one = one_of_few(&points, &normals.unwrap_or_default(), notes);
        return one.ok_or(PartsError::TooFew { contacts: contacts.len(), needed: FEWEST_POINTS });
    }
    let Sided { normals, side_known, estimated } = normals(contacts, &points, options, &mut notes)?;
    if estimated && let Some(power) = volume::filled(&points, &options.tuning) {
        return Err(PartsError::Volume { power });
    }
    let cloud = Cloud::new(&points, normals).ok_or(PartsError::NoExtent)?;
    let pass = LetPass::new(&cloud, options.tolerance, estimated);
    let tuning = &options.tuning;
    let all = Surveyed::new(cloud, &pass, tuning);
    let field = all.field(tuning);
    let (found, field, origin) = match all.cloud.spread(tuning.decided_on).filter(|_| !field.shared) {
        None => of_whole_or_cut(!estimated, &field),
        Some(spread) => of_spread(!estimated, Surveyed::new(spread, &pass, tuning), &field),
    };
    let Surveyed { cloud, shapes, noise, cells, .. } = &all;
    let (coarse, tolerance, limit) = (field.coarse, pass.noise.distance, found.sheet_limit(&field));
    let (noise, measured) = (*noise, !estimated);
    Ok(Findings { cloud, shapes, noise, coarse, tolerance, cells, limit, measured, side_known, origin, tuning }
        .parts(found, notes))
}

/// What contacts spread over a large cloud are made of, and all of them by that.
fn of_spread<'a>(measured: bool, spread: Surveyed, field: &Field<'a>) -> (Partition, Field<'a>, Origin) {
    let (found, _, origin) = of_whole_or_cut(measured, &spread.field(field.tuning));
    let (mut found, field) = given_to_all(found, &spread.cloud, field);
    if correlated_noise_merge::absorb(&mut found, &field) {
        found.refit(&field);
    }
    found.drop_strips(&field);
    found.drop_strays(&field);
    (found, field, origin)
}

/// The primitives of the whole cloud where they tell it more shortly than its parts do; and where they are from. They are asked for where
/// the parts leave room for doubt; where neighbours share errors first, and are the answer if they hold nearly all.
fn of_whole_or_cut<'a>(measured: bool, field: &Field<'a>) -> (Partition, Field<'a>, Origin) {
    let whole = || {
        let mut whole = whole::whole(field.cloud, measured, &field.coarse)?;
        whole.simplify(field);
        whole.drop_strips(field);
        Some(whole)
    };
    let first = if field.shared { whole() } else { None };
    if let Some(whole) = first.as_ref().filter(|whole| whole.holds_nearly_all(field.tuning)) {
        return (whole.clone(), *field, Origin::Whole);
    }
    let (cut, fine) = cut(field);
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
    let length = cut.description_length(field.cloud);
    let whole = first.or_else(whole).filter(|whole| whole.description_length(field.cloud) <= length);
    whole.map_or((cut, fine, Origin::Cut), |whole| (whole, *field, Origin::Whole))
}

fn cut<'a>(field: &Field<'a>) -> (Partition, Field<'a>) {
    let (mut partition, field) = partition(field);
    let field = &field;
    if correlated_noise_merge::absorb(&mut partition, field) {
        partition.refit(field);
    }
    partition.drop_waves(field);
    partition.drop_strips(field);
    partition.drop_strays(field);
    (partition, *field)
}

/// Unit normals on one side, and whether something tells that it is the free one.
struct Sided {
    normals: Vec<Vector>,
    side_known: bool,
    /// Whether they are from the positions.
    estimated: bool,
}

/// Unit normals on one side, from the file or from the positions.
fn normals(
    contacts: &Contacts,
    points: &[Vector],
    options: &PartsOptions,
    notes: &mut Vec<String>,
) -> Result<Sided, PartsError> {
    let given: Option<Vec<Vector>> = (0..contacts.len()).map(|r| contacts.unit_normal(r)).collect();
    let why = match given {
        Some(normals) if contradict(points, &normals, &options.tuning) => "the file's normals contradict its places",
        Some(normals) => return of_file(points, normals, notes),
        None => "there are no normals",
    };
    let mut normals = estimated::estimated(points, options.viewpoint, &options.tuning);
    let closes = goes_round(&normals);
    if options.viewpoint.is_none() && closes && !points_outwards(points, &normals) {
        normals.iter_mut().for_each(|n| *n = scaled(-1.0, *n));
    }
    let (side_known, side) = match (options.viewpoint.is_some(), closes) {
        (true, _) => (true, "towards the viewpoint"),
        (false, true) => (true, "outwards"),
        (false, false) => (false, "upwards, though nothing tells which side is free"),
    };
    notes.push(format!(
        "{why}; they were estimated from planes through neighbours and point {side}; a convex and a concave joint \
         change places if that is the wrong side"
    ));
    Ok(Sided { normals, side_known, estimated: true })
}

/// The file's own, on one side.
fn of_file(points: &[Vector], normals: Vec<Vector>, notes: &mut Vec<String>) -> Result<Sided, PartsError> {
    let found = oriented(points, normals, None);
    let undecided = found.undecided();
    let Oriented { normals, consistent, flipped: turned, .. } = found;
    if !consistent {
        return Err(PartsError::Normals);
    }
    if turned > 0 {
        let of = points.len();
        notes
            .push(format!("{turned} of {of} normals point to the other side than their neighbours' and were reversed"));
    }
    if let Some(share) = undecided {
        notes.push(format!(
            "only {:.0} % of the signs of normals agree, so that nothing tells which side is free; a convex and a concave joint change \
             places if it is the other",
            100.0 * share
        ));
    }
    Ok(Sided { normals, side_known: undecided.is_none(), estimated: false })
}

/// Normals in all directions, as of a closed body.
fn goes_round(normals: &[Vector]) -> bool {
    let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    norm(sum) < 0.3 * normals.len() as f64
}

fn points_outwards(points: &[Vector], normals: &[Vector]) -> bool {
    let count = points.len() as f64;
    let mean = points.iter().fold([0.0; 3], |sum, p| [0, 1, 2].map(|k| sum[k] + p[k] / count));
    points.iter().zip(normals).map(|(p, n)| dot(minus(*p, mean), *n)).sum::<f64>() > 0.0
}
