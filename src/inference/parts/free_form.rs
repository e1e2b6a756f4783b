//! A region that no primitive explains, by a spline of its own: S, R and their uncertainties.
//!
//! ```text
//! z = S(x, y)    over the region's own plane: cubic, with as many segments as predict left-out contacts, or quadratic where
//!                these are too few
//! S, R    means over what the region's contacts support        u    from the noise of the contacts
//! rich    quartic, with 1, 2 or 3 segments each way by the number of contacts, whether or not these predict others
//! ```
//!
//! A region that bends so far that its normals do not share a side has no such plane, and keeps the means over its contacts.

use super::cloud::Cloud;
use super::hypothesis::sampled;
use super::tuning::PartsTuning;
use crate::recognition::{FieldChoice, RecognitionOptions, flexible, own_axes};
use palpate_fitting::fit::{Fit, FitOptions, Smooth, Statistic, fit_contacts_over};
use palpate_geometry::contact::Contacts;
use palpate_numeric::vector::{Vector, norm};

/// What the spline says, in the cloud's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FreeForm {
    /// Mean S with its standard uncertainty; `None` where it is flat.
    pub(super) shape_index: Option<(f64, Option<f64>)>,
    /// Mean R with its standard uncertainty.
    pub(super) curvedness: (f64, Option<f64>),
    /// Root mean square of the heights that are left over.
    pub(super) misfit: f64,
}

/// Contacts from which a rich field has so many segments each way. With more segments for as few, u(R) doubles; with one for
/// thousands, the field follows a bump no better than a ring does.
const RICH: [(usize, usize); 3] = [(600, 3), (200, 2), (0, 1)];

/// Degree of a rich field: what a ball or a ring lacks of a bump begins in the third and fourth.
const RICH_DEGREE: usize = 4;

/// So little smoothing that it only makes the rank full: corners that no contact of a round region reaches would otherwise take most of the
/// time of a scan, by the turns of least roughness.
const FAINT: Smooth = Smooth::Lambda(1e-9);

/// Contacts that a rich field is fitted to. More know S and R better than the field can follow a surface.
const RICH_CONTACTS: usize = 3000;

/// The spline through these members; `None` where no height field follows them.
pub(super) fn free_form(cloud: &Cloud, members: &[u32], tuning: &PartsTuning) -> Option<FreeForm> {
    let (contacts, axes) = one_sided(cloud, members, usize::MAX, tuning)?;
    let (options, of_field) = (FitOptions::default(), &tuning.recognition);
    let fit = match flexible(&contacts, axes, &options, of_field) {
        Some(field) => field.ok().filter(|field| field.error < of_field.field_predicts * field.relief)?.fit,
        None => fit_contacts_over(&contacts, axes, &options).ok()?,
    };
    described(&fit)
}

/// How near a height field of some contacts, `most` at the most, comes to those left out; `None` where none follows them.
pub(super) fn predicted(cloud: &Cloud, most: usize, tuning: &PartsTuning) -> Option<f64> {
    let all: Vec<u32> = (0..cloud.len() as u32).collect();
    let (contacts, axes) = one_sided(cloud, &all, most, tuning)?;
    let of_field = &tuning.recognition;
    let field = FieldChoice::of(&contacts, axes, &FitOptions::default(), of_field)?;
    (field.error < of_field.field_predicts * field.relief).then_some(field.error)
}

/// A field that leaves S and R open, for doubt about a primitive; `None` where no height field follows the members.
pub(super) fn rich_form(cloud: &Cloud, members: &[u32], tuning: &PartsTuning) -> Option<FreeForm> {
    let (contacts, axes) = one_sided(cloud, members, RICH_CONTACTS, tuning)?;
    let segments = RICH.into_iter().find(|(from, _)| members.len() >= *from).map_or(1, |(_, segments)| segments);
    let of = |degree: usize, segments: usize| {
        let options = FitOptions::default().with_degree(degree).with_segments(segments, segments).with_smooth(FAINT);
        fit_contacts_over(&contacts, axes, &options).ok().and_then(|fit| described(&fit))
    };
    of(RICH_DEGREE, segments).or_else(|| of(RICH_DEGREE, 1)).or_else(|| of(RICH_DEGREE - 1, 1))
}

/// The members as contacts, at most so many, with the axes of their own plane; `None` where their normals share no side.
fn one_sided(cloud: &Cloud, members: &[u32], most: usize, tuning: &PartsTuning) -> Option<(Contacts, [Vector; 3])> {
    let (points, normals) = sampled(cloud, members, most);
    let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    if norm(sum) < tuning.field_one_sided * normals.len() as f64 {
        return None;
    }
    let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    let options = RecognitionOptions { tuning: tuning.recognition.clone(), ..RecognitionOptions::default() };
    let axes = own_axes(&contacts, &options)?;
    Some((contacts, axes))
}

fn described(fit: &Fit) -> Option<FreeForm> {
    let shape = fit.shape();
    let known = |part: &Statistic| part.mean.map(|mean| (mean, part.u));
    Some(FreeForm {
        shape_index: known(&shape.shape_index),
        curvedness: known(&shape.curvedness)?,
        misfit: fit.rms().z.unwrap_or(0.0),
    })
}
