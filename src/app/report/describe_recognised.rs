//! A recognised surface described: S and R are those of the recognition, the surface in the document is its spline.
//!
//! ```text
//! shape, intervals, class     from the recognition, averaged where contacts support the surface
//! surface, maps, picture      from the spline through the recognised surface
//! ```

use std::borrow::Cow;
use std::io::Write;

use ndarray::Array2;

use crate::io::{FIT_SCHEMA, Input, SavedFrame, SavedSurface, SupportMap};
use palpate_fitting::fit::FitError;
use palpate_geometry::contact::{Contacts, Frame, Grid, counted};
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{
    ParametricMaps, PointSds, ShapeGrid, ShapeMaps, parametric_maps, parametric_maps_at, spread, uv_grid,
};
use palpate_geometry::surface::HeightField;
use palpate_inference::recognition::{
    Estimate, Hypothesis, NormalsUse, Pointwise, RecognisedSpline, RecognisedSurface, Recognition,
};

use super::description::{Description, PICTURE_CELLS, Subject, shares, spread_part, take_back_class};
use super::document::{
    ChosenPart, FitDocument, FitPart, LackOfFitPart, MeasurePart, RmsPart, Seconds, ShapePart, SigmaPart, TriedPart,
};
use super::height_view::height_view;
use super::maps::write_maps_csv;
use super::parametric::write_parametric_maps_csv;
use super::parametric_view::parametric_view;
use super::recognised_view::recognised_view;
use super::surface_view::SurfaceView;
use super::uncertainty;

/// A recognised surface with its document and its spline.
pub(super) struct RecognisedDescription<'a> {
    document: FitDocument,
    found: &'a Recognition,
    spline: RecognisedSpline,
    contacts: Option<&'a Contacts>,
    input: &'a Input,
    /// The pixels of a grid.
    grid: Option<&'a Grid>,
}

impl<'a> RecognisedDescription<'a> {
    /// Describes a recognition.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub(super) fn new(
        found: &'a Recognition,
        subject: &Subject<'a>,
        seconds: Seconds,
    ) -> Result<RecognisedDescription<'a>, FitError> {
        let spline = found.spline()?;
        let mut document = FitDocument {
            schema: FIT_SCHEMA.into(),
            unit: subject.unit.clone(),
            contacts: found.contacts + found.outliers,
            frame: match &spline {
                RecognisedSpline::Height { fit, .. } => SavedFrame::of(fit.frame()),
                RecognisedSpline::Parametric { .. } => SavedFrame::of(&found.frame),
            },
            fit: fit_part(found, &spline, subject),
            shape: shape_part(found, &spline),
            truth: None,
            surface: match &spline {
                RecognisedSpline::Height { surface, fit } => SavedSurface::of(surface, &fit.certificate().unsupported),
                RecognisedSpline::Parametric { surface, support } => SavedSurface::of_parametric(surface, support),
            },
            uncertainty: None,
            seconds,
        };
        let supported = found.map.iter().filter(|p| p.supported);
        take_back_class(&mut document, supported.filter_map(|p| p.shape_index));
        let (contacts, grid) = match subject.input {
            Input::Contacts(contacts) => (Some(contacts), None),
            Input::Grid(grid) => (None, Some(grid)),
        };
        Ok(RecognisedDescription { document, found, spline, contacts, grid, input: subject.input })
    }

    fn maps(&self, points: [usize; 2]) -> Maps {
        // means are over the supported points of the recognition's own map, and the maps show these
        let own = (points == self.found.grid).then(|| self.supported());
        match &self.spline {
            RecognisedSpline::Height { surface, .. } => {
                let mut maps = height_maps(surface, &self.found.surface, points);
                maps.supported = own.unwrap_or(maps.supported);
                Maps::Height(Box::new(maps))
            }
            RecognisedSpline::Parametric { surface, support } => {
                let grid = uv_grid([&surface.knots()[0], &surface.knots()[1]], points, 0.0);
                Maps::Parametric(Box::new(match own {
                    Some(own) => parametric_maps_at(surface, grid, &own),
                    None => parametric_maps(surface, grid, support),
                }))
            }
        }
    }

    /// Which points of the recognition's map contacts support.
    fn supported(&self) -> Array2<bool> {
        let [_, m] = self.found.grid;
        Array2::from_shape_fn(self.found.grid, |(i, j)| self.found.map.get(i * m + j).is_some_and(|p| p.supported))
    }
}

