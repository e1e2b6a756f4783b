//! One touch more: the drawn surfaces are conditioned on it, as a Kalman filter conditions an ensemble.
//!
//! ```text
//! a touch y = p(d) + e,  e ~ N(0, v)         p(d): what draw d has it measure, linear in the values x of the draw
//! x_d <- x_d + K (y - mean p) - a K (p_d - mean p)        K = cov(x, p) / (var p + v),  a = 1 / (1 + sqrt(v / (var p + v)))
//! share ~ share N(y; mean p, var p + v)                   means, variances and K within each component of the mixture
//! ```
//!
//! This is the square-root filter of J. S. Whitaker and T. M. Hamill, *Mon. Weather Rev.* 130 (2002) 1913, of a mixture of gaussians;
//! exact where surfaces are linear in what was drawn and the noise is known. `ensemble.rs` holds the draws, `touch.rs` says what a touch
//! measures and how it errs, `moved.rs` what the draws then make of the answer. The surface, its map, the noise and the remarks stand as
//! they were; S, R, class, kind and radius move.

mod ensemble;
mod moved;
#[cfg(test)]
mod tests;
mod touch;

use palpate_numeric::vector::Vector;

use super::result::Recognition;
use ensemble::DrawnEnsemble;
use moved::FirstAnswer;
use touch::{MeasuredTouch, TouchErrors};

/// When a touch moves an answer, and when all touches have to be recognised again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SequentialOptions {
    /// Standard deviations by which a touch may miss the surface. Fewer: of touches in their thousands one calls for a recognition by
    /// chance. More: a step of the surface is noticed later.
    pub agrees_within: f64,
    /// How far beyond the patch, as a share of its side, a touch is still one of the patch. Less: every other touch at an edge calls
    /// for a recognition. More: a sweep that goes on is answered for the part behind it.
    pub beside: f64,
    /// Share of the contacts by which touches may grow before all are recognised again: the noise and what the kinds may depart by
    /// are those of the contacts before.
    pub most_growth: f64,
}

impl Default for SequentialOptions {
    fn default() -> SequentialOptions {
        SequentialOptions { agrees_within: 4.0, beside: 0.05, most_growth: 0.5 }
    }
}

/// What a touch came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchUpdate {
    /// It agrees, and the answer has moved.
    Moved,
    /// It lies off the surface, or its normal off the surface's.
    Disagrees,
    /// It lies beside the part that was touched, of which the answer knows nothing.
    Beside,
    /// Another kind or class has become the likeliest.
    OtherKind,
    /// The touches since are too many beside those that were recognised, or no surface was drawn.
    Outgrown,
}

impl TouchUpdate {
    /// Whether the answer has moved.
    pub fn is_moved(self) -> bool {
        self == TouchUpdate::Moved
    }
}

/// Touches that came after a recognition, each of which moves its answer: far quicker than all of them are recognised anew.
///
/// ```
/// # use palpate_geometry::contact::Contacts;
/// # use palpate_inference::recognition::{Recognition, RecognitionError, RecognitionOptions, SequentialPosterior};
/// // a ball of radius 2, touched where the robot happens to be
/// let touch = |k: u32| {
///     let (turn, height) = (2.4 * f64::from(k), 1.0 - f64::from(k % 20) / 25.0);
///     let across = (1.0 - height * height).sqrt();
///     let error = 0.002 * f64::from(k % 7) - 0.006;
///     [across * turn.cos(), across * turn.sin(), height].map(|v| (2.0 + error) * v)
/// };
/// let mut touches: Vec<[f64; 3]> = (0..30).map(touch).collect();
/// let recognised = |touches: &[[f64; 3]]| Recognition::of(&Contacts::from_points(touches), &RecognitionOptions::default());
/// let mut found = recognised(&touches)?;
/// let mut posterior = SequentialPosterior::after(&found);
/// for k in 30..40 {
///     touches.push(touch(k));
///     if !posterior.update(&mut found, touch(k), None).is_moved() {
///         found = recognised(&touches)?;
///         posterior = SequentialPosterior::after(&found);
///     }
/// }
/// assert_eq!(found.contacts, 40);
/// let [least, most] = found.radius_interval.expect("a ball has a radius");
/// assert!(least < 2.0 && 2.0 < most && most - least < 0.02);
/// # Ok::<(), RecognitionError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SequentialPosterior {
    options: SequentialOptions,
    first: FirstAnswer,
    ensemble: DrawnEnsemble,
    touches: Vec<Vector>,
}

impl SequentialPosterior {
    /// After this recognition, before any touch, with the settings that are right for most.
    pub fn after(found: &Recognition) -> SequentialPosterior {
        SequentialPosterior::of(found, SequentialOptions::default())
    }

    /// After this recognition, before any touch.
    pub fn of(found: &Recognition, options: SequentialOptions) -> SequentialPosterior {
        let ensemble = DrawnEnsemble::of(found);
        let first = FirstAnswer::of(found, &ensemble);
        SequentialPosterior { options, first, ensemble, touches: Vec::new() }
    }

    /// Touches that have moved the answer since it was recognised.
    pub fn touches(&self) -> usize {
        self.touches.len()
    }

    /// One touch more: its place and its unit normal, where it has one, in the input's coordinates. Unless it says
    /// [`TouchUpdate::Moved`], the answer stands as it was, and all touches should be recognised again.
    ///
    /// `found` is the recognition that this was made of, as the touches before have moved it.
    pub fn update(&mut self, found: &mut Recognition, place: Vector, normal: Option<Vector>) -> TouchUpdate {
        let at = found.share_of_map(place);
        let beside = self.options.beside;
        if !at.iter().all(|share| (-beside..=1.0 + beside).contains(share)) {
            return TouchUpdate::Beside;
        }
        let since = self.touches.len() + 1;
        let recognised = found.contacts.saturating_sub(self.touches.len());
        if self.ensemble.is_empty() || since as f64 > self.options.most_growth * recognised as f64 {
            return TouchUpdate::Outgrown;
        }
        let errors = TouchErrors::of(found, &self.touches, place);
        let touch = MeasuredTouch::of(found, &self.ensemble, (at, place, normal), &errors);
        if !touch.agrees(&self.ensemble, self.options.agrees_within) {
            return TouchUpdate::Disagrees;
        }
        let mut ensemble = self.ensemble.clone();
        touch.readings.iter().for_each(|reading| ensemble.condition(reading));
        let moved = self.first.moved(found, &ensemble);
        if !moved.keeps_kind_of(found) {
            return TouchUpdate::OtherKind;
        }
        moved.replace(found);
        (self.ensemble, found.contacts) = (ensemble, found.contacts + 1);
        self.touches.push(place);
        TouchUpdate::Moved
    }
}
