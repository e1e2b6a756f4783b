//! What is described: the data and what is known of them, and the surface that was found for them.

use palpate_fitting::fit::Fit;
use palpate_fitting::parametric::ParametricFit;
use palpate_inference::recognition::Recognition;
use palpate_world::scene::Truth;

use super::adaptive_answer::AdaptiveAnswer;
use super::document::{ChosenPart, LackOfFitPart};
use super::surface_maps::Maps;
use crate::io::Input;

/// What a surface was described from.
pub(super) enum Source<'a> {
    /// A file, with its maps over the grid that is shown.
    Saved(Box<Maps<'a>>),
    /// A height field that was fitted.
    Height { fit: &'a Fit, input: &'a Input, bare: bool },
    /// A parametric surface that was fitted.
    Parametric { fit: &'a ParametricFit, input: &'a Input, bare: bool },
    /// A surface with knots where the contacts asked for them.
    Adaptive { answer: &'a AdaptiveAnswer, input: &'a Input },
    /// A recognition; the surface is its spline.
    Recognised { found: &'a Recognition, input: &'a Input },
}

/// What is known of a fit besides the fit itself.
#[derive(Clone, Debug)]
pub(crate) struct Subject<'a> {
    /// The data.
    pub input: &'a Input,
    /// Unit of all lengths, where the user named it.
    pub unit: Option<String>,
    /// What is true, in a simulated world.
    pub truth: Option<&'a Truth>,
    /// Whether certificate, uncertainties and intervals were declined.
    pub bare: bool,
    /// Remarks of the reader.
    pub notes: Vec<String>,
    /// Kind of surface and why, where that was a question.
    pub chosen: Option<ChosenPart>,
    /// What the surface leaves unsaid, where that was tested.
    pub lack_of_fit: Option<LackOfFitPart>,
}

impl Subject<'_> {
    /// The remarks, and that on what was declined.
    pub(super) fn remarks(&self) -> impl Iterator<Item = String> {
        let declined = "certificate, uncertainties, intervals and direction were declined (--bare)";
        self.notes.iter().cloned().chain(self.bare.then(|| declined.to_string()))
    }
}
