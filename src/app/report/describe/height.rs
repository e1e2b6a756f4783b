//! A fitted height field: its certificate, its notes, and how its intervals came about.

use std::borrow::Cow;

use crate::io::{AnySurface, Input};
use crate::report::document::{FitPart, IntervalsPart, PromisePart, RmsPart, ShapePart, SigmaPart};
use crate::report::interval_words::interval_words;
use crate::report::shape_part::shape_part;
use crate::report::subject::{Source, Subject};
use crate::report::table::significant;
use palpate_fitting::fit::{Fit, FitError, ModelReading, NoiseSource, Note, Shape};
use palpate_geometry::contact::{Contacts, Frame, Grid};
use palpate_geometry::shape::{Outline, ShapeMaps};
use palpate_numeric::simd::Isa;
use palpate_world::scene::Truth;

use super::Found;
use super::truth::{TruePlace, truth_part};

/// What a fit found.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(super) fn found<'a>(fit: &'a Fit, subject: &Subject<'a>) -> Result<Found<'a>, FitError> {
    let (surface, shape) = (fit.input_surface()?, shape_of(fit, subject));
    Ok(Found {
        contacts: measured(subject.input),
        saved_frame: *fit.frame(),
        frame: *fit.frame(),
        fit: fit_part(fit, subject),
        shape: height_shape_part(fit, shape),
        truth: subject.truth.map(|truth| truth_part(shape, truth, &against(fit.frame(), &shape.maps, truth))),
        surface: AnySurface::Height(surface),
        unsupported: Cow::Borrowed(&fit.solution().unsupported),
        source: Source::Height { fit, input: subject.input, bare: subject.bare },
    })
}

/// S at the supported points of the grid.
pub(super) fn shape_index<'a>(maps: &'a ShapeMaps) -> impl Iterator<Item = f64> + 'a {
    maps.supported.indexed_iter().filter_map(|((i, j), _)| maps.shape_index_at(i, j))
}

/// Leaves out what the contacts do not surround.
pub(in crate::report) fn leave_out_beyond(fit: &Fit, input: &Input, maps: &mut ShapeMaps) {
    // who names a domain asks about all of it
    let Input::Contacts(contacts) = input else { return };
    if fit.options().domain.is_none() {
        let (x, y) = along_axes(contacts, fit.frame());
        maps.leave_out_beyond(&Outline::new(&x, &y));
    }
}

fn along_axes(contacts: &Contacts, frame: &Frame) -> (Vec<f64>, Vec<f64>) {
    if frame.keeps_axes() {
        return (contacts.x.clone(), contacts.y.clone());
    }
    (0..contacts.len())
        .map(|r| frame.rotate([contacts.x[r], contacts.y[r], contacts.z[r]]))
        .map(|p| (p[0], p[1]))
        .unzip()
}

/// Contacts, or pixels that hold a measurement.
pub(super) fn measured(input: &Input) -> usize {
    match input {
        Input::Contacts(contacts) => contacts.len(),
        Input::Grid(grid) => measured_pixels(grid),
    }
}

fn measured_pixels(grid: &Grid) -> usize {
    let known =
        |map: &Option<ndarray::Array2<f64>>, at| map.as_ref().is_some_and(|m: &ndarray::Array2<f64>| !m[at].is_nan());
    grid.z.indexed_iter().filter(|(at, z)| !z.is_nan() || known(&grid.zx, *at) || known(&grid.zy, *at)).count()
}

