//! Several things in the place of one surface of no simple kind, where they lie nearer to the contacts.

use palpate_fitting::fit::Fit;
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Contacts;
use palpate_geometry::surface::Heights;
use palpate_inference::parts::{Parts, PartsOptions};
use palpate_inference::recognition::{Hypothesis, RecognitionOptions};

use crate::io::Input;
use crate::report::Answer;

/// The parts of the contacts, where these tell them better than the answer.
pub(super) fn parts_instead(input: &Input, answer: &Answer, options: &RecognitionOptions) -> Option<Parts> {
    let Input::Contacts(contacts) = input else { return None };
    let distances = distances_from(answer, contacts)?;
    let options = PartsOptions { viewpoint: options.viewpoint, ..PartsOptions::default() };
    Parts::instead_of(&distances, contacts, &options)
}

/// Distances of the contacts from a surface of no simple kind.
fn distances_from(answer: &Answer, contacts: &Contacts) -> Option<Vec<f64>> {
    let places = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]);
    match answer {
        Answer::Recognised(found) if !is_simple(found.hypothesis) => {
            Some(places.map(|place| found.surface.distance(place)).collect())
        }
        Answer::Fitted(FittedSurface::Height(fit)) => Some(places.map(|place| height_over(fit, place)).collect()),
        _ => None,
    }
}

fn is_simple(hypothesis: Hypothesis) -> bool {
    matches!(hypothesis, Hypothesis::Plane | Hypothesis::Sphere | Hypothesis::Cylinder | Hypothesis::Cone)
}

/// Distance of a place from the tangent plane below it.
fn height_over(fit: &Fit, place: [f64; 3]) -> f64 {
    let [x, y, z] = fit.frame().to_patch(place);
    let at = fit.surface().height_at(x, y);
    fit.frame().scale * (z - at.z) / (1.0 + at.zx * at.zx + at.zy * at.zy).sqrt()
}
