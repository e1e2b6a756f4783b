//! From a fit to its document, its maps and its pictures: what `run`, `fit` and `show` have in common.

use std::path::Path;

use crate::contact::Frame;
use crate::fit::{Declared, Fit, Shape, Statistic};
use crate::io::{FIT_SCHEMA, SavedFrame, SavedSurface, write_atomically};
use crate::report::{
    FitDocument, FitPart, MeasurePart, PictureOptions, RmsPart, Seconds, ShapePart, Shares, SigmaPart, SpreadPart,
    TruthPart, write_json, write_maps_csv, write_maps_npz, write_picture, write_table,
};
use crate::scene::Truth;
use crate::shape::Spread;

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;

/// The document of a fit. Beyond the fit's own remarks, `notes` are those of whoever read or made the contacts.
pub(super) fn document(
    fit: &Fit,
    contacts: usize,
    truth: Option<&Truth>,
    notes: Vec<String>,
    seconds: Seconds,
) -> Result<FitDocument, Failure> {
    let surface = fit.input_surface().map_err(|e| Failure::Input(e.to_string()))?;
    let shape = fit.shape();
    Ok(FitDocument {
        schema: FIT_SCHEMA,
        contacts,
        frame: SavedFrame::of(fit.frame()),
        fit: fit_part(fit, notes),
        shape: shape_part(shape),
        truth: truth.map(|truth| truth_part(shape, truth, fit.frame())),
        surface: SavedSurface::of(&surface),
        seconds,
    })
}

fn fit_part(fit: &Fit, notes: Vec<String>) -> FitPart {
    let (certificate, noise, rms) = (fit.certificate(), fit.noise(), fit.rms());
    let knots = fit.surface().knots();
    let finite = |v: f64| v.is_finite().then_some(v);
    let sigma = SigmaPart { z: noise.sigma_z, normal_deg: noise.sigma_normal_deg, slope: noise.sigma_slope };
    let reasons: Vec<String> = certificate.reasons.iter().map(ToString::to_string).collect();
    FitPart {
        degree: [knots[0].degree(), knots[1].degree()],
        segments: [knots[0].n_segments(), knots[1].n_segments()],
        weights: match noise.declared {
            Declared::Weights(weights) => Some(weights),
            _ => None,
        },
        sigma: Some(sigma),
        method: certificate.method.name().into(),
        reason: reasons.join("; "),
        equations: certificate.equations,
        unknowns: certificate.unknowns,
        rank: certificate.rank,
        condition: finite(certificate.condition),
        backward_error: finite(certificate.backward_error),
        smooth: fit.equations().roughness.as_ref().map_or(0.0, |(lambda, _)| *lambda),
        rms: RmsPart { z: rms.z, zx: rms.zx, zy: rms.zy },
        notes: fit.notes().iter().map(ToString::to_string).chain(notes).collect(),
    }
}

/// The shape part, shared with `show`.
pub(super) fn shape_part(shape: &Shape) -> ShapePart {
    let measure =
        |s: &Statistic| MeasurePart { mean: s.mean, sd: s.sd, u: s.u, interval: s.interval.map(|i| [i.lo, i.hi]) };
    let spread = |s: &Spread| SpreadPart { mean: s.mean, sd: s.sd };
    let shares = shape.class_probability.iter().map(|(class, share)| (class.name().to_string(), *share)).collect();
    ShapePart {
        grid: [shape.maps.grid.x.len(), shape.maps.grid.y.len()],
        shape_index: measure(&shape.shape_index),
        curvedness: measure(&shape.curvedness),
        radius: shape.radius,
        class: Some(shape.class.name().into()),
        class_probability: (!shape.class_probability.is_empty()).then_some(Shares(shares)),
        k1: spread(&shape.k1),
        k2: spread(&shape.k2),
        direction_deg: shape.direction_deg,
        support: shape.support,
        plane_p: shape.plane_p,
    }
}

/// Mean truth over the points that the fit's means are over, and pointwise errors.
fn truth_part(shape: &Shape, truth: &Truth, frame: &Frame) -> TruthPart {
    let maps = &shape.maps;
    let unscaled = Frame { origin: [0.0; 3], scale: 1.0, ..*frame };
    let (mut s, mut r) = (Errors::default(), Errors::default());
    for (i, &x) in maps.grid.x.iter().enumerate() {
        for (j, &y) in maps.grid.y.iter().enumerate() {
            if !maps.supported[[i, j]] {
                continue;
            }
            let [px, py, _] = unscaled.to_input([x, y, maps.points[[i, j]].z]);
            let Some(exact) = truth.at(px, py) else { continue };
            r.add(maps.curvedness[[i, j]], exact.local.curvedness());
            if let (Some(found), Some(true_s)) = (maps.shape_index_at(i, j), exact.local.shape_index()) {
                s.add(found, true_s);
            }
        }
    }
    TruthPart { shape_index: s.mean(), curvedness: r.mean(), error_shape_index: s.rms(), error_curvedness: r.rms() }
}

#[derive(Default)]
struct Errors {
    sum: f64,
    squares: f64,
    count: f64,
}

impl Errors {
    fn add(&mut self, found: f64, exact: f64) {
        self.sum += exact;
        self.squares += (found - exact) * (found - exact);
        self.count += 1.0;
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.squares / self.count).sqrt())
    }
}

/// Everything that was asked for: the saved surface, the output directory, and standard output last.
pub(super) fn deliver(
    name: &str,
    document: &FitDocument,
    shape: &Shape,
    contacts: Option<(&[f64], &[f64])>,
    output: &OutputFlags,
    save: Option<&Path>,
) -> Result<(), Failure> {
    if let Some(path) = save {
        write_atomically(path, &mut |out| write_json(document, out))?;
    }
    write_maps(name, shape, contacts, output)?;
    output.file("fit.json", &mut |out| write_json(document, out))?;
    if output.json {
        return print(&mut |out| write_json(document, out));
    }
    // the saved surface went to standard output: nothing else may
    if output.quiet || save.is_some_and(|path| path.as_os_str() == "-") {
        return Ok(());
    }
    print(&mut |out| write_table(name, document, out))
}

/// `maps.csv`, `maps.npz` and `shape.svg` in the output directory.
pub(super) fn write_maps(
    name: &str,
    shape: &Shape,
    contacts: Option<(&[f64], &[f64])>,
    output: &OutputFlags,
) -> Result<(), Failure> {
    output.file("maps.csv", &mut |out| write_maps_csv(&shape.maps, out))?;
    output.file("maps.npz", &mut |out| write_maps_npz(&shape.maps, out))?;
    let picture = PictureOptions { title: name, contacts };
    output.file("shape.svg", &mut |out| write_picture(&shape.maps, &picture, out))
}
