//! What the touches so far answer, and when they are asked again.
//!
//! ```text
//! fresh     all touches were recognised, as palpate fit would
//! moved     the drawn surfaces of the last look were conditioned on the touches since, which agree with them
//! stands    the answer of the touches before: what is no simple shape is not moved
//! ```
//!
//! An answer that stands says of how many touches it is. A touch that disagrees, or lies beside, or makes another kind the likeliest
//! calls for a look at all of them; so do touches that have grown by a share.

use std::time::{Duration, Instant};

use crate::cli::adaptive_model::AdaptiveFlags;
use crate::cli::answer::{Question, answer, described};
use crate::cli::found::{Found, Refusal};
use crate::cli::options::FitFlags;
use crate::io::Input;
use crate::report::{Answer, Description, FitDocument, ShapePart, compute_shape, move_document};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{SequentialOptions, SequentialPosterior, TouchUpdate};

use super::next::{NextTouch, TouchReach, next_touch};

/// Share of that growth for an answer that touches do not move, and which grows older with each: 0.05 of the touches by default. Several
/// things have no answer that would.
const UNMOVED: f64 = 0.2;

/// Two axes, and maps over them by their names.
pub(in crate::cli) type LookMaps = ([Vec<f64>; 2], Vec<(&'static str, ndarray::Array2<f64>)>);

/// What some touches answer.
#[derive(Debug)]
pub(in crate::cli) struct LiveLook {
    /// Touches that it is of.
    pub(super) contacts: usize,
    /// Touches that had ever come when all were looked at.
    pub(super) touches: u64,
    /// Touches that have moved it since.
    pub(super) moved: u64,
    /// What `palpate fit` says of them, or why there is no answer.
    pub(super) document: Result<Box<FitDocument>, String>,
    /// What to touch next.
    pub(super) next: Option<NextTouch>,
    input: Input,
    found: Option<Found>,
    /// How touches move it, where it is a simple shape.
    posterior: Option<SequentialPosterior>,
    /// The touches are several things.
    is_several: bool,
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
        let found = answer(&input, &question);
        let is_several = matches!(&found, Err(Refusal::Several(_)));
        let found = found.map_err(Refusal::words);
        let took = clock.elapsed();
        let document = found.as_ref().map_err(Clone::clone).and_then(|found| document(found, &input, took));
        let next = match &input {
            Input::Contacts(contacts) => next_touch(found.as_ref().ok(), contacts, reach),
            Input::Grid(_) => None,
        };
        let found = found.ok();
        let posterior = found.as_ref().and_then(posterior);
        LiveLook { contacts: count, touches, moved: 0, document, next, input, found, posterior, is_several, took }
    }

    /// One touch more, which is moved into the answer where it can be; `false` calls for a look at all touches.
    pub(super) fn takes(&mut self, touch: &Contacts) -> bool {
        let (Some(found), Some(posterior)) = (&mut self.found, &mut self.posterior) else { return true };
        let Answer::Recognised(recognised) = &mut found.answer else { return true };
        let place = [touch.x[0], touch.y[0], touch.z[0]];
        if posterior.update(recognised, place, touch.unit_normal(0)) != TouchUpdate::Moved {
            return false;
        }
        if let Ok(document) = &mut self.document {
            move_document(document, recognised);
        }
        (self.contacts, self.moved) = (self.contacts + 1, self.moved + 1);
        true
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

    /// Whether the answer counts every touch up to this one.
    pub(super) fn counts_to(&self, touch: u64) -> bool {
        self.touches + self.moved == touch
    }

    /// The shape, where there is an answer.
    pub(super) fn shape(&self) -> Option<&ShapePart> {
        self.document.as_ref().ok().map(|document| &document.shape)
    }

    /// Whether so many touches more call for another look, if a look at a simple shape is due after this share of them.
    pub(super) fn is_outgrown(&self, touches: u64, share: f64) -> bool {
        let share = if self.posterior.is_some() || self.is_several { share } else { UNMOVED * share };
        let looked_at = self.contacts as f64 - self.moved as f64;
        (touches - self.touches) as f64 > share * looked_at
    }
}

/// How touches move an answer: not that of a spline, of which nothing is predicted.
fn posterior(found: &Found) -> Option<SequentialPosterior> {
    match &found.answer {
        // the growth is the session's to say
        Answer::Recognised(found) => {
            let options = SequentialOptions { most_growth: f64::INFINITY, ..SequentialOptions::default() };
            Some(SequentialPosterior::of(found, options))
        }
        Answer::Adaptive(_) | Answer::Fitted(_) => None,
    }
}

fn document(found: &Found, input: &Input, took: Duration) -> Result<Box<FitDocument>, String> {
    compute_shape(&found.answer, false);
    let description = described(found, input, took.as_secs_f64(), found.notes.clone())?;
    Ok(Box::new(description.document().clone()))
}