/// The measured pixels of a grid.
fn pixels(grid: &Grid) -> Contacts {
    let known = grid.z.indexed_iter().filter(|(_, z)| !z.is_nan());
    let points: Vec<[f64; 3]> = known.map(|((i, j), z)| [grid.x[i], grid.y[j], *z]).collect();
    Contacts::from_points(&points)
}

/// Maps of either kind of spline.
enum Maps {
    Height(Box<ShapeMaps>),
    Parametric(Box<ParametricMaps>),
}

/// Maps over the spline's domain; where contacts do not surround the surface nothing is said.
fn height_maps(surface: &HeightField, found: &RecognisedSurface, points: [usize; 2]) -> ShapeMaps {
    let domain = [0, 1].map(|k| surface.knots()[k].domain());
    let mut maps = surface.shape_maps(ShapeGrid::over(domain, points, 0.0), &[]);
    for ((i, j), supported) in maps.supported.indexed_iter_mut() {
        let [u, v] = found.chart_of([maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z]);
        *supported = found.supported_at(u, v);
    }
    if !maps.supported.iter().any(|supported| *supported) {
        // the recognition took its means over all points then, and says so in its support
        maps.supported.fill(true);
    }
    maps
}

impl Description for RecognisedDescription<'_> {
    fn document(&self) -> &FitDocument {
        &self.document
    }

    fn saved(&self) -> FitDocument {
        let mut document = self.document.clone();
        let pixels = self.grid.map(pixels);
        let Some(contacts) = self.contacts.or(pixels.as_ref()) else { return document };
        let pointwise = Pointwise::new(self.found, contacts);
        let found = &self.found.surface;
        let (knots, sds): (_, Vec<Option<PointSds>>) = match &self.spline {
            RecognisedSpline::Height { surface, .. } => {
                let place = |x: f64, y: f64| [x, y, surface.at(x, y).z];
                let held = |x: f64, y: f64| {
                    let [u, v] = found.chart_of(place(x, y));
                    found.supported_at(u, v)
                };
                let domain = surface.knots().each_ref().map(|axis| axis.domain());
                document.surface.support_map = SupportMap::of(domain, held);
                let [x, y] = uncertainty::places(surface.knots());
                let places = x.iter().flat_map(|x| y.iter().map(|y| place(*x, *y)));
                (surface.knots(), places.map(|place| pointwise.at(place)).collect())
            }
            RecognisedSpline::Parametric { surface, .. } => {
                let [u, v] = uncertainty::places(surface.knots());
                let places = u.iter().flat_map(|u| v.iter().map(|v| surface.at(*u, *v).point));
                (surface.knots(), places.map(|place| pointwise.at(place)).collect())
            }
        };
        // the draws have counted every kind of surface already
        let mut shape = document.shape.clone();
        (shape.shape_index.u_model, shape.curvedness.u_model) = (None, None);
        document.uncertainty = uncertainty::map(knots, &sds, &shape);
        document
    }

    fn write_maps_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        match self.maps(self.found.grid) {
            Maps::Height(maps) => write_maps_csv(&maps, out),
            Maps::Parametric(maps) => write_parametric_maps_csv(&maps, out),
        }
    }

    fn flat_maps(&self) -> Cow<'_, ShapeMaps> {
        Cow::Owned(match self.maps(self.found.grid) {
            Maps::Height(maps) => *maps,
            Maps::Parametric(maps) => maps.flat(),
        })
    }

    fn view(&self) -> SurfaceView {
        let [least, most] = PICTURE_CELLS;
        let maps = self.maps(self.found.grid.map(|n| n.clamp(least, most)));
        let mut view = match (&maps, &self.spline) {
            (Maps::Height(maps), RecognisedSpline::Height { surface, .. }) => {
                height_view(surface, &Frame::IDENTITY, maps, None)
            }
            (Maps::Parametric(maps), RecognisedSpline::Parametric { surface, .. }) => parametric_view(surface, maps),
            // maps are of their spline's kind
            _ => SurfaceView::default(),
        };
        recognised_view(self.found, self.input, &mut view);
        view
    }
}