fn fit_part(fit: &Fit, subject: &Subject) -> FitPart {
    let (solution, rms, knots) = (fit.solution(), fit.rms(), fit.surface().knots());
    let certificate = (!subject.bare).then(|| fit.certificate());
    let (source, noise) = fit.noise_at_hand();
    let noise = if subject.bare { noise } else { Some(*fit.noise()) };
    let sigma = noise.map_or_else(SigmaPart::default, |noise| SigmaPart {
        z: noise.sigma_z,
        normal_deg: noise.sigma_normal_deg,
        slope: noise.sigma_slope,
        ..SigmaPart::default()
    });
    let finite = |v: f64| v.is_finite().then_some(v);
    let about_intervals = if subject.bare { Vec::new() } else { interval_words(fit) };
    let known = sigma.z.or(sigma.normal_deg).or(sigma.slope).is_some();
    FitPart {
        degree: [0, 1].map(|k| knots[k].degree()),
        segments: [0, 1].map(|k| knots[k].n_segments()),
        weights: match source {
            NoiseSource::Weights(weights) => Some(weights),
            _ => None,
        },
        sigma: known.then_some(sigma),
        method: solution.method.name().into(),
        reason: solution.reasons.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        equations: fit.equations().count(),
        unknowns: fit.equations().unknowns(),
        rank: solution.rank,
        condition: certificate.and_then(|certificate| finite(certificate.condition)),
        backward_error: certificate.and_then(|certificate| finite(certificate.backward_error)),
        promise: certificate.map(|certificate| PromisePart {
            coefficients: certificate.digits_of_coefficients,
            shape_index: certificate.digits_of_shape_index,
            curvedness: certificate.digits_of_curvedness,
        }),
        refinements: solution.refinements,
        smooth: fit.smoothing(),
        chosen: subject.chosen.clone(),
        lack_of_fit: subject.lack_of_fit.clone(),
        parametric: None,
        adaptive: None,
        rms: RmsPart { z: rms.z, zx: rms.zx, zy: rms.zy, normal_deg: None },
        notes: (subject.remarks())
            .chain(fit.notes().iter().map(ToString::to_string))
            .chain(if subject.bare { Vec::new() } else { declared_sigma(fit) })
            .chain((!subject.bare).then(|| along_fingers(fit)).flatten())
            .chain(about_intervals.iter().cloned())
            .collect(),
        technical_notes: fit
            .notes()
            .iter()
            .filter(|note| matches!(note, Note::GaussNewton { .. }))
            .map(ToString::to_string)
            .chain(about_intervals.into_iter().filter(|_| fit.model_reading().found().is_some()))
            .collect(),
    }
}

/// Declared noise that the contacts contradict, in words.
fn declared_sigma(fit: &Fit) -> Vec<String> {
    let words = |what: &str, factor: f64| {
        let factor_words = significant(factor, 2);
        if factor > 1.0 {
            format!(
                "{what} lie {factor_words} times as far off the surface as the declared sigma says: the noise is larger, \
                 or the surface is not of this kind; the intervals take it for noise"
            )
        } else {
            format!(
                "{what} lie {factor_words} times as far off the surface as the declared sigma says: the noise is smaller"
            )
        }
    };
    let [heights, normals] = fit.declared_sigma_off();
    let both = [("the heights", heights), ("the normals", normals)];
    both.into_iter().filter_map(|(what, factor)| Some(words(what, factor?))).collect()
}

/// A finger's touches are said to share errors above this probability.
const LIKELY: f64 = 0.9;

/// Errors that the touches of a finger share, in words.
fn along_fingers(fit: &Fit) -> Option<String> {
    let [_, correlation] = fit.shared_along_fingers().filter(|[probability, _]| *probability > LIKELY)?;
    Some(format!(
        "neighbouring touches of a finger share errors (correlation {}): they count as fewer, in the noise part of the \
         intervals",
        significant(correlation, 1)
    ))
}

/// The shape, without its uncertainties where they were declined.
fn shape_of<'a>(fit: &'a Fit, subject: &Subject) -> &'a Shape {
    if subject.bare { fit.bare_shape() } else { fit.shape() }
}

/// The shape, with how its intervals came about.
fn height_shape_part(fit: &Fit, shape: &Shape) -> ShapePart {
    ShapePart {
        covariance: shape.shape_index.u_noise.and_then(|_| fit.covariance_of_means()),
        intervals: shape.curvedness.u_noise.map(|_| intervals_part(fit, shape)),
        ..shape_part(shape, fit.options().grid, fit.options().level)
    }
}

fn intervals_part(fit: &Fit, shape: &Shape) -> IntervalsPart {
    let estimated = shape.curvedness.dof.is_some_and(f64::is_finite);
    let other = match fit.model_reading() {
        ModelReading::Found(other) => Some(other),
        ModelReading::NotAsked | ModelReading::Unknown { .. } => None,
    };
    IntervalsPart {
        law: if estimated { "student_t" } else { "normal" }.into(),
        beside: other.map(|other| other.name.into()),
        seed: other.and_then(|other| other.seed),
        isa: Isa::active().name().into(),
    }
}

/// The true shape under the points of the grid.
pub(super) fn against(frame: &Frame, maps: &ShapeMaps, truth: &Truth) -> Vec<TruePlace> {
    let supported = maps.supported.indexed_iter().filter(|(_, supported)| **supported);
    let place = |((i, j), _): ((usize, usize), &bool)| {
        let point = [maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z];
        let [x, y, _] = frame.direction_to_input(point);
        let below = truth.at(x, y)?;
        let found = (maps.shape_index_at(i, j), maps.curvedness[[i, j]]);
        Some(TruePlace { found, point: below.point, local: below.local })
    };
    supported.filter_map(place).collect()
}
