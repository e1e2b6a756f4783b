//! A height field described: what a fit found, or what a saved one still tells.

use std::borrow::Cow;
use std::io::Write;

use crate::io::{FIT_SCHEMA, Input, Saved, SavedFrame, SavedSurface, SupportMap, UNCERTAINTY_POINTS};
use palpate_fitting::fit::{Fit, FitError, ModelReading, NoiseSource, Note, Shape};
use palpate_geometry::contact::{Contacts, Frame, Grid};
use palpate_geometry::shape::{Outline, PointSds, ShapeGrid, ShapeMaps, Spread, compare_with_truth, spread};
use palpate_geometry::surface::HeightField;
use palpate_numeric::simd::Isa;
use palpate_world::scene::Truth;

use super::description::{
    Description, PICTURE_CELLS, ShownGrid, SpreadsOverGrid, Subject, shape_part, take_again, take_back_class,
};
use super::document::{
    FitDocument, FitPart, IntervalsPart, PromisePart, RmsPart, Seconds, ShapePart, SigmaPart, TruthPart,
};
use super::height_view::height_view;
use super::interval_words::interval_words;
use super::maps::write_maps_csv;
use super::surface_view::SurfaceView;
use super::table::significant;
use super::uncertainty;

/// A height field with its document and its maps.
pub(super) struct HeightDescription<'a> {
    document: FitDocument,
    surface: Cow<'a, HeightField>,
    maps: Cow<'a, ShapeMaps>,
    /// Points of the shape grid per direction.
    grid: [usize; 2],
    unsupported: &'a [usize],
    /// Contacts for the picture, and the frame along whose axes they are drawn.
    contacts: Option<(&'a Contacts, &'a Frame)>,
    /// The frame along whose axes the surface stands.
    frame: Frame,
    /// The fit with its input, and whether its uncertainties are wanted.
    fitted: Option<(&'a Fit, &'a Input, bool)>,
    /// The fit, and whether uncertainties were declined; `None` of a saved surface.
    fit: Option<(&'a Fit, bool)>,
}

impl<'a> HeightDescription<'a> {
    /// Describes a fit.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub(super) fn of_fit(
        fit: &'a Fit,
        subject: &Subject<'a>,
        seconds: Seconds,
    ) -> Result<HeightDescription<'a>, FitError> {
        let surface = fit.input_surface()?;
        let mut document = document(fit, &surface, subject, seconds);
        if subject.lack_of_fit.is_some() {
            let maps = &shape_of(fit, subject).maps;
            let places = maps.supported.indexed_iter().map(|(at, _)| at);
            take_back_class(&mut document, places.filter_map(|(i, j)| maps.shape_index_at(i, j)));
        }
        Ok(HeightDescription {
            document,
            surface: Cow::Owned(surface),
            maps: Cow::Borrowed(&shape_of(fit, subject).maps),
            grid: fit.options().grid,
            unsupported: &fit.solution().unsupported,
            contacts: match subject.input {
                Input::Contacts(contacts) => Some((contacts, fit.frame())),
                Input::Grid(_) => None,
            },
            frame: *fit.frame(),
            fitted: Some((fit, subject.input, !subject.bare)),
            fit: Some((fit, subject.bare)),
        })
    }

    /// Describes a saved surface over a grid.
    pub(super) fn of_saved(
        surface: &'a HeightField,
        saved: &'a Saved,
        mut document: FitDocument,
        grid: ShownGrid,
    ) -> HeightDescription<'a> {
        let domain = [0, 1].map(|k| surface.knots()[k].domain());
        let mut maps = surface.shape_maps(ShapeGrid::over(domain, grid.points, grid.inset), &saved.unsupported);
        if let Some(map) = &saved.support_map {
            let places = &maps.grid;
            maps.supported
                .indexed_iter_mut()
                .for_each(|((i, j), s)| *s &= map.holds(domain, [places.x[i], places.y[j]]));
        }
        if grid.again {
            take_again(&mut document, &spreads(&maps));
        }
        HeightDescription {
            document,
            surface: Cow::Borrowed(surface),
            maps: Cow::Owned(maps),
            grid: grid.points,
            unsupported: &saved.unsupported,
            contacts: None,
            frame: saved.frame,
            fitted: None,
            fit: None,
        }
    }
}

