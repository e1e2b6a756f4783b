//! A surface with knots where the contacts asked for them: how it was found, and its notes.

use std::borrow::Cow;

use crate::io::{AnySurface, Input};
use crate::report::adaptive_answer::AdaptiveAnswer;
use crate::report::document::{AdaptivePart, FitPart, RmsPart, SigmaPart};
use crate::report::shape_part::shape_part;
use crate::report::subject::{Source, Subject};
use palpate_fitting::fit::FitError;
use palpate_geometry::contact::Frame;
use palpate_geometry::surface::Surface;
use palpate_hierarchical::HierarchyError;

use super::Found;
use super::height::{against, measured};
use super::truth::truth_part;

/// What a fit found.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(super) fn found<'a>(answer: &'a AdaptiveAnswer, subject: &Subject<'a>) -> Result<Found<'a>, FitError> {
    let field = answer.fit.input_field().map_err(rounded)?;
    let shape = &answer.shape;
    Ok(Found {
        contacts: contacts(answer, subject),
        saved_frame: *answer.fit.frame(),
        frame: Frame::IDENTITY,
        fit: fit_part(answer, subject),
        shape: shape_part(shape, answer.asked.points, answer.asked.level),
        truth: subject.truth.map(|truth| truth_part(shape, truth, &against(&Frame::IDENTITY, &shape.maps, truth))),
        surface: AnySurface::Hierarchical(Box::new(field)),
        unsupported: Cow::Borrowed(&[]),
        source: Source::Adaptive { answer, input: subject.input },
    })
}

/// How many there are, here or elsewhere.
fn contacts(answer: &AdaptiveAnswer, subject: &Subject) -> usize {
    let report = answer.fit.report();
    match subject.input {
        Input::Contacts(here) if here.is_empty() => report.counted + report.outliers.len(),
        input => measured(input),
    }
}

/// Rounding of the input's own coordinates is all that can go wrong.
fn rounded(error: HierarchyError) -> FitError {
    match error {
        HierarchyError::Knots { axis, source } => FitError::Knots { axis, source },
        error => FitError::Word { expected: error.to_string() },
    }
}

fn fit_part(answer: &AdaptiveAnswer, subject: &Subject) -> FitPart {
    let (fit, report) = (&answer.fit, answer.fit.report());
    let mesh = fit.field().space().mesh();
    let base = mesh.levels().at(0).map(|level| level.knots());
    let normals = report.normals;
    let slopes = fit.slope_noise();
    let rows = if slopes.is_some() { 3 } else { 1 };
    FitPart {
        degree: base.map(|knots| knots.degree()),
        segments: base.map(|knots| knots.n_segments()),
        weights: None,
        chosen: subject.chosen.clone(),
        lack_of_fit: None,
        parametric: None,
        adaptive: Some(AdaptivePart {
            cells: fit.field().space().leaves().len(),
            halvings: mesh.tree().deepest(),
            rounds: report.rounds.len(),
            left_out: report.outliers.len(),
            freedom: report.freedom,
            factor_entries: report.factor_entries,
            draws_error: report.draws_error,
        }),
        sigma: Some(SigmaPart {
            z: Some(fit.height_noise()),
            normal_deg: slopes.filter(|_| normals).map(f64::to_degrees),
            slope: slopes.filter(|_| !normals),
            ..SigmaPart::default()
        }),
        method: if report.by_gradients { "pcg" } else { "cholesky" }.into(),
        reason: reason(answer),
        equations: report.counted * rows,
        unknowns: fit.unknowns(),
        rank: fit.unknowns(),
        condition: (!subject.bare).then_some(report.condition).filter(|condition| condition.is_finite()),
        backward_error: report.backward_error,
        promise: None,
        refinements: 0,
        // of second derivatives, from the patch's unit of length to the input's
        smooth: report.lambdas.first().map_or(0.0, |lambda| lambda * fit.frame().scale.powi(2)),
        rms: RmsPart { z: Some(report.rms), ..RmsPart::default() },
        notes: subject.remarks().chain(notes(answer)).collect(),
        technical_notes: Vec::new(),
    }
}

/// How the equations were solved.
fn reason(answer: &AdaptiveAnswer) -> String {
    let report = answer.fit.report();
    match report.by_gradients {
        true => format!("the factor would be too large: {} numbers in those of blocks", report.factor_entries),
        false => format!("sparse, {} numbers in the factor", report.factor_entries),
    }
}

fn notes(answer: &AdaptiveAnswer) -> Vec<String> {
    let report = answer.fit.report();
    let mut notes = Vec::new();
    let out = report.outliers.len();
    if out > 0 {
        let all = out + report.counted;
        let contacts = if out == 1 { "contact lies" } else { "contacts lie" };
        notes.push(format!("{out} {contacts} off what is around and counted for nothing, of {all}"));
    }
    if let Some(error) = report.draws_error {
        notes.push(format!(
            "the equations are so many that standard uncertainties at points come by random draws, off by {:.1} %",
            100.0 * error
        ));
    }
    if report.rounds.last().is_some_and(|round| round.split > 0) {
        notes.push("the contacts ask for still smaller cells than are allowed: what is left counts as noise".into());
    }
    notes
}
