//! Everything that was found, before it is said, and how far contacts lie from a surface of it.
//!
//! ```text
//! distance of a place P = d(theta; P) - f(u, v)        (u, v) chart coordinates of P's foot on the general surface
//! ```

use faer::Mat;

use crate::recognition::discrepancy::State;
use crate::recognition::evidence::{Evidence, Linearised, Node};
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::noise::PlaceErrors;
use crate::recognition::options::RequestedPlaces;
use crate::recognition::region::chart_point;
use crate::recognition::start::Patch;
use palpate_numeric::statistics::standard_deviation;
use palpate_numeric::vector::Vector;

use super::weights::Weights;

/// Everything that was found, in the frame of the patch.
pub(crate) struct Findings<'a> {
    pub(crate) patch: &'a Patch,
    pub(crate) evidence: &'a Evidence<'a>,
    pub(crate) nodes: &'a [Node],
    pub(crate) weights: &'a Weights,
    pub(crate) relief: f64,
    pub(crate) linearised: &'a Linearised,
    pub(crate) distances: &'a Mat<f64>,
    /// A sample of the contacts, each with the one whose foot is nearest.
    pub(crate) nearest: &'a [[usize; 2]],
    pub(crate) place_errors: PlaceErrors,
    /// Standard uncertainty of R, as a share of it, from how well the errors of places are known.
    pub(crate) doubt_of_places: f64,
    /// Places that the caller asks about.
    pub(crate) asked: &'a RequestedPlaces<'a>,
}

impl Findings<'_> {
    /// Weighted root mean square of residuals at the cells.
    pub(super) fn size(&self, residuals: &[f64]) -> f64 {
        let weighted = residuals.iter().zip(&self.evidence.cells.weights).map(|(d, w)| w.sqrt() * d);
        standard_deviation(&weighted.collect::<Vec<_>>())
    }

    /// Distance of a place from the reported surface.
    pub(super) fn distance(&self, base: Option<&Model>, best: &Node, state: &State, place: Vector) -> f64 {
        let d = state.model().distance(place);
        match (base, self.evidence.displacement) {
            (Some(Model::Constant(_, base)), Some(displacement)) if best.is_displaced() => {
                d - state.at(&chart_point(base, Some(displacement), base.chart(place))).displacement
            }
            _ => d,
        }
    }

    /// Residuals of the reported surface at the cells.
    pub(super) fn residuals(&self, best: &Node, state: &State) -> Vec<f64> {
        let base = self.evidence.models.iter().find(|m| m.kind() == Kind::General);
        self.evidence.cells.points.iter().map(|p| self.distance(base, best, state, *p)).collect()
    }
}
