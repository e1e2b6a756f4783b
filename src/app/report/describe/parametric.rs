//! A fitted parametric surface: its certificate and its notes.

use std::borrow::Cow;

use crate::io::{AnySurface, Input};
use crate::report::document::{FitPart, ParametricPart, RmsPart, ShapePart, SigmaPart};
use crate::report::shape_part::shape_part;
use crate::report::subject::{Source, Subject};
use palpate_fitting::fit::FitError;
use palpate_fitting::parametric::ParametricFit;
use palpate_geometry::contact::Frame;
use palpate_world::scene::Truth;

use super::Found;
use super::truth::{TruePlace, truth_part};

/// What a fit found.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(super) fn found<'a>(fit: &'a ParametricFit, subject: &Subject<'a>) -> Result<Found<'a>, FitError> {
    let (surface, shape) = (fit.input_surface()?, fit.shape());
    let mut found = Found {
        contacts: match subject.input {
            Input::Contacts(contacts) => contacts.len(),
            Input::Grid(grid) => grid.len(),
        },
        saved_frame: *fit.frame(),
        frame: Frame::IDENTITY,
        fit: fit_part(fit, subject),
        shape: shape_part(shape, fit.options().grid, fit.options().level),
        truth: subject.truth.map(|truth| truth_part(shape, truth, &against(fit, truth))),
        surface: AnySurface::Parametric(surface, fit.input_support()),
        unsupported: Cow::Borrowed(&[]),
        source: Source::Parametric { fit, input: subject.input, bare: subject.bare },
    };
    if subject.bare {
        decline(&mut found.fit, &mut found.shape);
    }
    Ok(found)
}

/// Takes out what was declined. A parametric fit computes it on its way, at little cost.
fn decline(fit: &mut FitPart, shape: &mut ShapePart) {
    (fit.condition, fit.backward_error) = (None, None);
    for part in [&mut shape.shape_index, &mut shape.curvedness] {
        (part.u, part.interval, part.level) = (None, None, None);
    }
    shape.class_probability = None;
    (shape.direction_deg, shape.direction) = (None, None);
    (shape.axis_deg, shape.axis) = (None, None);
}

fn fit_part(fit: &ParametricFit, subject: &Subject) -> FitPart {
    let (certificate, rms) = (fit.certificate(), fit.rms());
    let knots = fit.surface().knots();
    let finite = |v: f64| v.is_finite().then_some(v);
    let how = if fit.noise_is_estimated() { "levels estimated with the fit" } else { "levels declared" };
    FitPart {
        degree: [0, 1].map(|k| knots[k].degree()),
        segments: [0, 1].map(|k| knots[k].n_segments()),
        weights: None,
        chosen: subject.chosen.clone(),
        lack_of_fit: None,
        parametric: Some(ParametricPart {
            parametrisation: certificate.parametrisation.clone(),
            iterations: certificate.iterations,
            settled: certificate.settled,
            folds_refused: certificate.folds_refused,
            smallest_jacobian: certificate.smallest_jacobian,
            fold_free: certificate.fold_free,
            fingers_monotone: certificate.fingers_monotone,
            against: certificate.against,
            bending: certificate.bending,
            fairness_raised: certificate.fairness_raised,
            closed: [0, 1].map(|k| knots[k].is_closed()),
        }),
        adaptive: None,
        sigma: Some(SigmaPart {
            z: Some(fit.position_sd()),
            normal_deg: Some(fit.normal_sd_deg()),
            ..SigmaPart::default()
        }),
        method: "cholesky".into(),
        reason: format!("3 x 3 blocks, Levenberg-Marquardt; {how}"),
        equations: certificate.equations,
        unknowns: certificate.unknowns,
        rank: certificate.unknowns,
        condition: finite(certificate.condition),
        backward_error: finite(certificate.gradient),
        promise: None,
        refinements: 0,
        smooth: fit.fairness(),
        rms: RmsPart { z: Some(rms[0]), normal_deg: Some(rms[1].to_degrees()), ..RmsPart::default() },
        notes: subject.remarks().chain(notes(fit)).collect(),
        technical_notes: Vec::new(),
    }
}

fn notes(fit: &ParametricFit) -> Vec<String> {
    let certificate = fit.certificate();
    let mut notes = Vec::new();
    if !certificate.settled {
        notes.push("the descent was cut short before a minimum: S and R may still move".into());
    }
    if !certificate.fold_free {
        notes.push("the map is not free of folds: do not trust S and R where it folds back".into());
    }
    if let Some(standing) = fit.standing() {
        notes.push(format!(
            "{standing} contacts, evenly spread, stood for all until near the minimum and told the fairness; \
             the last steps, the noise and u are those of all contacts"
        ));
    }
    if certificate.fairness_raised > 0 {
        notes.push(format!(
            "the surface bent more than neighbouring contacts felt: fairness was raised {} times tenfold",
            certificate.fairness_raised
        ));
    }
    if certificate.against > 0 {
        notes.push(format!("{} normals are against the surface", certificate.against));
    }
    if fit.shape().support < 0.25 {
        notes.push("contacts reach less than a quarter of the grid over (u, v): see support".into());
    }
    notes
}

/// The true surface nearest each point of the grid, along the fitted normal; points that it does not meet are left out.
fn against(fit: &ParametricFit, truth: &Truth) -> Vec<TruePlace> {
    let maps = &fit.shape().maps;
    let supported = maps.supported.indexed_iter().filter(|(_, supported)| **supported);
    let place = |(at, _): ((usize, usize), &bool)| {
        let s = maps.shape_index[at];
        let found = ((!s.is_nan()).then_some(s), maps.curvedness[at]);
        let local = truth.near(maps.points[at], maps.normals[at])?;
        Some(TruePlace { found, point: maps.points[at], local })
    };
    supported.filter_map(place).collect()
}
