//! A finished surface in space put into words, numbers and pictures.

use std::time::Instant;

use super::describe::{Destination, PICTURE_CELLS, Subject, headline, measure, shares, spread_part, tell};
use super::failure::Failure;
use crate::io::{ContactFormat, FIT_SCHEMA, Input, SavedFrame, SavedSurface, write_atomically, write_contacts};
use crate::parametric::ParametricFit;
use crate::report::{
    FitDocument, FitPart, ParametricPart, PictureOptions, RmsPart, Seconds, ShapePart, SigmaPart, TruthPart,
    write_json, write_maps_npz, write_parametric_maps_csv, write_picture,
};
use crate::scene::Truth;
use crate::shape::{ParametricMaps, parametric_maps, uv_grid};
use crate::surface::Parametric;

/// Describes `fit` wherever the flags ask for it.
pub(super) fn describe(fit: &ParametricFit, subject: &Subject, to: &Destination) -> Result<(), Failure> {
    let clock = Instant::now();
    let shape = fit.shape();
    let seconds = Seconds {
        read: subject.read,
        fit: subject.fitted,
        shape: clock.elapsed().as_secs_f64(),
        total: subject.began.elapsed().as_secs_f64(),
    };
    let surface = fit.input_surface().map_err(|e| Failure::Input(format!("{}: {e}", subject.name)))?;
    let document = document(fit, &surface, subject, seconds);
    if let Some(path) = to.save {
        write_atomically(path, &mut |out| write_json(&document, out))?;
    }
    to.output.file("fit.json", &mut |out| write_json(&document, out))?;
    to.output.file("maps.csv", &mut |out| write_parametric_maps_csv(&shape.maps, out))?;
    to.output.file("maps.npz", &mut |out| write_maps_npz(&shape.maps.flat(), out))?;
    if to.output.out.is_some() {
        let fine = picture_maps(&surface, fit.options().grid, &fit.input_support());
        let title = headline(subject.name, &document);
        let (u, v): (Vec<f64>, Vec<f64>) = fit.feet().iter().map(|p| (p[0], p[1])).unzip();
        let picture = PictureOptions { title: &title, contacts: Some((&u, &v)), axes: ["u", "v"] };
        to.output.file("shape.svg", &mut |out| write_picture(&fine.flat(), &picture, out))?;
    }
    if let Input::Contacts(contacts) = subject.input {
        let remark = subject.truth.and_then(super::scene::remark);
        to.output
            .file("contacts.csv", &mut |out| write_contacts(contacts, ContactFormat::Csv, remark.as_deref(), out))?;
    }
    tell(&document, subject.name, to)
}

/// Maps over all of (u, v), fine enough to look at.
pub(super) fn picture_maps(
    surface: &Parametric,
    grid: [usize; 2],
    support: &crate::shape::UvSupport,
) -> ParametricMaps {
    let [least, most] = PICTURE_CELLS;
    let knots = [0, 1].map(|k| &surface.knots()[k]);
    parametric_maps(surface, uv_grid(knots, grid.map(|n| n.clamp(least, most)), 0.0), support)
}

fn document(fit: &ParametricFit, surface: &Parametric, subject: &Subject, seconds: Seconds) -> FitDocument {
    FitDocument {
        schema: FIT_SCHEMA.into(),
        contacts: match subject.input {
            Input::Contacts(contacts) => contacts.len(),
            Input::Grid(grid) => grid.len(),
        },
        frame: SavedFrame::of(fit.frame()),
        fit: fit_part(fit, subject),
        shape: shape_part(fit),
        truth: subject.truth.map(|truth| truth_part(fit, truth)),
        surface: SavedSurface::of_parametric(surface, &fit.input_support()),
        seconds,
    }
}

