//! What a parametric fit leaves behind: the surface, the feet, the factor, and what they were found with.

use super::cells::Cells;
use super::descent::Solver;
use super::foot_point::Feet;
use super::patch_contacts::PatchContacts;
use super::problem::Weights;
use crate::fit::FitOptions;
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::UvSupport;
use palpate_geometry::surface::Parametric;

/// The data of a finished fit, in patch units.
#[derive(Clone, Debug)]
pub(super) struct FitData {
    /// Options of the fit.
    pub options: FitOptions,
    /// The patch in the input.
    pub frame: Frame,
    /// The surface.
    pub surface: Parametric,
    /// Its knots and the numbering of its coefficients.
    pub cells: Cells,
    /// The contacts with their final weights.
    pub contacts: PatchContacts,
    /// Their feet.
    pub feet: Feet,
    /// Noise sds and weights of the objective.
    pub weights: Weights,
    /// The undamped factor at the minimum.
    pub solver: Solver,
    /// Where contacts reach.
    pub support: UvSupport,
    /// Contacts that stood for all until near the minimum, where there were many.
    pub standing: Option<usize>,
    /// Distance and difference of the normals, for every contact.
    pub residuals: Vec<[f64; 2]>,
}