/// Equations and unknowns of the shape that was recognised.
fn size(found: &Recognition) -> [usize; 2] {
    let normals = if found.normals == NormalsUse::Believed { 2 * found.contacts } else { 0 };
    [found.contacts + normals, found.hypothesis.unknowns()]
}

fn fit_part(found: &Recognition, spline: &RecognisedSpline, subject: &Subject) -> FitPart {
    let knots = match spline {
        RecognisedSpline::Height { surface, .. } => surface.knots(),
        RecognisedSpline::Parametric { surface, .. } => surface.knots(),
    };
    let (degree, segments) = ([0, 1].map(|k| knots[k].degree()), [0, 1].map(|k| knots[k].n_segments()));
    let [equations, unknowns] = size(found);
    let noise = &found.noise;
    FitPart {
        degree,
        segments,
        weights: None,
        chosen: Some(chosen(found, spline, degree, segments)),
        lack_of_fit: Some(LackOfFitPart {
            p: Some(found.misfit.p),
            percent_of_relief: Some(found.misfit.percent_of_relief),
            words: found.misfit.words.clone(),
        }),
        parametric: None,
        sigma: Some(SigmaPart {
            z: Some(noise.sd_z),
            normal_deg: noise.sd_normal_deg,
            slope: None,
            shared: (noise.sd_correlated > 0.0).then_some(noise.sd_correlated),
            shared_over: noise.correlation_length,
        }),
        method: "recognition".into(),
        reason: format!("simple shapes weighed by their evidence; normals {}", found.normals.name()),
        equations,
        unknowns,
        rank: unknowns,
        condition: None,
        backward_error: None,
        promise: None,
        refinements: 0,
        smooth: 0.0,
        rms: RmsPart { z: rms(found, subject.input), ..RmsPart::default() },
        notes: subject
            .notes
            .iter()
            .cloned()
            .chain(set_aside(found))
            .chain(found.notes.iter().map(ToString::to_string))
            .collect(),
        technical_notes: Vec::new(),
    }
}

/// Root mean square distance of the contacts that belong to the surface.
fn rms(found: &Recognition, input: &Input) -> Option<f64> {
    let Input::Contacts(contacts) = input else {
        let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis)?;
        return Some(best.rms);
    };
    let kept = found.belonging(contacts);
    (!kept.is_empty()).then(|| (kept.iter().map(|(d, _)| d * d).sum::<f64>() / kept.len() as f64).sqrt())
}

/// Contacts and normals that were set aside or changed, in words.
fn set_aside(found: &Recognition) -> Vec<String> {
    let known = found.contacts + found.outliers - found.normals_of_length_zero;
    // without a viewpoint the side of most normals is taken
    let by_viewpoint = 2 * found.normals_flipped > known;
    let reversed = match found.normals_flipped {
        flipped if flipped >= known => "pointed away from the viewpoint: all reversed",
        _ if by_viewpoint => "pointed away from the viewpoint, or to the other side than the neighbours: reversed",
        _ => "pointed to the other side than the neighbours: reversed",
    };
    let set_aside = [
        (found.outliers, "contact", "too far off the surface to belong to it: left out"),
        (
            found.normals_of_length_zero,
            "normal",
            "of length 0 or empty: not known, these contacts count by their places alone",
        ),
        (found.normals_flipped, "normal", reversed),
        (found.normals_against, "normal", "more than 60 degrees off the surface: left out"),
    ];
    let some = set_aside.iter().filter(|(count, _, _)| *count > 0);
    some.map(|(count, thing, what)| format!("{} {what}", counted(*count, thing))).collect()
}