fn fit_part(fit: &ParametricFit, subject: &Subject) -> FitPart {
    let (certificate, levels, rms) = (fit.certificate(), fit.noise(), fit.rms());
    let knots = fit.surface().knots();
    let finite = |v: f64| v.is_finite().then_some(v);
    let how = if levels.estimated { "levels estimated with the fit" } else { "levels declared" };
    FitPart {
        degree: [0, 1].map(|k| knots[k].degree()),
        segments: [0, 1].map(|k| knots[k].n_segments()),
        weights: None,
        chosen: subject.chosen.clone(),
        parametric: Some(ParametricPart {
            parametrisation: certificate.parametrisation.clone(),
            iterations: certificate.iterations,
            settled: certificate.settled,
            folds_refused: certificate.folds_refused,
            smallest_jacobian: certificate.smallest_jacobian,
            fold_free: certificate.fold_free,
            lanes_monotone: certificate.fingers_monotone,
            against: certificate.against,
            bending: certificate.bending,
            fairness_raised: certificate.fairness_raised,
            closed: [0, 1].map(|k| knots[k].is_closed()),
        }),
        sigma: Some(SigmaPart { z: Some(levels.position), normal_deg: Some(levels.normal_deg), slope: None }),
        method: "cholesky".into(),
        reason: format!("3 x 3 blocks, Levenberg-Marquardt; {how}"),
        equations: certificate.equations,
        unknowns: certificate.unknowns,
        rank: certificate.unknowns,
        condition: finite(certificate.condition),
        backward_error: finite(certificate.gradient),
        promise: None,
        refinements: 0,
        smooth: levels.fairness,
        rms: RmsPart { z: Some(rms[0]), normal_deg: Some(rms[1].to_degrees()), ..RmsPart::default() },
        notes: subject.notes.iter().cloned().chain(notes(fit)).collect(),
    }
}

fn notes(fit: &ParametricFit) -> Vec<String> {
    let certificate = fit.certificate();
    let mut notes = Vec::new();
    if !certificate.settled {
        notes.push("the descent was cut short before a minimum: S and R may still move".into());
    }
    if !certificate.fold_free {
        notes.push("the map is not free of folds: do not trust S and R where it turns over".into());
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

fn shape_part(fit: &ParametricFit) -> ShapePart {
    let shape = fit.shape();
    ShapePart {
        grid: fit.options().grid,
        shape_index: measure(&shape.shape_index),
        curvedness: measure(&shape.curvedness),
        radius: shape.radius,
        class: shape.curvedness.mean.is_some().then(|| shape.class.name().to_string()),
        class_probability: shares(&shape.class_probability),
        k1: spread_part(shape.k1),
        k2: spread_part(shape.k2),
        direction_deg: None,
        direction: shape.direction,
        support: shape.support,
        plane_p: shape.plane_p,
    }
}

/// The true surface nearest each point of the grid, along the fitted normal; points that it does not meet are left out.
fn truth_part(fit: &ParametricFit, truth: &Truth) -> TruthPart {
    let maps = &fit.shape().maps;
    let (mut s, mut r, mut error_s, mut error_r) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (at, _) in maps.supported.indexed_iter().filter(|(_, supported)| **supported) {
        let Some(local) = truth.near(maps.points[at], maps.normals[at]) else { continue };
        r.push(local.curvedness());
        error_r.push((maps.curvedness[at] - local.curvedness()).powi(2));
        if let Some(index) = local.shape_index() {
            s.push(index);
            error_s.push((maps.shape_index[at] - index).powi(2));
        }
    }
    let mean = |list: &[f64]| (!list.is_empty()).then(|| list.iter().sum::<f64>() / list.len() as f64);
    TruthPart {
        shape_index: mean(&s),
        curvedness: mean(&r),
        // a plane found has no S to be wrong about
        error_shape_index: mean(&error_s).map(f64::sqrt).filter(|_| fit.shape().shape_index.mean.is_some()),
        error_curvedness: mean(&error_r).map(f64::sqrt),
    }
}
