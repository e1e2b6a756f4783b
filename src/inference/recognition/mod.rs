//! Which shape contacts show when no model is named: plane, sphere, cylinder or none of these, with S, R and their
//! intervals.
//!
//! ```text
//! theta = (h, a, b, k1, k2, phi)        two constant curvatures; plane: k = 0, cylinder: k2 = 0, sphere: k1 = k2
//! d(theta; P) = f(P) + e                signed distance = displacement + error
//! cov e = s^2 (D + rho exp(-r/l))       neighbours share errors, so many contacts may count as few
//! P(hypothesis | contacts) ~ integral of likelihood and prior over theta, f, s, rho, l
//! ```
//!
//! S and R are means over the supported points of the map, weighted by those probabilities: an even grid over x and y, as
//! for a fit that names its model, or over the chart of a patch that stands steep. Moving, scaling or shuffling the
//! contacts changes the coordinates of the answer and nothing else. So does rotating them, but for the points of the grid:
//! where S and R differ from place to place, their means over other points differ too.
//!
//! ```
//! # use palpate_inference::facade as palpate;
//! use palpate::Contacts;
//! use palpate::recognition::{Hypothesis, Recognition, RecognitionOptions};
//!
//! // a ridge of radius 6 along y, touched at 36 places
//! let (x, y): (Vec<f64>, Vec<f64>) = (0..36).map(|r| ((r % 6) as f64 - 2.5, (r / 6) as f64 - 2.5)).unzip();
//! let z: Vec<f64> = x.iter().map(|x| (36.0 - x * x).sqrt() - 6.0).collect();
//! let nz = z.iter().map(|z| z + 6.0).collect();
//! let contacts = Contacts::from_positions(x.clone(), y, z).with_normals(x, vec![0.0; 36], nz);
//! let found = Recognition::of(&contacts, &RecognitionOptions::default())?;
//! assert_eq!((found.hypothesis, found.class.name()), (Hypothesis::Cylinder, "ridge"));
//! assert!((found.radius.unwrap() - 6.0).abs() < 1e-6);
//! # Ok::<(), palpate::recognition::RecognitionError>(())
//! ```

mod answer;
mod contacts;
mod discrepancy;
mod equations;
mod error;
mod evidence;
mod free_form;
mod hypothesis;
mod kinds;
mod noise;
mod options;
mod region;
mod remark;
mod result;
mod sequential;
mod shape_report;
mod start;
#[cfg(test)]
mod tests;
mod whole_body;

pub use free_form::RecognisedSpline;
// free-form parts are described by the same field as contacts that no simple shape explains
pub use crate::bodies::Tuning;
pub use contacts::NormalsUse;
pub use error::RecognitionError;
pub(crate) use free_form::FieldChoice;
pub use free_form::{FieldForm, FieldRequest, Flexible, Pointwise, Shown, shown};
pub use free_form::{flexible, own_axes};
pub use hypothesis::Hypothesis;
pub use options::RecognitionOptions;
pub use region::PredictiveDraw;
pub use region::RecognisedSurface;
pub use remark::Remark;
pub use result::{Estimate, MapPoint, Misfit, NoiseFound, Recognition, Tried};
pub use sequential::{SequentialOptions, SequentialPosterior, TouchUpdate};
#[doc(hidden)]
pub use whole_body::{CorpusBody, CorpusEvidence};

use palpate_geometry::contact::{Contacts, Grid, Rounding};
use palpate_numeric::vector::Vector;

use contacts::{Observations, check_options};
use evidence::{Evidence, Linearised, Node, SearchContext};
use kinds::{Kind, Model};
use options::RequestedPlaces;

impl Recognition {
    /// Recognises the shape that contacts show.
    ///
    /// # Errors
    /// When the contacts are faulty, too few, on one line, or not one sheet.
    pub fn of(contacts: &Contacts, options: &RecognitionOptions) -> Result<Recognition, RecognitionError> {
        Recognition::with_predictions(contacts, options, &[])
    }

    /// The same, with what touches at these places of the input's x and y would measure.
    pub fn with_predictions(
        contacts: &Contacts,
        options: &RecognitionOptions,
        touches: &[[f64; 2]],
    ) -> Result<Recognition, RecognitionError> {
        check_options(options)?;
        let asked = RequestedPlaces { touches, ..RequestedPlaces::default() };
        recognise_given(Observations::from_contacts(contacts, options)?, &asked, options)
    }

    /// Recognises the shape of a height map. Missing pixels are left out; the free side is that of larger z.
    ///
    /// # Errors
    /// As [`Recognition::of`].
    pub fn of_grid(grid: &Grid, options: &RecognitionOptions) -> Result<Recognition, RecognitionError> {
        check_options(options)?;
        let upward = RecognitionOptions { viewpoint: None, up: Some([0.0, 0.0, 1.0]), ..options.clone() };
        recognise_given(Observations::from_grid(grid, options)?, &RequestedPlaces::default(), &upward)
    }

