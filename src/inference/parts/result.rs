//! The answer: parts, joints, and the part of every contact.

use super::joints::Joint;
use crate::primitives::placed::PartKind;
use palpate_geometry::curvature::ShapeClass;

/// Lengths and places of a part, in the contacts' units and axes; what its kind does not have is `None`. Of its standard
/// uncertainties the same, with `axis_deg` for the direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartGeometry {
    /// A point of the plane or of the axis next to the part's middle; the centre of a sphere or torus; the middle of a patch.
    pub point: [f64; 3],
    /// Normal of a plane, axis of the others. Of a cone: the way in which it widens.
    pub axis: Option<[f64; 3]>,
    /// Radius of sphere and cylinder, of a cone at `point`, of a torus' ring.
    pub radius: Option<f64>,
    /// Radius of a torus' tube.
    pub minor_radius: Option<f64>,
    /// Half angle of a cone, degrees.
    pub half_angle_deg: Option<f64>,
    /// Tip of a cone.
    pub apex: Option<[f64; 3]>,
}

/// Standard uncertainties of a part's geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartUncertainty {
    /// Of the point: across the plane or the axis only, since along it any point is as good.
    pub point: Option<f64>,
    /// Of the normal or the axis, degrees in each direction.
    pub axis_deg: Option<f64>,
    /// Of the radius.
    pub radius: Option<f64>,
    /// Of the tube's radius.
    pub minor_radius: Option<f64>,
    /// Of the half angle, degrees.
    pub half_angle_deg: Option<f64>,
    /// Of the mean S, where the kind leaves it open (torus, patch) or the contacts may show another surface.
    #[cfg_attr(feature = "serde", serde(rename = "S"))]
    pub shape_index: Option<f64>,
    /// Of the mean R.
    #[cfg_attr(feature = "serde", serde(rename = "R"))]
    pub curvedness: Option<f64>,
}

/// One part of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its number, from 0, that of the part with the most contacts.
    pub id: usize,
    /// Primitive or patch.
    pub kind: PartKind,
    /// Seen from inside, as a bore.
    pub hollow: bool,
    /// Where it lies and how large it is.
    pub geometry: PartGeometry,
    /// How sure that is.
    pub u: PartUncertainty,
    /// Class by the mean S; `None` where S is undefined and the part no plane.
    pub class: Option<ShapeClass>,
    /// What it is from the other side, where neither normals nor a viewpoint nor a body that closes tell which is free.
    pub other_class: Option<ShapeClass>,
    /// Mean S over its contacts; of a plane `None`.
    pub shape_index: Option<f64>,
    /// Mean R over its contacts.
    pub curvedness: f64,
    /// Contacts.
    pub points: usize,
    /// How far they reach: about the largest distance between two of them.
    pub extent: f64,
    /// Root mean square distance of the inner contacts from the primitive; of a patch, from its spline, or from the surfaces
    /// through neighbours where none follows it.
    pub misfit: f64,
    /// Whether the data reject the primitive at 1 %; `None` for patches and where contacts are too few to tell.
    pub rejected: Option<bool>,
    /// Probability of so large a lack of fit by chance.
    pub p: Option<f64>,
    /// Root mean square departure from the primitive that noise does not explain.
    pub departure: f64,
}

/// A cloud cut into parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// Largest first.
    pub parts: Vec<Part>,
    /// Where they meet.
    pub joints: Vec<Joint>,
    /// The part of every contact; `None` for those that belong to none.
    pub labels: Vec<Option<u32>>,
    /// Median distance between neighbouring contacts.
    pub spacing: f64,
    /// Standard deviation of contacts along the normal, as neighbourhoods show it.
    pub noise: f64,
    /// Standard deviation of normals in each tangent direction, degrees.
    pub normal_noise_deg: f64,
    /// Departures along the normal that were let pass while parts were looked for.
    pub tolerance: f64,
    /// What a user should know.
    pub notes: Vec<String>,
}
