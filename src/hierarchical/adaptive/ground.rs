//! What a fit begins with: frame, base grid and weights, from where the contacts are and how many.

use super::options::{AdaptiveOptions, RowVariances};
use crate::equations::{BlockWeights, patch_frame};
use crate::error::HierarchyError;
use crate::mesh::Mesh;
use palpate_geometry::contact::{Contacts, Frame};
use palpate_numeric::bspline::Knots;

/// Where contacts are, and how many; input units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactBounds {
    /// Contacts.
    pub count: usize,
    /// Least and largest x.
    pub x: [f64; 2],
    /// Least and largest y.
    pub y: [f64; 2],
    /// Least and largest z.
    pub z: [f64; 2],
}

impl ContactBounds {
    /// No contacts.
    pub const NONE: ContactBounds = {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        ContactBounds { count: 0, x: none, y: none, z: none }
    };

    /// Those of some contacts.
    pub fn of(contacts: &Contacts) -> ContactBounds {
        ContactBounds { count: contacts.len(), x: ends(&contacts.x), y: ends(&contacts.y), z: ends(&contacts.z) }
    }

    /// Those of both.
    #[must_use]
    pub fn with(self, other: ContactBounds) -> ContactBounds {
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let (x, y, z) = (both(self.x, other.x), both(self.y, other.y), both(self.z, other.z));
        ContactBounds { count: self.count + other.count, x, y, z }
    }
}

/// Least and largest number.
fn ends(column: &[f64]) -> [f64; 2] {
    column.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(*v), hi.max(*v)])
}

/// Frame, base grid and first weights of a fit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FitGround {
    pub frame: Frame,
    pub mesh: Mesh,
    pub weights: BlockWeights,
    /// Variance of a height of weight 1 that was declared, patch units.
    pub declared: Option<f64>,
}

impl FitGround {
    /// Checks the options, too.
    pub(crate) fn of(bounds: &ContactBounds, options: &AdaptiveOptions) -> Result<FitGround, HierarchyError> {
        options.check()?;
        let domain = options.domain.unwrap_or([bounds.x, bounds.y]);
        let frame = patch_frame(domain, bounds.z);
        let mesh = base_mesh(domain, &frame, bounds.count, options)?;
        let (weights, declared) = match options.noise {
            RowVariances::Known { heights, slopes } => {
                let heights = heights / frame.scale;
                (BlockWeights { heights: 1.0, slopes: (heights / slopes).powi(2) }, Some(heights * heights))
            }
            RowVariances::Estimated => (BlockWeights { heights: 1.0, slopes: 1.0 }, None),
        };
        Ok(FitGround { frame, mesh, weights, declared })
    }
}

/// The base grid of nearly square cells in the patch's frame, no more of them than contacts can tell about.
fn base_mesh(
    domain: [[f64; 2]; 2],
    frame: &Frame,
    contacts: usize,
    options: &AdaptiveOptions,
) -> Result<Mesh, HierarchyError> {
    let [x, y] = domain;
    let sides = domain.map(|[lo, hi]| hi - lo);
    if !sides.iter().all(|side| side.is_finite() && *side > 0.0) {
        return Err(HierarchyError::Flat { x0: x[0], x1: x[1], y0: y[0], y1: y[1] });
    }
    let larger = sides[0].max(sides[1]);
    let supported = (contacts as f64 / options.least_contacts.max(1) as f64).sqrt().ceil().max(1.0) as usize;
    let along = options.base_segments.min(supported);
    let axis = |k: usize| {
        let segments = (along as f64 * sides[k] / larger).round().max(1.0) as usize;
        let [lo, hi] = domain[k].map(|t| (t - frame.origin[k]) / frame.scale);
        let name = if k == 0 { "x" } else { "y" };
        Knots::uniform(options.degree, segments, lo, hi).map_err(|source| HierarchyError::Knots { axis: name, source })
    };
    Mesh::new([axis(0)?, axis(1)?])
}
