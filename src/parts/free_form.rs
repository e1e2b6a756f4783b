//! A region that no primitive explains, by a spline of its own: S, R and their uncertainties.
//!
//! ```text
//! z = S(x, y)    over the region's own plane: cubic, with as many segments as predict left-out contacts, or quadratic where
//!                these are too few
//! S, R    means over what the region's contacts support        u    from the noise of the contacts
//! ```
//!
//! A region that bends so far that its normals do not share a side has no such plane, and keeps the means over its contacts.

use super::cloud::Cloud;
use crate::contact::Contacts;
use crate::fit::{Fit, FitOptions, Statistic, fit_contacts_over};
use crate::recognition::{RecognitionOptions, flexible, own_axes};
use crate::vector::{Vector, norm};

/// Mean unit normals shorter than this belong to a region that bends too far for one height field.
const ONE_SIDED: f64 = 0.6;

/// Share of the relief that a field may leave at contacts left out.
const PREDICTED: f64 = 0.5;

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

/// The spline through these members; `None` where no height field follows them.
pub(super) fn free_form(cloud: &Cloud, members: &[u32]) -> Option<FreeForm> {
    let [points, normals] = [&cloud.points, &cloud.normals]
        .map(|all| -> Vec<Vector> { members.iter().map(|&i| all[i as usize]).collect() });
    let sum = normals.iter().fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    if norm(sum) < ONE_SIDED * normals.len() as f64 {
        return None;
    }
    let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
    let axes = own_axes(&contacts, &RecognitionOptions::default())?;
    let options = FitOptions::default();
    let fit = match flexible(&contacts, axes, &options) {
        Some(field) => field.ok().filter(|field| field.error < PREDICTED * field.relief)?.fit,
        None => fit_contacts_over(&contacts, axes, &options).ok()?,
    };
    described(&fit)
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