    /// Of contacts whose numbers were rounded by so much before they were brought to these units.
    pub(crate) fn of_rounded(
        contacts: &Contacts,
        rounding: Rounding,
        options: &RecognitionOptions,
    ) -> Result<Recognition, RecognitionError> {
        check_options(options)?;
        let given = Observations { rounding, ..Observations::from_contacts(contacts, options)? };
        recognise_given(given, &RequestedPlaces::default(), options)
    }

    /// Of contacts, with S and R averaged over these places of the input instead of the region that contacts support.
    fn over(
        contacts: &Contacts,
        places: &[Vector],
        options: &RecognitionOptions,
    ) -> Result<Recognition, RecognitionError> {
        check_options(options)?;
        let asked = RequestedPlaces { means: Some(places), ..RequestedPlaces::default() };
        recognise_given(Observations::from_contacts(contacts, options)?, &asked, options)
    }
}

/// A patch first; beside it primitives in space, where it is not certain of its kind, and a body alone, where it is refused, doubtful or bent too far. A side that nothing tells is said to be unknown.
fn recognise_given(
    given: Observations,
    asked: &RequestedPlaces,
    options: &RecognitionOptions,
) -> Result<Recognition, RecognitionError> {
    if asked.means.is_some() {
        return recognise_patch(&given, asked, options);
    }
    let either = |found: Recognition| if found.side_known { found } else { whole_body::of_either_side(found) };
    let patch = recognise_patch(&given, asked, options).map(either);
    let patch = patch.and_then(|found| whole_body::beside_a_line(found, &given, &options.tuning));
    let patch = patch.and_then(|found| whole_body::within_its_noise(found, &given, &options.tuning));
    let patch = patch.map(|found| free_form::beside_short_waves(found, &given.points, &options.tuning));
    whole_body::instead(patch, &given, asked.touches, options)
}

/// The steps, top to bottom, each in its room: the contacts are put in order (`contacts`), a robust surface says which of them belong
/// together (`start`), how they err is told (`noise`), every kind of surface with its departures (`kinds`, `departures`) is asked how
/// probable it is (`equations`, `evidence`), and the answer is told over the part that contacts support (`region`, `answer`).
fn recognise_patch(
    given: &Observations,
    asked: &RequestedPlaces,
    options: &RecognitionOptions,
) -> Result<Recognition, RecognitionError> {
    let tuning = &options.tuning;
    let mut patch = start::Patch::new(given, options)?;
    let nearest = patch.nearest();
    let errors = noise::PlaceErrors::of(&patch, &nearest, options.sigma_xy, tuning);
    let mut cells = noise::weighed(patch.cells(tuning), &patch, &errors, tuning);
    let doubt_of_places = noise::set_back(&mut cells, &mut patch.points, &patch.feet, (&errors, &patch.frame));
    let models = patch.fitted(&cells, tuning);
    let relief = start::relief(&cells, &models, tuning);
    let distances = noise::distances_between(&cells);
    let limit = noise::Limit::new(&nearest, &patch.distances, relief, tuning);
    let factors = evidence::FactorPair::new(&cells, &distances);
    let plain = Linearised::new(&cells, &patch.points, models, &factors, tuning);
    let misfit = |models: &[Model], kind: Kind| {
        let distance = |m: &Model| start::weighted_rms(&cells, m);
        models.iter().find(|m| m.kind() == kind).map_or(f64::INFINITY, distance)
    };
    let contacts_per_cell = patch.points.len() as f64 / cells.points.len() as f64;
    let at = SearchContext { cells: &cells, contacts: &patch.points, factors: &factors, limit, tuning };
    let weigh = |linearised: &Linearised, evidence: &Evidence, nodes: &[Node]| {
        // a plane that a body stands over misfits it whatever the body is
        let models = if linearised.over_plane.is_some() { &plain.models } else { &linearised.models };
        let misfit = |kind| misfit(models, kind);
        answer::weigh(evidence, &linearised.rows, nodes, relief, contacts_per_cell, misfit, tuning)
    };
    let may_be_error = |linearised: &Linearised, evidence: &Evidence, nodes: &[Node]| {
        weigh(linearised, evidence, nodes).displacement_may_be_error()
    };
    evidence::likeliest_look(at, &plain, may_be_error, |linearised, evidence, nodes| {
        let weights = weigh(linearised, evidence, nodes);
        answer::Findings {
            patch: &patch,
            evidence,
            nodes,
            weights: &weights,
            relief,
            linearised,
            distances: &distances,
            nearest: &nearest,
            place_errors: errors,
            doubt_of_places,
            asked,
        }
        .recognition(options)
    })
}
