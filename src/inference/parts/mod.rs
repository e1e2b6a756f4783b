//! What a body is made of: its parts, each a plane, ball, bar, cone or ring where the contacts allow, and how they adjoin.
//!
//! ```text
//! contacts in the order of space -> neighbours -> surface about each contact, noise -> regions grown from the smoothest places
//!          -> fit, relabel, join, until nothing changes -> one surface where errors that neighbours share explain two
//!          -> exact primitives with u and a test -> joints
//! energy = sum_contacts cost / 2 + (pairs of neighbours in different parts) + (unknowns) ln(rows) / 2
//! ```
//!
//! A contact costs what its distance and its normal contradict the part. Boundaries lie where that sum is least, at edges
//! and at joints that are smooth. The order of the contacts changes no number, since they are looked at along a curve through space.
//! Place and unit do not matter; in another direction that curve is another, and of many contacts others are asked where some suffice.
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
mod agreeing_sides;
mod answer;
mod cell_means;
mod cloud;
mod coarser_look;
mod correlated_likelihood;
mod correlated_noise;
mod covariance_of_unknowns;
mod delta_method;
mod error;
mod estimated;
mod evaluation;
mod evidence;
mod evidence_merge;
mod exact;
mod few_touches;
mod free_form;
mod growth;
mod hypothesis;
mod jet;
mod jet_neighbourhood;
mod joining;
mod joint_angle;
mod joints;
mod lack_of_fit_uncertainty;
mod local;
mod neighbour_products;
mod object_match;
mod options;
mod ordered_contacts;
mod pair_geometry;
mod partition;
mod point_shapes;
mod recognition_fallback;
mod relations;
mod result;
mod rival;
mod scale_selection;
mod scatter;
mod segmentation;
mod settling;
mod shared_errors;
mod sharpening;
mod sheet;
mod sided_normals;
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
use palpate_numeric::vector::Vector;

use few_touches::one_of_few;
use segmentation::Segmentation;

impl Parts {
    /// Cuts contacts into parts.
    ///
    /// # Errors
    /// When the contacts are faulty, too few, in one place, or their normals are none.
    pub fn of(contacts: &Contacts, options: &PartsOptions) -> Result<Parts, PartsError> {
        match Segmentation::of(contacts, options) {
            Ok(cut) => Ok(cut.parts(&options.tuning)),
            Err(too_few @ PartsError::TooFew { .. }) => {
                let normals: Option<Vec<Vector>> = (0..contacts.len()).map(|r| contacts.unit_normal(r)).collect();
                let tuning = &options.tuning.recognition;
                one_of_few(contacts, &normals.unwrap_or_default(), Vec::new(), tuning).ok_or(too_few)
            }
            Err(error) => Err(error),
        }
    }
}