impl Description for HeightDescription<'_> {
    fn document(&self) -> &FitDocument {
        &self.document
    }

    fn saved(&self) -> FitDocument {
        let mut document = self.document.clone();
        let Some((fit, bare)) = self.fit else { return document };
        let knots = self.surface.knots();
        let domain = knots.each_ref().map(|axis| axis.domain());
        document.surface.support_map = SupportMap::of(domain, fit.supported());
        let sds = if bare { None } else { fit.pointwise(UNCERTAINTY_POINTS) };
        let sds: Vec<Option<PointSds>> = sds.into_iter().flatten().map(Some).collect();
        document.uncertainty = uncertainty::map(knots, &sds, &document.shape);
        document
    }

    fn write_maps_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_maps_csv(&self.maps, out)
    }

    fn flat_maps(&self) -> Cow<'_, ShapeMaps> {
        Cow::Borrowed(&self.maps)
    }

    fn view(&self) -> SurfaceView {
        let mut maps = picture_maps(&self.surface, self.grid, self.unsupported);
        // who names a domain asks about all of it
        let all_of_it = self.fitted.is_some_and(|(fit, _, _)| fit.options().domain.is_some());
        if let Some((contacts, frame)) = self.contacts.filter(|_| !all_of_it) {
            let (x, y) = along_axes(contacts, frame);
            maps.leave_out_beyond(&Outline::new(&x, &y));
        }
        height_view(&self.surface, &self.frame, &maps, self.fitted)
    }
}

/// Maps over the whole domain, fine enough to look at.
fn picture_maps(surface: &HeightField, grid: [usize; 2], unsupported: &[usize]) -> ShapeMaps {
    let [least, most] = PICTURE_CELLS;
    let domain = [0, 1].map(|k| surface.knots()[k].domain());
    surface.shape_maps(ShapeGrid::over(domain, grid.map(|n| n.clamp(least, most)), 0.0), unsupported)
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
        unit: subject.unit.clone(),
        contacts: match subject.input {
            Input::Contacts(contacts) => contacts.len(),
            Input::Grid(grid) => measured_pixels(grid),
        },
        frame: SavedFrame::of(fit.frame()),
        fit: fit_part(fit, surface, subject),
        shape: height_shape_part(fit, shape_of(fit, subject)),
        truth: subject.truth.map(|truth| truth_part(fit, shape_of(fit, subject), truth)),
        surface: SavedSurface::of(surface, &fit.solution().unsupported),
        uncertainty: None,
        seconds,
    }
}

fn measured_pixels(grid: &Grid) -> usize {
    let known =
        |map: &Option<ndarray::Array2<f64>>, at| map.as_ref().is_some_and(|m: &ndarray::Array2<f64>| !m[at].is_nan());
    grid.z.indexed_iter().filter(|(at, z)| !z.is_nan() || known(&grid.zx, *at) || known(&grid.zy, *at)).count()
}

fn fit_part(fit: &Fit, surface: &HeightField, subject: &Subject) -> FitPart {
    let (solution, rms) = (fit.solution(), fit.rms());
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
        degree: [0, 1].map(|k| surface.knots()[k].degree()),
        segments: [0, 1].map(|k| surface.knots()[k].n_segments()),
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

fn truth_part(fit: &Fit, shape: &Shape, truth: &Truth) -> TruthPart {
    let frame = fit.frame();
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

fn spreads(maps: &ShapeMaps) -> SpreadsOverGrid {
    let places: Vec<(usize, usize)> = maps.supported.indexed_iter().filter(|(_, s)| **s).map(|(at, _)| at).collect();
    let over = |value: &dyn Fn(usize, usize) -> Option<f64>| -> Spread {
        spread(places.iter().filter_map(|(i, j)| value(*i, *j)).collect::<Vec<_>>().into_iter())
    };
    SpreadsOverGrid {
        grid: [maps.grid.x.len(), maps.grid.y.len()],
        spreads: [
            over(&|i, j| maps.shape_index_at(i, j)),
            over(&|i, j| maps.curvedness_at(i, j)),
            over(&|i, j| Some(maps.k1[[i, j]])),
            over(&|i, j| Some(maps.k2[[i, j]])),
        ],
    }
}
