//! What the touches so far answer, and when they are asked again.
//!
//! ```text
//! fresh     all touches were recognised, as palpate fit would
//! stands    the answer of the touches before, which the new ones agree with:
//!           |distance| <= 4 sd,  the normal within 4 sd,  beside what was touched,  fewer than a share more touches
//! ```
//!
//! An answer that stands says of how many touches it is.

use std::time::{Duration, Instant};

use crate::cli::adaptive_model::AdaptiveFlags;
use crate::cli::answer::{Question, answer, described};
use crate::cli::found::{Found, Refusal};
use crate::cli::options::FitFlags;
use crate::io::Input;
use crate::report::{Answer, Description, FitDocument, ShapePart, compute_shape};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::Recognition;
use palpate_numeric::vector::dot;

use super::next::{NextTouch, TouchReach, next_touch};

/// Standard deviations by which a touch may miss the surface and still agree with it. Fewer: touches in their thousands are
/// recognised again because of chance. More: a step of the surface is noticed later.
const AGREES_WITHIN: f64 = 4.0;

/// How far beyond the patch, as a share of its side, a touch is still one of the patch. Less: of touches in their thousands every one at
/// an edge is recognised again. More: a sweep that goes on is answered for the part behind it.
const BESIDE: f64 = 0.05;

/// Rounding that is no disagreement, as a share of the patch's size.
const ROUNDING: f64 = 1e-9;

/// Two axes, and maps over them by their names.
pub(in crate::cli) type LookMaps = ([Vec<f64>; 2], Vec<(&'static str, ndarray::Array2<f64>)>);

/// What some touches answer.
#[derive(Debug)]
pub(in crate::cli) struct LiveLook {
    /// Touches that it is of.
    pub(super) contacts: usize,
    /// Touches that had ever come by then.
    pub(super) touches: u64,
    /// What `palpate fit` says of them, or why there is no answer.
    pub(super) document: Result<Box<FitDocument>, String>,
    /// What to touch next.
    pub(super) next: Option<NextTouch>,
    input: Input,
    found: Option<Found>,
    took: Duration,
}

impl LiveLook {
    /// Asks these touches.
    pub(super) fn at(contacts: Contacts, touches: u64, viewpoint: Option<[f64; 3]>, reach: &TouchReach) -> LiveLook {
        let (flags, clock) = (FitFlags::default(), Instant::now());
        let adaptive = AdaptiveFlags::default();
        let question =
            Question { flags: &flags, adaptive: &adaptive, base: FitOptions::default(), bare: false, viewpoint };
        let count = contacts.len();
        let input = Input::Contacts(contacts);
        let found = answer(&input, &question).map_err(Refusal::words);
        let took = clock.elapsed();
        let document = found.as_ref().map_err(Clone::clone).and_then(|found| document(found, &input, took));
        let next = match &input {
            Input::Contacts(contacts) => next_touch(found.as_ref().ok(), contacts, reach),
            Input::Grid(_) => None,
        };
        LiveLook { contacts: count, touches, document, next, input, found: found.ok(), took }
    }

    /// The document that `palpate fit --save` writes; `None` where there is no answer.
    pub(in crate::cli) fn saved(&self) -> Result<Option<FitDocument>, String> {
        Ok(self.described()?.map(|description| description.saved()))
    }

    /// The axes and the arrays of `maps.npz` that `palpate fit --out` writes; `None` where there is no answer.
    pub(in crate::cli) fn maps(&self, points: Option<[usize; 2]>) -> Result<Option<LookMaps>, String> {
        let Some(description) = self.described()? else { return Ok(None) };
        let (grid, arrays) = description.map_arrays(points);
        Ok(Some(([grid.x, grid.y], arrays)))
    }

    fn described(&self) -> Result<Option<Description<'_>>, String> {
        let Some(found) = &self.found else { return Ok(None) };
        described(found, &self.input, self.took.as_secs_f64(), found.notes.clone()).map(Some)
    }

    /// The shape, where there is an answer.
    pub(super) fn shape(&self) -> Option<&ShapePart> {
        self.document.as_ref().ok().map(|document| &document.shape)
    }

    /// Whether one more touch agrees with the answer. Of what is no simple shape nothing is predicted, and growth alone decides.
    pub(super) fn agrees_with(&self, touch: &Contacts) -> bool {
        let Some(found) = self.recognised() else { return true };
        let place = [touch.x[0], touch.y[0], touch.z[0]];
        let [u, v] = found.chart_of(place);
        let sd = found.noise.sd_of_contact().max(ROUNDING * found.frame.scale);
        let is_near = found.distance(place).abs() <= AGREES_WITHIN * sd;
        let normal = touch.unit_normal(0).filter(|normal| dot(*normal, *normal) > 0.5);
        let is_along = normal.zip(found.noise.sd_normal_deg).is_none_or(|(normal, sd)| {
            let angle = dot(normal, found.at(u, v).1).clamp(-1.0, 1.0).acos().to_degrees();
            angle <= AGREES_WITHIN * sd.max(ROUNDING.to_degrees())
        });
        is_near && is_along && is_within(found.chart(), [u, v])
    }

    fn recognised(&self) -> Option<&Recognition> {
        match &self.found.as_ref()?.answer {
            Answer::Recognised(found) => Some(found),
            Answer::Adaptive(_) | Answer::Fitted(_) => None,
        }
    }

    /// Whether so many touches more call for another look, if a look is due after this share of them.
    pub(super) fn is_outgrown(&self, touches: u64, share: f64) -> bool {
        (touches - self.touches) as f64 > share * self.contacts as f64
    }
}

/// Whether a place of the chart is one that touches reach, or just beside.
fn is_within(chart: [[f64; 2]; 2], at: [f64; 2]) -> bool {
    chart.iter().zip(at).all(|([lo, hi], at)| {
        let beside = BESIDE * (hi - lo);
        (lo - beside..=hi + beside).contains(&at)
    })
}

fn document(found: &Found, input: &Input, took: Duration) -> Result<Box<FitDocument>, String> {
    compute_shape(&found.answer, false);
    let description = described(found, input, took.as_secs_f64(), found.notes.clone())?;
    Ok(Box::new(description.document().clone()))
}
