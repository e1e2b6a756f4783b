//! A finished fit put into words, numbers and pictures: what `run` and `fit` have in common.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::contact::{Contacts, Frame, Grid};
use crate::curvature::ShapeClass;
use crate::fit::{Fit, NoiseSource, Statistic};
use crate::io::{ContactFormat, FIT_SCHEMA, Input, SavedFrame, SavedSurface, write_atomically, write_contacts};
use crate::parametric::FittedSurface;
use crate::report::{
    ChosenPart, FitDocument, FitPart, MeasurePart, PictureOptions, PromisePart, RmsPart, Seconds, ShapePart, Shares,
    SigmaPart, SpreadPart, TruthPart, significant, write_json, write_maps_csv, write_maps_npz, write_picture,
    write_table,
};
use crate::scene::Truth;
use crate::shape::{ShapeGrid, ShapeMaps, Spread, compare_with_truth, shape_maps};
use crate::surface::HeightField;

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;
use super::scene::{INVERSE_CRIME, remark};

/// Picture cells per side: at least, so that a coarse grid still shows the surface; at most, so that a browser opens it.
pub(super) const PICTURE_CELLS: [usize; 2] = [48, 100];

/// What a description needs besides the fit.
pub(super) struct Subject<'a> {
    /// Scene or file.
    pub(super) name: &'a str,
    /// The data.
    pub(super) input: &'a Input,
    /// What is true, in a simulated world.
    pub(super) truth: Option<&'a Truth>,
    /// Remarks of the reader.
    pub(super) notes: Vec<String>,
    /// When the verb began.
    pub(super) began: Instant,
    /// Seconds of reading and of fitting.
    pub(super) read: f64,
    /// Seconds of fitting.
    pub(super) fitted: f64,
    /// Kind of surface and why, where that was a question.
    pub(super) chosen: Option<ChosenPart>,
}

/// Where it goes.
pub(super) struct Destination<'a> {
    pub(super) output: &'a OutputFlags,
    pub(super) save: Option<&'a PathBuf>,
}

/// Describes a fit of either kind wherever the flags ask for it.
pub(super) fn describe(fit: &FittedSurface, subject: &Subject, to: &Destination) -> Result<(), Failure> {
    match fit {
        FittedSurface::Height(fit) => describe_height(fit, subject, to),
        FittedSurface::Parametric(fit) => super::describe_parametric::describe(fit, subject, to),
    }
}

fn describe_height(fit: &Fit, subject: &Subject, to: &Destination) -> Result<(), Failure> {
    let clock = Instant::now();
    let shape = fit.shape();
    let _ = fit.certificate();
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
    to.output.file("maps.csv", &mut |out| write_maps_csv(&shape.maps, out))?;
    to.output.file("maps.npz", &mut |out| write_maps_npz(&shape.maps, out))?;
    if to.output.out.is_some() {
        picture(fit, &surface, subject, &document, to.output)?;
    }
    if let Input::Contacts(contacts) = subject.input {
        let remark = subject.truth.and_then(remark);
        to.output
            .file("contacts.csv", &mut |out| write_contacts(contacts, ContactFormat::Csv, remark.as_deref(), out))?;
    }
    tell(&document, subject.name, to)
}

/// The document on standard output, as JSON or as a table.
pub(super) fn tell(document: &FitDocument, name: &str, to: &Destination) -> Result<(), Failure> {
    if to.output.json {
        return print(&mut |out| write_json(document, out));
    }
    // what was sent to standard output by --save - is not to be mixed with a table
    if to.output.quiet || to.save.is_some_and(|path| path.as_os_str() == "-") {
        return Ok(());
    }
    print(&mut |out| write_table(name, document, out))
}

fn picture(
    fit: &Fit,
    surface: &HeightField,
    subject: &Subject,
    document: &FitDocument,
    output: &OutputFlags,
) -> Result<(), Failure> {
    let maps = picture_maps(surface, fit.options().grid, &fit.certificate().unsupported);
    let title = headline(subject.name, document);
    let places = match subject.input {
        Input::Contacts(contacts) => Some(along_axes(contacts, fit.frame())),
        Input::Grid(_) => None,
    };
    let contacts = places.as_ref().map(|(x, y)| (&x[..], &y[..]));
    output.file("shape.svg", &mut |out| {
        write_picture(&maps, &PictureOptions { title: &title, contacts, ..Default::default() }, out)
    })
}

/// Maps over the whole domain, fine enough to look at.
pub(super) fn picture_maps(surface: &HeightField, grid: [usize; 2], unsupported: &[usize]) -> ShapeMaps {
    let [least, most] = PICTURE_CELLS;
    let domain = [0, 1].map(|k| surface.knots()[k].domain());
    shape_maps(surface, ShapeGrid::over(domain, grid.map(|n| n.clamp(least, most)), 0.0), unsupported)
}