fn chosen(found: &Recognition, spline: &RecognisedSpline, degree: [usize; 2], segments: [usize; 2]) -> ChosenPart {
    let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis);
    let weight = best.map_or(1.0, |t| t.weight);
    let next = found.tried.iter().find(|t| t.hypothesis != found.hypothesis);
    let beside = next.map_or(String::new(), |t| format!("; next best: {} ({:.3})", t.hypothesis, t.weight));
    let (surface, frame) = match spline {
        RecognisedSpline::Height { .. } => ("height", "keep"),
        RecognisedSpline::Parametric { .. } => ("parametric", "auto"),
    };
    let why = format!("{} explains the contacts best (probability {weight:.3}){beside}", found.hypothesis.described());
    ChosenPart {
        degree: Some(degree),
        segments: Some(segments),
        frame: Some(frame.into()),
        hypothesis: Some(found.hypothesis.name().into()),
        tried: found
            .tried
            .iter()
            .map(|t| TriedPart {
                name: t.hypothesis.name().into(),
                probability: Some(t.weight),
                k1: Some(t.k1),
                k2: Some(t.k2),
                rms: Some(t.rms),
            })
            .collect(),
        ..ChosenPart::new(surface, why)
    }
}

fn estimate(e: &Estimate) -> MeasurePart {
    MeasurePart {
        mean: Some(e.mean),
        sd: Some(e.sd),
        u: Some(e.u),
        interval: Some(e.interval),
        u_noise: Some(e.u_noise),
        u_model: Some(e.u_model),
        level: Some(e.level),
        coverage_factor: None,
        dof: Some(e.dof),
    }
}

/// Every class with its probability, those of probability zero too.
fn every_class(found: &[(ShapeClass, f64)]) -> Vec<(ShapeClass, f64)> {
    let of = |class| found.iter().find(|(c, _)| *c == class).map_or(0.0, |(_, p)| *p);
    ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]).map(|class| (class, of(class))).collect()
}

/// Centre of curvature in the middle of the patch, across: the centre of a ball, a point on the axis of a pipe or bar. Of other
/// surfaces it is one of many, and says nothing.
fn centre(found: &Recognition) -> Option<[f64; 3]> {
    if !matches!(found.hypothesis, Hypothesis::Sphere | Hypothesis::Cylinder) || found.radius.is_none() {
        return None;
    }
    let [u, v] = [found.surface.u, found.surface.v].map(|[lo, hi]| 0.5 * (lo + hi));
    let (place, normal) = found.surface.at(u, v);
    // towards the free side where the surface is hollow
    let [k1, k2] = found.surface.curvatures_at(u, v)?;
    let k = if k1.abs() > k2.abs() { k1 } else { k2 };
    let centre = [0, 1, 2].map(|axis| place[axis] + normal[axis] / k);
    centre.iter().all(|v| v.is_finite()).then_some(centre)
}

fn shape_part(found: &Recognition, spline: &RecognisedSpline) -> ShapePart {
    let supported = || found.map.iter().filter(|p| p.supported);
    let over_map = |pick: fn(&palpate_inference::recognition::MapPoint) -> f64, mean: f64| {
        let values: Vec<f64> = supported().map(pick).filter(|k| k.is_finite()).collect();
        super::document::SpreadPart { mean: Some(mean), ..spread_part(spread(values.into_iter())) }
    };
    let level = matches!(spline, RecognisedSpline::Height { .. });
    let projected = |[x, y, _]: [f64; 3]| {
        let angle = y.atan2(x).to_degrees().rem_euclid(180.0);
        // rounding may leave 180 itself
        if angle < 180.0 { angle } else { 0.0 }
    };
    let plane = found.class == ShapeClass::Plane;
    ShapePart {
        grid: found.grid,
        shape_index: found.shape_index.as_ref().filter(|_| !plane).map(estimate).unwrap_or_default(),
        curvedness: estimate(&found.curvedness),
        radius: found.radius,
        radius_interval: found.radius.and(found.radius_interval),
        radii: found.radii,
        class: Some(found.class.name().into()),
        class_probability: shares(&every_class(&found.class_probability)),
        class_by_area: None,
        k1: over_map(|p| p.k1, found.k1),
        k2: over_map(|p| p.k2, found.k2),
        direction_deg: found.direction.filter(|_| level).map(projected),
        direction: found.direction.filter(|_| !level),
        axis_deg: found.axis.filter(|_| level).map(projected),
        axis: found.axis.filter(|_| !level),
        axis_within_deg: found.axis_within_deg,
        centre: centre(found),
        support: found.support.0 as f64 / found.support.1.max(1) as f64,
        plane_p: None,
        covariance: None,
        intervals: None,
    }
}
