//! A parametric surface described: what a fit found, or what a saved one still tells.

use std::borrow::Cow;
use std::io::Write;

use crate::io::{FIT_SCHEMA, Input, SavedFrame, SavedSurface, UNCERTAINTY_POINTS};
use palpate_fitting::fit::FitError;
use palpate_fitting::parametric::ParametricFit;
use palpate_geometry::shape::{ParametricMaps, ShapeMaps, UvSupport, parametric_maps, spread, uv_grid};
use palpate_geometry::surface::Parametric;
use palpate_world::scene::Truth;

use super::description::{Description, PICTURE_CELLS, ShownGrid, SpreadsOverGrid, Subject, shape_part, take_again};
use super::document::{FitDocument, FitPart, ParametricPart, RmsPart, Seconds, SigmaPart, TruthPart};
use super::parametric::write_parametric_maps_csv;
use super::parametric_view::parametric_view;
use super::surface_view::{ContactsView, Standing, SurfaceView};
use super::uncertainty;

/// A parametric surface with its document and its maps.
pub(super) struct ParametricDescription<'a> {
    document: FitDocument,
    surface: Cow<'a, Parametric>,
    support: Cow<'a, UvSupport>,
    maps: Cow<'a, ParametricMaps>,
    /// Points of the shape grid per direction.
    grid: [usize; 2],
    /// (u, v) of the contacts, for the picture.
    feet: Option<Vec<[f64; 2]>>,
    input: Option<&'a Input>,
    /// The fit, unless uncertainties were declined; `None` of a saved surface.
    fit: Option<&'a ParametricFit>,
}

impl<'a> ParametricDescription<'a> {
    /// Describes a fit.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub(super) fn of_fit(
        fit: &'a ParametricFit,
        subject: &Subject<'a>,
        seconds: Seconds,
    ) -> Result<ParametricDescription<'a>, FitError> {
        let surface = fit.input_surface()?;
        Ok(ParametricDescription {
            document: {
                let mut document = document(fit, &surface, subject, seconds);
                if subject.bare {
                    decline(&mut document);
                }
                document
            },
            surface: Cow::Owned(surface),
            support: Cow::Owned(fit.input_support()),
            maps: Cow::Borrowed(&fit.shape().maps),
            grid: fit.options().grid,
            feet: Some(fit.feet()),
            input: Some(subject.input),
            fit: (!subject.bare).then_some(fit),
        })
    }

    /// Describes a saved surface over a grid.
    pub(super) fn of_saved(
        surface: &'a Parametric,
        support: &'a UvSupport,
        mut document: FitDocument,
        grid: ShownGrid,
    ) -> ParametricDescription<'a> {
        let knots = [0, 1].map(|k| &surface.knots()[k]);
        let maps = parametric_maps(surface, uv_grid(knots, grid.points, grid.inset), support);
        if grid.again {
            take_again(&mut document, &spreads(&maps));
        }
        ParametricDescription {
            document,
            surface: Cow::Borrowed(surface),
            support: Cow::Borrowed(support),
            maps: Cow::Owned(maps),
            grid: grid.points,
            feet: None,
            input: None,
            fit: None,
        }
    }
}

impl Description for ParametricDescription<'_> {
    fn document(&self) -> &FitDocument {
        &self.document
    }

    fn saved(&self) -> FitDocument {
        let mut document = self.document.clone();
        let sds = self.fit.and_then(|fit| fit.pointwise(UNCERTAINTY_POINTS)).unwrap_or_default();
        document.uncertainty = uncertainty::map(self.surface.knots(), &sds, &document.shape);
        document
    }

    fn write_maps_csv(&self, out: &mut dyn Write) -> std::io::Result<()> {
        write_parametric_maps_csv(&self.maps, out)
    }

    fn flat_maps(&self) -> Cow<'_, ShapeMaps> {
        Cow::Owned(self.maps.flat())
    }

    fn view(&self) -> SurfaceView {
        let maps = picture_maps(&self.surface, self.grid, &self.support);
        let contacts = self.input.zip(self.feet.as_deref()).map(|(input, feet)| on_feet(&self.surface, input, feet));
        let uncertainty_words = "not computed point by point for a surface in space that was named by options";
        SurfaceView { contacts, uncertainty_words, ..parametric_view(&self.surface, &maps) }
    }
}

/// Contacts beside their feet: where nearest points were found for as many contacts as there are.
fn on_feet(surface: &Parametric, input: &Input, feet: &[[f64; 2]]) -> ContactsView {
    ContactsView::new(input, "along the surface's normal", |number, point| {
        let place = feet.get(number).copied().unwrap_or([f64::NAN; 2]);
        let here = surface.at(place[0], place[1]);
        let normal = here.principal().map_or([f64::NAN; 3], |p| p.normal);
        let residual = (0..3).map(|k| (point[k] - here.point[k]) * normal[k]).sum();
        Standing { place, foot: here.point, residual, left_out: false }
    })
}

/// Maps over all of (u, v), fine enough to look at.
fn picture_maps(surface: &Parametric, grid: [usize; 2], support: &UvSupport) -> ParametricMaps {
    let [least, most] = PICTURE_CELLS;
    let knots = [0, 1].map(|k| &surface.knots()[k]);
    parametric_maps(surface, uv_grid(knots, grid.map(|n| n.clamp(least, most)), 0.0), support)
}

fn document(fit: &ParametricFit, surface: &Parametric, subject: &Subject, seconds: Seconds) -> FitDocument {
    FitDocument {
        schema: FIT_SCHEMA.into(),
        unit: subject.unit.clone(),
        contacts: match subject.input {
            Input::Contacts(contacts) => contacts.len(),
            Input::Grid(grid) => grid.len(),
        },
        frame: SavedFrame::of(fit.frame()),
        fit: fit_part(fit, subject),
        shape: shape_part(fit.shape(), fit.options().grid, fit.options().level),
        truth: subject.truth.map(|truth| truth_part(fit, truth)),
        surface: SavedSurface::of_parametric(surface, &fit.input_support()),
        uncertainty: None,
        seconds,
    }
}

/// Takes out what was declined. A parametric fit computes it on its way, at little cost.
fn decline(document: &mut FitDocument) {
    let (fit, shape) = (&mut document.fit, &mut document.shape);
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

fn spreads(maps: &ParametricMaps) -> SpreadsOverGrid {
    SpreadsOverGrid {
        grid: [maps.grid.x.len(), maps.grid.y.len()],
        spreads: [&maps.shape_index, &maps.curvedness, &maps.k1, &maps.k2].map(|map| spread(maps.defined(map))),
    }
}