/// One line for the top of a picture.
pub(super) fn headline(name: &str, document: &FitDocument) -> String {
    let shape = &document.shape;
    let mean = |part: &MeasurePart| part.mean.map_or("undefined".into(), |v| significant(v, 4));
    // of a path, what the user would call it
    let name = Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name);
    let class = shape.class.as_deref().unwrap_or("undefined");
    let crime = document.fit.notes.iter().any(|note| note.starts_with(INVERSE_CRIME));
    let warning = if crime { format!(" ({INVERSE_CRIME})") } else { String::new() };
    format!("{name}: {class}, S = {}, R = {}{warning}", mean(&shape.shape_index), mean(&shape.curvedness))
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

fn document(fit: &Fit, surface: &HeightField, subject: &Subject, seconds: Seconds) -> FitDocument {
    FitDocument {
        schema: FIT_SCHEMA.into(),
        contacts: match subject.input {
            Input::Contacts(contacts) => contacts.len(),
            Input::Grid(grid) => measured_pixels(grid),
        },
        frame: SavedFrame::of(fit.frame()),
        fit: fit_part(fit, surface, subject),
        shape: shape_part(fit),
        truth: subject.truth.map(|truth| truth_part(fit, truth)),
        surface: SavedSurface::of(surface, &fit.certificate().unsupported),
        seconds,
    }
}

fn measured_pixels(grid: &Grid) -> usize {
    let known =
        |map: &Option<ndarray::Array2<f64>>, at| map.as_ref().is_some_and(|m: &ndarray::Array2<f64>| !m[at].is_nan());
    grid.z.indexed_iter().filter(|(at, z)| !z.is_nan() || known(&grid.zx, *at) || known(&grid.zy, *at)).count()
}

fn fit_part(fit: &Fit, surface: &HeightField, subject: &Subject) -> FitPart {
    let (certificate, noise, rms) = (fit.certificate(), fit.noise(), fit.rms());
    let sigma = SigmaPart { z: noise.sigma_z, normal_deg: noise.sigma_normal_deg, slope: noise.sigma_slope };
    let finite = |v: f64| v.is_finite().then_some(v);
    let known = sigma.z.or(sigma.normal_deg).or(sigma.slope).is_some();
    FitPart {
        degree: [0, 1].map(|k| surface.knots()[k].degree()),
        segments: [0, 1].map(|k| surface.knots()[k].n_segments()),
        weights: match noise.source {
            NoiseSource::Weights(weights) => Some(weights),
            _ => None,
        },
        sigma: known.then_some(sigma),
        method: certificate.method.name().into(),
        reason: certificate.reasons.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        equations: certificate.equations,
        unknowns: certificate.unknowns,
        rank: certificate.rank,
        condition: finite(certificate.condition),
        backward_error: finite(certificate.backward_error),
        promise: Some(PromisePart {
            coefficients: certificate.guaranteed_digits.coefficients,
            shape_index: certificate.guaranteed_digits.shape_index,
            curvedness: certificate.guaranteed_digits.curvedness,
        }),
        refinements: certificate.refinements,
        smooth: fit.smoothing(),
        chosen: subject.chosen.clone(),
        parametric: None,
        rms: RmsPart { z: rms.z, zx: rms.zx, zy: rms.zy, normal_deg: None },
        notes: subject.notes.iter().cloned().chain(fit.notes().iter().map(ToString::to_string)).collect(),
    }
}

fn shape_part(fit: &Fit) -> ShapePart {
    let shape = fit.shape();
    ShapePart {
        grid: fit.options().grid,
        shape_index: measure(&shape.shape_index),
        curvedness: measure(&shape.curvedness),
        radius: shape.radius,
        class: (shape.curvedness.mean.is_some()).then(|| shape.class.name().to_string()),
        class_probability: shares(&shape.class_probability),
        k1: spread_part(shape.k1),
        k2: spread_part(shape.k2),
        direction_deg: shape.direction_deg,
        direction: None,
        support: shape.support,
        plane_p: shape.plane_p,
    }
}

/// Probabilities of the classes; `None` of a plane.
pub(super) fn shares(list: &[(ShapeClass, f64)]) -> Option<Shares> {
    (!list.is_empty()).then(|| Shares(list.iter().map(|(c, p)| (c.name().to_string(), *p)).collect()))
}

pub(super) fn measure(statistic: &Statistic) -> MeasurePart {
    let interval = statistic.interval.map(|i| [i.lo, i.hi]);
    MeasurePart { mean: statistic.mean, sd: statistic.sd, u: statistic.u, interval }
}

pub(super) fn spread_part(spread: Spread) -> SpreadPart {
    SpreadPart { mean: spread.mean, sd: spread.sd }
}

fn truth_part(fit: &Fit, truth: &Truth) -> TruthPart {
    let (frame, shape) = (fit.frame(), fit.shape());
    let found = compare_with_truth(&shape.maps, |point| {
        let [x, y, _] = if frame.keeps_axes() { point } else { frame.rotate_back(point) };
        let local = truth.at(x, y)?.local;
        Some((local.shape_index(), local.curvedness()))
    });
    TruthPart {
        shape_index: found.shape_index,
        curvedness: found.curvedness,
        // a plane found has no S to be wrong about
        error_shape_index: found.error_shape_index.filter(|_| shape.shape_index.mean.is_some()),
        error_curvedness: found.error_curvedness,
    }
}
