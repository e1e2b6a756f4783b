//! Which shape contacts show, when no model is named.

use palpate_inference::recognition::{Estimate, Recognition, RecognitionError, RecognitionOptions};

use crate::border::{
    PalpateStatus, Refused, copy_out, faulty, fill, guarded, hand_over, named, named_mut, take_back, unanswered,
};
use crate::contacts::PalpateContacts;
use crate::shape::{PalpateClass, PalpateEstimate, PalpateMapPoint, PalpateShape, class_of, kind_of, other_side};

/// What may be said to a recognition. `palpate_recognise_defaults` fills it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PalpateRecogniseOptions {
    /// Level of the intervals, between 0 and 1.
    pub level: f64,
    /// Points of the map each way.
    pub grid: [usize; 2],
    /// Seed of the posterior's draws.
    pub seed: u64,
    /// Whether the sensor stood at `viewpoint`, which lies on the free side.
    pub has_viewpoint: bool,
    /// Where it stood.
    pub viewpoint: [f64; 3],
    /// Known standard deviation of the errors in x and in y; 0 where they err alike in all directions.
    pub sigma_xy: f64,
}

/// A recognised surface.
#[derive(Debug)]
pub struct PalpateRecognition {
    found: Recognition,
}

fn estimate_of(estimate: &Estimate) -> PalpateEstimate {
    let [lo, hi] = estimate.interval;
    PalpateEstimate { mean: estimate.mean, u: estimate.u, lo, hi }
}

fn options_of(options: &PalpateRecogniseOptions) -> RecognitionOptions {
    RecognitionOptions {
        level: options.level,
        grid: options.grid,
        seed: options.seed,
        viewpoint: options.has_viewpoint.then_some(options.viewpoint),
        sigma_xy: options.sigma_xy,
        ..RecognitionOptions::default()
    }
}

fn refused(error: &RecognitionError) -> Refused {
    match error {
        RecognitionError::Contact(_) => faulty(error),
        _ => unanswered(error),
    }
}

fn shape_of(found: &Recognition) -> PalpateShape {
    let of = |class| found.class_probability.iter().find(|(known, _)| *known == class).map_or(0.0, |(_, p)| *p);
    let kind = found.tried.iter().find(|tried| tried.hypothesis == found.hypothesis);
    let both_sides = if found.side_known { PalpateClass::None } else { other_side(found.class) };
    let mirror = if both_sides == PalpateClass::None { 0.0 } else { of(found.class.mirrored()) };
    let radius = found.radius.map_or(PalpateEstimate::UNDEFINED, |mean| {
        let [lo, hi] = found.radius_interval.unwrap_or([f64::NAN; 2]);
        PalpateEstimate { mean, u: f64::NAN, lo, hi }
    });
    PalpateShape {
        class_: class_of(found.class),
        other_class: both_sides,
        class_probability: of(found.class) + mirror,
        kind: kind_of(found.hypothesis),
        kind_probability: kind.map_or(f64::NAN, |tried| tried.weight),
        shape_index: found.shape_index.as_ref().map_or(PalpateEstimate::UNDEFINED, estimate_of),
        curvedness: estimate_of(&found.curvedness),
        radius,
        level: found.curvedness.level,
        contacts: found.contacts,
        outliers: found.outliers,
    }
}

/// Fills the options with what serves a user who says nothing.
///
/// # Safety
/// `options` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognise_defaults(options: *mut PalpateRecogniseOptions) -> PalpateStatus {
    guarded(|| {
        let RecognitionOptions { level, grid, seed, sigma_xy, .. } = RecognitionOptions::default();
        let defaults =
            PalpateRecogniseOptions { level, grid, seed, has_viewpoint: false, viewpoint: [0.0; 3], sigma_xy };
        // SAFETY: as this function asks of its caller
        unsafe { fill(options, "options", || Ok(defaults)) }
    })
}

/// Recognises what the contacts show. `options` may be null: then the defaults count. Free the result by
/// `palpate_recognition_free`.
///
/// # Safety
/// `contacts` and `options` are null or name living values, and `recognition` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognise(
    contacts: *const PalpateContacts,
    options: *const PalpateRecogniseOptions,
    recognition: *mut *mut PalpateRecognition,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let contacts = unsafe { named(contacts, "contacts") }?;
        // SAFETY: likewise
        let options = unsafe { options.as_ref() }.map_or_else(RecognitionOptions::default, options_of);
        let found = Recognition::of(&contacts.all(), &options).map_err(|error| refused(&error))?;
        // SAFETY: likewise
        unsafe { hand_over(PalpateRecognition { found }, recognition) }
    })
}

/// Frees a recognition; null is nothing.
///
/// # Safety
/// `recognition` is null or a handle that was not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognition_free(recognition: *mut PalpateRecognition) {
    // SAFETY: as this function asks of its caller
    unsafe { take_back(recognition) }
}

/// What was recognised.
///
/// # Safety
/// `recognition` is null or a living handle, and `shape` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognition_shape(
    recognition: *const PalpateRecognition,
    shape: *mut PalpateShape,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let found = &unsafe { named(recognition, "recognition") }?.found;
        // SAFETY: likewise
        unsafe { fill(shape, "shape", || Ok(shape_of(found))) }
    })
}

/// The map of the surface: as many of its points as there is room for; `count` is how many there are. `points` may be null, to
/// ask for the count alone.
///
/// # Safety
/// `recognition` is null or a living handle, `points` is null or has room for `room` values, `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognition_map(
    recognition: *const PalpateRecognition,
    points: *mut PalpateMapPoint,
    room: usize,
    count: *mut usize,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let found = &unsafe { named(recognition, "recognition") }?.found;
        let all = found.map.iter().map(|point| PalpateMapPoint {
            position: point.position,
            normal: point.normal,
            shape_index: point.shape_index.unwrap_or(f64::NAN),
            curvedness: point.curvedness,
            k1: point.k1,
            k2: point.k2,
            supported: point.supported,
        });
        // SAFETY: likewise
        unsafe { copy_out(all, points, room, count) }
    })
}

/// Signed distance of a place from the surface, positive on the free side.
///
/// # Safety
/// `recognition` is null or a living handle, and `distance` is null or can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palpate_recognition_distance(
    recognition: *const PalpateRecognition,
    x: f64,
    y: f64,
    z: f64,
    distance: *mut f64,
) -> PalpateStatus {
    guarded(|| {
        // SAFETY: as this function asks of its caller
        let found = &unsafe { named(recognition, "recognition") }?.found;
        if ![x, y, z].iter().all(|v| v.is_finite()) {
            return Err(faulty("the place is not finite"));
        }
        // SAFETY: likewise
        *unsafe { named_mut(distance, "distance") }? = found.distance([x, y, z]);
        Ok(())
    })
}
