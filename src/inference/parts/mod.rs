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

mod answer;
mod cloud;
mod correlated_noise;
mod correlated_noise_merge;
mod error;
mod evaluation;
mod evidence;
mod exact;
mod free_form;
mod hypothesis;
mod jet;
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
mod unexplained_regions;
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

use palpate_geometry::contact::Contacts;
use palpate_geometry::neighbours::{Oriented, oriented};
use palpate_numeric::vector::{Vector, dot, minus, norm, scaled};

use answer::Findings;
use cloud::{Cloud, FEWEST_POINTS};
use evidence::Cells;
use local::{Noise, local_shapes};
use partition::{Field, Partition, partition};

/// A share of the cloud's size (rms distance from its middle) that a departure must exceed to be a part. Scanners' errors that
/// many neighbours share are as large; with a third of it, a pipe seen by a depth camera falls into a dozen parts.
const UNSEEN: f64 = 0.003;
/// The same in spacings: contacts do not resolve less.
const UNRESOLVED: f64 = 0.1;
/// Departures of normals that go with it, in degrees.
const UNSEEN_DEG: f64 = 1.0;
/// The same for normals that were estimated from positions: next to an edge they lie between those of both faces.
const BLURRED_DEG: f64 = 15.0;

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
    if contacts.len() < FEWEST_POINTS {
        return Err(PartsError::TooFew { contacts: contacts.len(), needed: FEWEST_POINTS });
    }
    let mut notes = Vec::new();
    let points: Vec<Vector> = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
    let estimated = contacts.unit_normal(0).is_none();
    let normals = normals(contacts, &points, options, &mut notes)?;
    let cloud = Cloud::new(&points, normals).ok_or(PartsError::NoExtent)?;
    let (noise, shapes) = local_shapes(&cloud);
    let tolerance = options.tolerance.map_or((UNRESOLVED * cloud.spacing).max(UNSEEN), |t| t / cloud.scale);
    let wide = correlated_noise::wide_noise(&cloud, &shapes, &noise);
    let unseen_deg = if estimated { BLURRED_DEG } else { UNSEEN_DEG };
    let coarse = Noise { distance: wide.distance.hypot(tolerance), normal: wide.normal.hypot(unseen_deg.to_radians()) };
    let floor = if estimated { Noise { normal: coarse.normal, ..wide } } else { wide };
    let pass = Noise { distance: tolerance, normal: unseen_deg.to_radians() };
    let field =
        Field { cloud: &cloud, shapes: &shapes, noise: &floor, coarse: &coarse, pass, cells: Cells::new(&cloud) };
    let mut whole = whole::whole(&cloud, !estimated, &coarse);
    whole.iter_mut().for_each(|whole| whole.simplify(&field));
    let (found, is_whole) = of_whole_or_cut(whole, &field);
    let (cloud, shapes, cells) = (&cloud, shapes.as_slice(), &field.cells);
    let measured = !estimated;
    Ok(Findings { cloud, shapes, noise, coarse, tolerance, cells, measured, is_whole }.parts(found, notes))
}

/// The primitives of the whole cloud where they hold nearly all of it, or tell it more shortly than its parts do; and whether it is they.
fn of_whole_or_cut(whole: Option<Partition>, field: &Field) -> (Partition, bool) {
    match whole {
        Some(whole) if whole.holds_nearly_all() => (whole, true),
        whole => {
            let cut = cut(field);
            let length = cut.description_length(field.cloud);
            let whole = whole.filter(|whole| whole.description_length(field.cloud) < length);
            whole.map_or((cut, false), |whole| (whole, true))
        }
    }
}

fn cut(field: &Field) -> Partition {
    let mut partition = partition(field);
    if correlated_noise_merge::absorb(&mut partition, field) {
        partition.refit(field);
    }
    partition
}

/// Unit normals on one side, from the file or from the positions.
fn normals(
    contacts: &Contacts,
    points: &[Vector],
    options: &PartsOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<Vector>, PartsError> {
    let given: Option<Vec<Vector>> = (0..contacts.len()).map(|r| contacts.unit_normal(r)).collect();
    if let Some(normals) = given {
        let Oriented { normals, consistent, flipped: turned, .. } = oriented(points, normals, None);
        if !consistent {
            return Err(PartsError::Normals);
        }
        if turned > 0 {
            notes.push(format!(
                "{turned} of {} normals point to the other side than their neighbours' and were reversed",
                points.len()
            ));
        }
        return Ok(normals);
    }
    let estimated = contacts.with_estimated_normals(options.viewpoint)?;
    let mut normals: Vec<Vector> = (0..contacts.len()).filter_map(|r| estimated.unit_normal(r)).collect();
    let mut side = options.viewpoint.map_or("upwards", |_| "towards the viewpoint");
    if options.viewpoint.is_none() && goes_round(&normals) {
        side = "outwards";
        if !points_outwards(points, &normals) {
            normals.iter_mut().for_each(|n| *n = scaled(-1.0, *n));
        }
    }
    notes.push(format!(
        "there are no normals; they were estimated from planes through neighbours and point {side}; a convex and a concave joint \
         change places if that is the wrong side"
    ));
    Ok(normals)
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
